"""The command `check` for a motion from elsewhere: judged, shown, and repaired."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np

from ...problem import CaseError, TrajgapError, Verdict, read_float
from ...problem.limit_files import StatedLimits, limits_of_flags, merge, read_limits, read_urdf
from ...problem.motions import (
    ForeignFile,
    Interpolation,
    JointLimits,
    Motion,
    MotionCheck,
    MotionForm,
    Samples,
    check_motion,
    check_samples,
    factors_of,
    interpolated,
    read_motion,
)
from ..documents import MotionCheckDocument, OrWhy, RepairedMotion, Why, json_text, known
from .input import naming
from .motion_results import checked_motion, shown_check
from .options import LimitOptions, option
from .output import AnswerOptions, emit, new_output

_STANDING = float(np.finfo(np.float32).eps)
"""Velocity up to which ros2_control takes the last point of a goal to rest, rad/s or m/s."""


@dataclass(frozen=True, kw_only=True)
class MotionOptions(LimitOptions):
    """What the command line says of a motion, its limits, and what to do with it."""

    interpolation: str | None = option("WORD", usual="none; controller for ROS")
    """Interpolation between samples: none, linear, cubic, quintic, spline, or controller (as in
    ROS)."""
    noise: str | None = option("N", usual="half a unit of the last digit in the file")
    """Uncertainty of the positions: one number, or one per joint; 0 if all are exact."""
    time_noise: float | None = option(
        "S", min=0.0, usual="half a unit of the last digit in the file"
    )
    """Uncertainty of the times, s; 0 if they are exact."""
    joints: str | None = option("A,B,...")
    """Names of the columns of a table, in order."""
    topic: str | None = option("/NAME")
    """Of a rosbag."""
    tolerance: float = option("", 1e-6, min=0.0, max=1.0)
    """For a motion: relative excess over a limit that still counts as kept."""
    strict: bool = option("", False)
    """For a motion: exit with 1 unless it passes and all of it is judged."""
    repair: Path | None = option("OUT")
    """For a motion that breaks a limit: write it to this new file in its own format (a table as
    CSV, a message as JSON), slowed down until it keeps every limit."""
    plot: Path | None = option("FILE")
    """For a motion: draw it with its limits to this new file (.png, .svg or .pdf); violations are
    red."""


def check_file(source: str, options: MotionOptions, to: AnswerOptions) -> int:
    """Judge the motion of a file; 1 with ``strict`` unless it passes and all of it is judged."""
    how = None
    if options.interpolation is not None:
        how = word_of("--interpolation", options.interpolation, Interpolation)
    read = _read(Path(source), options)
    limits, units = stated_limits(read.joints, read.units, options)
    read = replace(read, units=units)
    repair, plot = options.repair, options.plot
    kind = None if plot is None else _kind_of_picture(plot)
    with (
        new_output(to.out) as write,
        new_output(repair, "--repair") as write_motion,
        new_output(plot, "--plot") as write_picture,
        naming(source),
    ):
        how, found = judged(read, limits, how, options.tolerance)

        def check(path: Path) -> MotionCheck:
            # Polynomials state their units, and what a bag held is one message.
            units = options.units if read.form is MotionForm.CSV else None
            again = _read(path, replace(options, topic=None, units=units))
            return judged(again, limits, how, options.tolerance)[1]

        slower = repair and repaired(read, found, repair, check, write_motion)
        why = Why(found.feasible_why or "--repair needs it")
        document = motion_document(source, read, how, found, slower or why, plot)
        if kind is not None:
            write_picture(_picture(source, read, limits, how, found, kind))
        write(json_text(document))
    emit(document, shown_check, to.as_json)
    passes = found.verdict is Verdict.PASS and not found.not_judged
    return 1 if options.strict and not passes else 0


def _read(path: Path, options: MotionOptions) -> ForeignFile:
    return read_motion(
        path,
        words(options.units),
        _numbers(options.noise),
        words(options.joints),
        options.topic,
        options.time_noise,
    )


def judged(
    read: ForeignFile, limits: JointLimits, how: Interpolation | None, tolerance: float
) -> tuple[Interpolation | None, MotionCheck]:
    """The verdict on a file, and the interpolation it rests on; None for polynomials."""
    content = read.content
    if isinstance(content, Samples) and read.controller:
        how = Interpolation.CONTROLLER if how is None else how
        plain = replace(read, controller=False)
        found = judged(plain, limits, how, tolerance)[1]
        return how, replace(found, concluded=(*found.concluded, *_last_point(content)))
    if isinstance(content, Motion):
        if how is not None:
            raise CaseError(
                "--interpolation", "", "applies to samples only; polynomials are the motion itself"
            )
        return None, check_motion(content, limits, tolerance)
    how = Interpolation.NONE if how is None else how
    if how is Interpolation.NONE:
        return how, check_samples(content, limits, tolerance)
    found = check_motion(interpolated(content, how), limits, tolerance)
    rounding = content.rounding
    if found.verdict is Verdict.UNDECIDED and rounding.time and how is not Interpolation.CONTROLLER:
        exact = replace(content, rounding=replace(rounding, time=0.0))
        verdict = check_motion(interpolated(exact, how), limits, tolerance).verdict
        if verdict is not Verdict.UNDECIDED:
            told = (
                "If the times are exact, like those of a planner's grid, the verdict is "
                f"{verdict}: add --time-noise 0."
            )
            found = replace(found, open=(told, *found.open))
    return how, found


def _last_point(samples: Samples) -> list[str]:
    """That a trajectory of ROS ends in motion, as a sentence, if it does."""
    given = samples.velocity
    if given is None:
        return []
    speeds = np.nan_to_num(np.abs(given[-1])) * (np.abs(given[-1]) > _STANDING)
    if not speeds.any():
        return []
    j = int(np.argmax(speeds))
    return [
        f"The last point does not rest: joint {samples.joints[j]} has the velocity "
        f"{given[-1, j]:.6g}. A joint_trajectory_controller may refuse that "
        "(allow_nonzero_velocity_at_trajectory_end)."
    ]


def motion_document(
    source: str,
    read: ForeignFile,
    how: Interpolation | None,
    found: MotionCheck,
    slower: OrWhy[RepairedMotion],
    picture: Path | None = None,
) -> MotionCheckDocument:
    """What `check` says of a motion, as a document."""
    content = read.content
    samples = content if isinstance(content, Samples) else None
    rows = content.time.size if isinstance(content, Samples) else content.breaks.size
    return MotionCheckDocument(
        file=source,
        format=read.format,
        joints=read.joints,
        units=read.units,
        rows=rows,
        interpolation=known(how, "polynomials need none"),
        noise=tuple(samples.margin.tolist()) if samples else (0.0,) * len(read.joints),
        time_noise=samples.clock if samples else 0.0,
        result=checked_motion(found),
        repaired=slower,
        picture=None if picture is None else str(picture),
    )


def _kind_of_picture(path: Path) -> str:
    """The format that the name of a picture ends with."""
    from ..pictures import KINDS  # a third of a second, and most commands draw nothing

    kind = path.suffix.lower().removeprefix(".")
    if kind not in KINDS:
        known = ", ".join(f".{one}" for one in KINDS)
        raise CaseError(
            str(path), "--plot", f"is not a name of a picture; end it with one of {known}"
        )
    return kind


def _picture(
    source: str,
    read: ForeignFile,
    limits: JointLimits,
    how: Interpolation | None,
    found: MotionCheck,
    kind: str,
) -> bytes:
    """The motion as it was judged, as the content of a file."""
    from ..pictures import checked_picture, picture_bytes

    content = read.content
    if isinstance(content, Samples) and how is not None and how is not Interpolation.NONE:
        content = interpolated(content, how)
    between = "" if how is None else f", interpolation {how}"
    title, units = f"{source}{between}", read.units
    return picture_bytes(checked_picture(content, limits, found, title=title, units=units), kind)


def stated_limits(
    joints: Sequence[str], units: Sequence[str], options: LimitOptions
) -> tuple[JointLimits, tuple[str, ...]]:
    """What holds for joints: flag before limits file before URDF; and the unit of each joint.

    `units`: of the positions and the flags, one for all joints or one each.
    """
    factors = factors_of(units, len(joints), "--units")
    suited = tuple(units) * (len(joints) if len(units) == 1 else 1)
    sources: list[StatedLimits] = []
    if any(value is not None for value in options.flags.values()):
        sources.append(limits_of_flags(options.flags, joints, factors))
    if options.limits:
        sources.append(read_limits(options.limits))
    if options.urdf:
        sources.append(read_urdf(options.urdf))
        suited = sources[-1].units_of(joints, suited)
    if not sources:
        raise CaseError(
            "limits", "", "none are given; add --velocity, --acceleration, ..., --limits or --urdf"
        )
    limits = merge(joints, sources)
    ends = (limits.lower, limits.upper, limits.deceleration)
    if all(np.isinf(one).all() for one in ends):
        raise CaseError("limits", "", "none is finite, so nothing can be judged; give one")
    return limits, suited


E = TypeVar("E", bound=StrEnum)


def word_of(option: str, text: str, words: type[E]) -> E:
    """The word that an option gives, out of those that there are."""
    if text not in tuple(words):
        raise CaseError(option, "", f"{text!r} is unknown; use {', '.join(words)}")
    return words(text)


def words(text: str | None) -> tuple[str, ...]:
    """What stands between the commas of an option."""
    return tuple(x.strip() for x in (text or "").split(",") if x.strip())


def _numbers(text: str | None) -> tuple[float, ...] | None:
    if text is None:
        return None
    found = []
    for word in words(text) or ("0",):
        try:
            found.append(read_float(word))
        except TrajgapError as error:
            raise CaseError("--noise", "", f"{error}; give a length") from None
    return tuple(found)


_ENDINGS = {
    MotionForm.CSV: (".csv", ".txt"),
    MotionForm.ROS: (".json", ".yaml", ".yml"),
    MotionForm.PPOLY: (".json",),
}
"""How a file is called, so it is read as what it is."""


def repaired(
    read: ForeignFile,
    found: MotionCheck,
    out: Path,
    check: Callable[[Path], MotionCheck],
    write: Callable[[str], None],
) -> OrWhy[RepairedMotion]:
    """Write the motion slowed down, and what is true of the file when it is read back.

    Returns why nothing was written where no slow-down repairs the motion. `check`: reads a file as
    this one was read, and judges it. `write`: writes the text of the file.
    """
    endings = _ENDINGS[read.form]
    if out.suffix.lower() not in endings:
        known = " or ".join(endings)
        raise CaseError(str(out), "--repair", f"no motion file has this ending; use {known}")
    if found.feasible_time is None:
        advice = read.content.advice
        return Why(f"{found.feasible_why}. {advice}" if advice else str(found.feasible_why))
    factor, after = 1.0, found
    with TemporaryDirectory() as folder:
        draft = Path(folder) / out.name
        for _ in range(3):  # whole nanoseconds may take a motion past a limit once more
            factor *= after.stretch
            text = read.slowed(factor).written()
            draft.write_text(text, encoding="utf-8")
            after = check(draft)
            if after.stretch <= 1.0 + after.tolerance:
                break
    write(text)
    return RepairedMotion(
        file=str(out), form=read.form, slow_down=factor, result=checked_motion(after)
    )
