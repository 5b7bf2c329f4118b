"""What `solve` reads and writes beside case files: tables of way-points, and motions."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from ...nlp import Solution, retimed_motion
from ...problem import QUANTITIES, Case, CaseError, TrajgapError, is_linear, scaffold, visible
from ...problem.cases import check_case
from ...problem.motions import (
    Evaluated,
    JointLimits,
    MotionForm,
    check_motion,
    factors_of,
    motion_text,
    read_back,
)
from ..audits import in_words
from ..documents import WrittenMotion, value_or_none
from .input import Selected
from .motion_checking import MotionOptions, stated_limits, words
from .motion_results import checked_motion

_POWERS = {"velocity": "/s", "acceleration": "/s^2", "jerk": "/s^3"}
"""What follows the unit of positions in that of a limit."""


def points_case(
    source: str, options: MotionOptions, family: str | None, degree: int | None
) -> Case:
    """A case without claims: the way-points of a table, and the limits that the options state.

    Parameters
    ----------
    source : str
        CSV, as `scaffold` reads it.
    options : MotionOptions
    family : str or None
    degree : int or None
        As in `scaffold`.

    Raises
    ------
    CaseError
        If the table or an option cannot be used, or a joint has no limit that others have.
    """
    units = words(options.units) or ("rad",)
    given = {"position": ",".join(units), "jerk": "rad/s^3"}
    # The curve that is usual depends on whether jerk is limited: only that is asked of the number.
    raw = tomllib.loads(scaffold(source, given, family=family, degree=degree), parse_float=Decimal)
    joints = raw["robot"]["joints"]
    factors = factors_of(units, len(joints), "--units")
    try:
        stated = stated_limits(joints, factors, options)
        limits = stated.two_sided
    except CaseError:
        raise
    except TrajgapError as error:
        raise CaseError("limits", "", str(error)) from None
    if family is None and np.isfinite(limits.sides[:, :, 2]).any():
        text = scaffold(source, given, family=family, degree=degree, jerk="1")
        raw = tomllib.loads(text, parse_float=Decimal)
    slides = [is_linear(unit) for unit in units] * (len(joints) if len(units) == 1 else 1)
    raw["limits"] = block = {}
    for quantity in QUANTITIES:
        low, high = limits.ends(quantity)
        block[quantity] = [[_number(a), _number(b)] for a, b in zip(low, high, strict=True)]
        raw["units"][quantity] = [("m" if s else "rad") + _POWERS[quantity] for s in slides]
    for name in ("position_lower", "position_upper"):
        block[name] = [_number(x) for x in getattr(limits, name) / factors]
    case = check_case(raw, source)
    slower = [j for j, x in zip(joints, stated.deceleration, strict=True) if np.isfinite(x)]
    if slower:
        sys.stderr.write(
            f"trajgap: {visible(source)}: deceleration has its own limit at joint "
            f"{visible(', '.join(slower))}; here the smaller value limits acceleration and "
            "deceleration alike, so a motion that uses the larger one may be shorter\n"
        )
    return case


def _number(value: float) -> Any:
    """A number as TOML gives it, to the last bit."""
    return Decimal(repr(float(value))) if np.isfinite(value) else float(value)


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
