"""What `solve` reads and writes beside case files: tables of way-points, and motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path

import numpy as np

from ...nlp import Solution, retimed_motion
from ...problem import Case, CaseError, FileLimits, parse_case, scaffold
from ...problem.cases import units_in_header
from ...problem.limit_files import read_urdf
from ...problem.motions import (
    Evaluated,
    JointLimits,
    MotionForm,
    check_motion,
    motion_text,
    numbered,
    read_back,
)
from ..audits import in_words
from ..documents import WrittenMotion, value_or_none
from .input import Selected, naming
from .motion_checking import stated_limits, word_of, words
from .motion_results import checked_motion
from .options import CurveOptions, LimitOptions, Options, option
from .output import warn


def points_case(source: str, options: LimitOptions, curve: CurveOptions) -> Case:
    """A case without claims: the way-points of a table, and the limits that the options state.

    `source`: CSV, as `scaffold` reads it.
    """
    units = options.units or units_in_header(source) or "rad"
    options = replace(options, units=units)
    text = scaffold(
        source,
        {"position": ",".join(words(units))},
        family=curve.family,
        degree=curve.degree,
        limits_of=limits_of_table(source, options),
        warn=lambda doubt: warn([doubt]),
    )
    hashed = sha256(Path(source).read_bytes()).hexdigest()
    return replace(parse_case(text, source), sha256=hashed)


def limits_of_table(source: str, options: LimitOptions) -> Callable[[tuple[str, ...]], FileLimits]:
    """What finds the limits that options state of the joints of a table of way-points.

    Joints that the table only numbers take the names of the URDF, in its order.
    """

    def found(joints: tuple[str, ...]) -> FileLimits:
        if options.urdf and joints == numbered(len(joints)):
            joints = _names(source, options.urdf, len(joints))
        with naming(str(options.urdf or "limits")):
            stated, _ = stated_limits(joints, words(options.units) or ("rad",), options)
            limits = stated.two_sided
        slower = [joints[j] for j in np.flatnonzero(stated.joined_braking)]
        doubt = slower and (
            "deceleration goes with no single size of acceleration at joint "
            f"{', '.join(slower)}; here the smallest limits both, so a motion that uses a larger "
            "one may be shorter"
        )
        sources = ", ".join(dict.fromkeys(stated.sources.values()))
        return FileLimits(joints, limits, sources, doubt or "")

    return found


def _names(source: str, urdf: Path, count: int) -> tuple[str, ...]:
    """Names of a URDF's joints, if they are as many as those of a table."""
    names = tuple(read_urdf(urdf).ranges)
    if len(names) != count:
        raise CaseError(
            source,
            "line 1",
            f"numbers {count} joints, but {urdf} has {len(names)} with limits "
            f"({', '.join(names)}); name those of the table",
        )
    return names


@dataclass(frozen=True, kw_only=True)
class SampleOptions(Options):
    """The file into which the motion of an answer goes."""

    samples: Path | None = option("FILE")
    """Write the motion of the answer to this file."""
    rate: float | None = option("", min=1e-3, max=1e6, usual="500")
    """With --samples: rows a second."""
    format: str | None = option("csv|ros|ppoly", usual="csv")
    """With --samples: rows, a JointTrajectory, or the polynomials."""
    retimed: bool = option("", False)
    """With --samples: the path of the answer, re-timed by TOPPRA under velocity and acceleration
    limits only."""

    def asked(self) -> AskedSamples | None:
        """What is to be written; 500 rows a second, as arms of today are commanded, by default."""
        if self.samples is None:
            return None
        form = word_of("--format", self.format or "csv", MotionForm)
        return AskedSamples(self.samples, self.rate or 500.0, form, self.retimed)


@dataclass(frozen=True)
class AskedSamples:
    """What is to be written."""

    file: Path
    rate: float
    form: MotionForm
    retimed: bool


def write_motion(one: Selected, answer: Solution, asked: AskedSamples) -> tuple[str, WrittenMotion]:
    """Text of a motion, and what is true of it when it is read back."""
    name = str(asked.file)
    with naming(name, "--samples"):
        joints = one.problem.joints
        motion: Evaluated = answer.trajectory
        if asked.retimed:
            motion = retimed_motion(answer.trajectory, one.problem.limits, joints)
        text = motion_text(motion, asked.form, 1.0 / asked.rate, joints, one.problem.linear)
        limits = JointLimits.of(one.problem.limits, one.problem.joints)
        found = check_motion(read_back(text, asked.form, name), limits)
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
    under = in_words(case, written.problem, written.reading)
    back = f"read back: {result.verdict}{ratio} ({result.concluded[0].rstrip('.')})"
    lines = [f"{written.file}: the motion as {written.form} ({under}); {back}"]
    if result.verdict != "pass" and written.form is MotionForm.CSV:
        lines.append(
            "a break of the curve lies between two rows; --format ros writes it as a point, and "
            "ppoly writes the curve itself"
        )
    return lines
