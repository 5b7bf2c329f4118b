"""Tables of what `check` and `solve` answer for each problem and reading."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias, TypeVar

from ...problem import Case
from ..audits import asked_as, in_words
from ..blocks import Block, Prose, table
from ..documents import ActiveLimit, CheckResult, SolveResult, Why, WorstPeak

Result: TypeAlias = CheckResult | SolveResult
"""One problem under one reading, and under per-joint coupling its joints."""
R = TypeVar("R", CheckResult, SolveResult)
Cells = Callable[[Any], tuple[object, ...]]
"""What a row says of a result, or of one of its joints."""
Rows = Sequence[Sequence[object]]
"""Rows of a table."""


def by_result(
    results: Sequence[Result], columns: Sequence[str], cells: Cells, whole: str, case: Case
) -> list[Block]:
    """One table of all results, or one for each where the joints stand by themselves."""
    rows: dict[tuple[str, str], Rows] = {}
    apart = any(result.joints for result in results)
    for result in results:
        joints = [(one.joint, *cells(one)) for one in result.joints or ()]
        own = [*joints, (whole, *cells(result))] if apart else [cells(result)]
        rows[result.problem, result.reading] = own
    return by_question(rows, ("joint", *columns) if apart else columns, apart, case)


def by_question(
    rows: Mapping[tuple[str, str], Rows], columns: Sequence[str], apart: bool, case: Case
) -> list[Block]:
    """What is said of each problem and reading, which are called by words; an id stands once.

    One table of them all, or one for each where they are set apart or there is only one.
    """
    if not apart and len(rows) > 1:
        joined = [(in_words(case, *ids), *row) for ids, own in rows.items() for row in own]
        return [table(("~problem", *columns), joined), *_ids(rows, case)]
    parts: list[Block] = []
    for ids, own in rows.items():
        words = asked_as(case, *ids)
        # The tables stand below the case's id.
        parts += [Prose(words)] if words != case.id else []
        parts.append(table(columns, own))
    return parts


def _ids(asked: Iterable[tuple[str, str]], case: Case) -> list[Block]:
    """What a command has to be given so that it takes one problem or one reading alone."""
    problems, readings = (dict.fromkeys(ids) for ids in zip(*asked, strict=True))
    titles = {p.id: p.title or p.id for p in case.problems}
    rows = [
        *((f"--problem {one}", titles[one]) for one in problems if len(titles) > 1),
        *((f"--reading {one}", case.labels[one]) for one in readings if len(case.readings) > 1),
    ]
    return [table(("for one alone", "~which"), rows)]


def reasons(
    results: Iterable[R], missing: Callable[[R], Mapping[str, str | None]], case: Case
) -> list[Prose]:
    """Why a number is missing, for each result without joints of its own."""
    return [
        Prose(f"{name}: {why} ({in_words(case, result.problem, result.reading)})", "note")
        for result in results
        if not result.joints
        for name, why in missing(result).items()
        if why
    ]


def place(at: ActiveLimit | WorstPeak) -> str:
    """Where on a trajectory, and of what."""
    where = f"segment {at.segment + 1}" if at.joint is None else f"joint {at.joint}"
    when = "" if isinstance(at.time, Why) else f" at {at.time:.4f} s"
    return f"{where} {at.quantity}{when}"
