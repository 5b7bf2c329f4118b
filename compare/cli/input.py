"""What the command line reads: cases, printed durations, selections, each fault one clear line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ...problem import (
    Case,
    CaseError,
    Printed,
    Problem,
    RoundingBox,
    TrajgapError,
    load_case,
    to_si,
)


@dataclass(frozen=True, eq=False)
class Selected:
    """One problem of a case under one reading, in radians and seconds."""

    problem_id: str
    reading_id: str
    problem: Problem


@contextmanager
def naming(file: str, field: str = "") -> Iterator[None]:
    """Give errors raised inside the name of the file that they are about."""
    try:
        yield
    except CaseError:
        raise
    except TrajgapError as error:
        raise CaseError(file, field, str(error)) from None


def read_case(source: str) -> Case:
    """Load a published case by id, or a case file by path."""
    if not source:
        raise CaseError("CASE", "", "is empty; give a published case or a file")
    try:
        return load_case(source)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise CaseError(source, "", f"cannot be read ({reason}); check the path") from None


def read_cases(sources: Sequence[str]) -> list[Case]:
    """Load several cases whose ids differ."""
    cases: dict[str, Case] = {}
    for source in sources:
        case = read_case(source)
        if case.id in cases:
            other = cases[case.id].file
            why = f"{case.id!r} is also the id of {other}; give each case once"
            raise CaseError(source, "id", why)
        cases[case.id] = case
    return list(cases.values())


def select(
    case: Case, problem: str | None, reading: str | None, coupling: str | None = None
) -> list[Selected]:
    """Problems of a case under its readings.

    `problem, reading`: keep only these; all by default. `coupling`: instead of the case's own.
    """
    return [
        Selected(pid, rid, case.problem(pid, rid, coupling))
        for pid, rid in case.selections(problem, reading)
    ]


def read_durations(text: str, file: str) -> tuple[Printed, ...]:
    """Read durations as a paper prints them.

    `text`: separated by commas or blanks. `file`: the case that they are for, for messages.
    """
    words = [word for word in re.split(r"[,;\s]+", text) if word]
    if not words:
        raise CaseError(file, "--durations", "is empty; give one number per segment")
    numbers = []
    for position, word in enumerate(words, 1):
        field = f"--durations: number {position}"
        try:
            number = Printed(word)
        except TrajgapError as error:
            raise CaseError(file, field, str(error)) from None
        if number.fraction <= 0:
            raise CaseError(file, field, f"{word!r} is not positive; give more than 0")
        numbers.append(number)
    return tuple(numbers)


def duration_box(case: Case, selected: Selected, printed: Sequence[Printed]) -> RoundingBox:
    """Printed durations, in s: the numbers, and the bounds of what rounds to them."""
    wanted = selected.problem.segments
    if len(printed) != wanted:
        raise CaseError(
            case.file,
            "--durations",
            f"{len(printed)} numbers for {wanted} segments of problem {selected.problem_id!r}; "
            "give one each, with decimal points, separated by commas",
        )
    unit = case.statement(selected.problem_id, selected.reading_id).units.time or "s"
    with naming(case.file, "--durations"):
        measured = [to_si(number, unit) for number in printed]
    return RoundingBox(
        np.array([m.value for m in measured]),
        np.array([m.lower for m in measured]),
        np.array([m.upper for m in measured]),
    )
