"""The motion of an answer in a file: written, read back, and checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...nlp import Solution, retimed_motion
from ...problem import Case, CaseError, TrajgapError
from ...problem.motions import (
    Evaluated,
    JointLimits,
    MotionForm,
    check_motion,
    motion_text,
    read_back,
)
from ..audits import in_words
from ..documents import WrittenMotion, value_or_none
from .input import Selected
from .motion_results import checked_motion

_RATE = 500.0
"""Rows a second by default: what arms of today are commanded at."""


@dataclass(frozen=True)
class AskedSamples:
    """What is to be written."""

    file: Path
    rate: float
    form: MotionForm
    retimed: bool = False


def asked_samples(
    file: Path, rate: float | None, form: str | None, retimed: bool = False
) -> AskedSamples:
    """What the command line asks to be written.

    Raises
    ------
    CaseError
        If the format is unknown.
    """
    try:
        wanted = MotionForm(form or "csv")
    except ValueError:
        known = ", ".join(MotionForm)
        raise CaseError("--format", "", f"{form!r} is unknown; use {known}") from None
    return AskedSamples(file, _RATE if rate is None else rate, wanted, retimed)


def check_one_motion(case: Case, selected: Sequence[Selected]) -> None:
    """Refuse more than one problem: a file holds one motion, of the first reading.

    Raises
    ------
    CaseError
    """
    problems = list(dict.fromkeys(one.problem_id for one in selected))
    if len(problems) > 1:
        raise CaseError(
            case.file, "--samples", f"{len(problems)} problems; add --problem {problems[0]}"
        )


def write_motion(one: Selected, answer: Solution, asked: AskedSamples) -> tuple[str, WrittenMotion]:
    """Text of a motion, and what is true of it when it is read back.

    Raises
    ------
    CaseError
        If there is no motion, or the format cannot hold it.
    """
    name = str(asked.file)
    try:
        joints = one.problem.joints
        motion: Evaluated = answer.trajectory
        if asked.retimed:
            motion = retimed_motion(answer.trajectory, one.problem.limits, joints)
        text = motion_text(motion, asked.form, 1.0 / asked.rate, joints, one.problem.linear)
        limits = JointLimits.of(one.problem.limits, one.problem.joints)
        found = check_motion(read_back(text, asked.form, name), limits)
    except CaseError:
        raise
    except TrajgapError as error:
        raise CaseError(name, "--samples", str(error)) from None
    return text, WrittenMotion(
        file=name,
        form=asked.form,
        problem=one.problem_id,
        reading=one.reading_id,
        rate=asked.rate,
        retimed=asked.retimed,
        result=checked_motion(found),
    )


def written_lines(written: WrittenMotion, case: Case) -> list[str]:
    """What the terminal says of a written file."""
    result = written.result
    worst = value_or_none(result.worst)
    ratio = "" if worst is None else f", largest ratio {worst.ratio:.6f}"
    lines = [
        f"{written.file}: the motion as {written.form} "
        f"({in_words(case, written.problem, written.reading)}); "
        f"read back: {result.verdict}{ratio} ({result.concluded[0].rstrip('.')})"
    ]
    if result.verdict != "pass" and written.form is MotionForm.CSV:
        lines.append(
            "a break of the curve lies between two rows: --format ros has it as a point, ppoly is "
            "the curve itself"
        )
    return lines
