"""The command `check` for a motion from elsewhere: samples, polynomials, ROS trajectories."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.console import RenderableType

from ...problem import Array, CaseError, TrajgapError, Verdict, from_si, read_float, shown_bound
from ...problem.limit_files import StatedLimits, limits_of_flags, merge, read_limits, read_urdf
from ...problem.motions import (
    Floor,
    ForeignFile,
    Interpolation,
    JointLimits,
    Motion,
    MotionCheck,
    MotionPeak,
    Samples,
    check_motion,
    check_samples,
    factors_of,
    interpolated,
    read_motion,
    unstated_words,
)
from ..documents import (
    CheckedMotion,
    MotionCheckDocument,
    MotionFloor,
    MotionJumpShown,
    MotionPeakShown,
    MotionQuantity,
    NotJudged,
    Why,
    json_text,
    known,
    value_or_none,
)
from .input import naming
from .output import emit, new_output
from .table import Columns, line


@dataclass(frozen=True)
class MotionOptions:
    """What the command line says of a motion and its limits."""

    limits: Mapping[str, str | None] = field(default_factory=dict)
    limits_file: Path | None = None
    urdf: Path | None = None
    interpolation: str | None = None
    noise: str | None = None
    time_noise: float | None = None
    units: str | None = None
    joints: str | None = None
    topic: str | None = None
    tolerance: float = 1e-6
    strict: bool = False

    @property
    def names(self) -> list[str]:
        """Options that are there, for the message where they do not belong."""
        named = {
            **self.limits,
            "limits": self.limits_file,
            "urdf": self.urdf,
            "interpolation": self.interpolation,
            "noise": self.noise,
            "time-noise": self.time_noise,
            "units": self.units,
            "joints": self.joints,
            "topic": self.topic,
            "strict": self.strict or None,
        }
        return [f"--{name}" for name, value in named.items() if value is not None]


def check_file(source: str, options: MotionOptions, as_json: bool, out: Path | None) -> int:
    """Judge the motion of a file; 1 with ``strict`` unless it passes and all of it is judged."""
    how = _interpolation(options.interpolation)
    read = read_motion(
        Path(source),
        words(options.units),
        _numbers(options.noise),
        words(options.joints),
        options.topic,
        options.time_noise,
    )
    factors = factors_of(read.units, len(read.joints), "--units")
    limits = stated_limits(read.joints, factors, options)
    with new_output(out) as write, naming(source):
        how, found = judged(read, limits, how, options.tolerance)
        document = motion_document(source, read, how, found)
        write(json_text(document))
    emit(document, _shown, as_json)
    passes = found.verdict is Verdict.PASS and not found.not_judged
    return 1 if options.strict and not passes else 0


def judged(
    read: ForeignFile, limits: JointLimits, how: Interpolation | None, tolerance: float
) -> tuple[Interpolation | None, MotionCheck]:
    """The verdict on a file, and the interpolation it rests on; None for polynomials."""
    content = read.content
    if isinstance(content, Motion):
        if how is not None:
            raise CaseError("--interpolation", "", "is of samples; polynomials are the motion")
        return None, check_motion(content, limits, tolerance)
    if how is None:
        how = Interpolation.CONTROLLER if read.controller else Interpolation.NONE
    if how is Interpolation.NONE:
        return how, check_samples(content, limits, tolerance)
    found = check_motion(interpolated(content, how), limits, tolerance)
    rounding = content.rounding
    if found.verdict is Verdict.UNDECIDED and rounding.time and how is not Interpolation.CONTROLLER:
        exact = replace(content, rounding=replace(rounding, time=0.0))
        told = _of_exact_times(check_motion(interpolated(exact, how), limits, tolerance).verdict)
        found = replace(found, open=(*told, *found.open))
    return how, found


def _of_exact_times(verdict: Verdict) -> tuple[str, ...]:
    """The verdict on the same samples with times that nothing was rounded off, if there is one."""
    if verdict is Verdict.UNDECIDED:
        return ()
    return (
        "If the times are exact, as those of a planner's grid are, the verdict is "
        f"{verdict}: state --time-noise 0.",
    )


def motion_document(
    source: str, read: ForeignFile, how: Interpolation | None, found: MotionCheck
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
    )


def checked_motion(found: MotionCheck) -> CheckedMotion:
    """The entry of a verdict on a motion."""
    return CheckedMotion(
        verdict=found.verdict,
        limits_verdict=found.limits,
        not_judged=tuple(
            NotJudged(joint=joint, quantity=MotionQuantity(quantity))
            for joint, quantity in found.not_judged
        ),
        tolerance=found.tolerance,
        total_time=found.total_time,
        worst=Why("nothing is limited") if found.worst is None else _peak(found.worst),
        slow_down=found.stretch,
        feasible_time=known(found.feasible_time, found.feasible_why),
        floor=known(None if found.floor is None else _floor(found.floor), found.floor_why),
        peaks=tuple(map(_peak, found.peaks)),
        jumps=tuple(
            MotionJumpShown(
                joint=one.joint,
                quantity=MotionQuantity(one.quantity),
                time=one.time,
                size=one.size,
                breaks=one.count,
            )
            for one in found.jumps
        ),
        concluded=found.concluded,
        open=found.open,
    )


def _floor(one: Floor) -> MotionFloor:
    return MotionFloor(time=one.time, standstills=one.stops, waiting=one.waiting, above=one.above)


def _peak(one: MotionPeak) -> MotionPeakShown:
    return MotionPeakShown(
        joint=one.joint,
        quantity=MotionQuantity(one.quantity),
        time=one.time,
        value=one.value,
        limit=one.limit,
        ratio=one.ratio,
        ratio_at_least=one.least_ratio,
        ratio_at_most=one.most_ratio,
        source=one.source,
    )


def stated_limits(joints: Sequence[str], factors: Array, options: MotionOptions) -> JointLimits:
    """What holds for joints: flag before limits file before URDF.

    Parameters
    ----------
    joints : sequence of str
    factors : ndarray, shape (joints,)
        What a number of a flag is in rad or m.
    options : MotionOptions

    Returns
    -------
    JointLimits

    Raises
    ------
    CaseError
        If nothing is stated, or nothing finite.
    """
    sources: list[StatedLimits] = []
    if any(value is not None for value in options.limits.values()):
        sources.append(limits_of_flags(options.limits, joints, factors))
    if options.limits_file:
        sources.append(read_limits(options.limits_file))
    if options.urdf:
        sources.append(read_urdf(options.urdf))
    if not sources:
        raise CaseError(
            "limits", "", "none are given; add --velocity, --acceleration, ..., --limits or --urdf"
        )
    limits = merge(joints, sources)
    ends = (limits.lower, limits.upper, limits.deceleration)
    if all(np.isinf(one).all() for one in ends):
        raise CaseError("limits", "", "none is finite, so that nothing is judged; give one")
    return limits


def _interpolation(text: str | None) -> Interpolation | None:
    if text is None:
        return None
    try:
        return Interpolation(text)
    except ValueError:
        known_words = ", ".join(Interpolation)
        raise CaseError("--interpolation", "", f"{text!r} is unknown; use {known_words}") from None


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


_POWERS = {
    MotionQuantity.POSITION: "",
    MotionQuantity.VELOCITY: "/s",
    MotionQuantity.ACCELERATION: "/s²",
    MotionQuantity.DECELERATION: "/s²",
    MotionQuantity.JERK: "/s³",
}
"""What follows the unit of positions."""


def _shown(document: MotionCheckDocument) -> list[RenderableType]:
    result = document.result
    units = dict(zip(document.joints, document.units, strict=True))
    how = value_or_none(document.interpolation)
    between = "" if how is None else f", interpolation {how}"
    joints = len(document.joints)
    head = (
        f"{document.file}: {document.format}, {joints} joint{'s' * (joints > 1)}, "
        f"{document.rows:,} {'breaks' if how is None else 'samples'}{between}, "
        f"{result.total_time:.6g} s"
    )
    parts: list[RenderableType] = [line(head, "bold"), *_verdict(result, units)]
    if result.not_judged:
        parts.append(line(_STATE_IT, "dim"))
    rows = [
        (
            one.joint,
            one.quantity,
            _number(one.value, units[one.joint]),
            _number(one.limit, units[one.joint]),
            units[one.joint] + _POWERS[one.quantity],
            _ratio(one, how is Interpolation.NONE),
            f"{one.time:.6g}",
            one.source,
        )
        for one in result.peaks
    ]
    columns = ("joint", "quantity", ">nearest", ">limit", "unit", ">ratio", ">at s", "~from")
    return [*parts, Columns(columns, rows)] if rows else parts


def _ratio(one: MotionPeakShown, samples_alone: bool) -> str:
    """The ratio with the digits that it is known to; its bounds where noise leaves it open."""
    low, high = max(0.0, one.ratio_at_least), one.ratio_at_most
    if not math.isfinite(one.ratio):
        return "unbounded"
    least = shown_bound(low, "lower", digits=4)
    if samples_alone or not math.isfinite(high):
        return f"{least} or more"
    if high - low <= 1e-6 * max(1.0, high):
        return f"{one.ratio:.6f}"
    return f"{least} to {shown_bound(high, 'upper', digits=4)}"


def _verdict(result: CheckedMotion, units: Mapping[str, str]) -> list[RenderableType]:
    parts: list[RenderableType] = [
        line(f"{result.verdict}: {_sentence(result, tuple(units))}", "bold"),
    ]
    worst = value_or_none(result.worst)
    if worst is not None:
        unit = units[worst.joint] + _POWERS[worst.quantity]
        parts.append(
            line(
                f"worst: joint {worst.joint}, {worst.quantity} "
                f"{_number(worst.value, units[worst.joint])} {unit} against "
                f"{_number(worst.limit, units[worst.joint])} {unit} at {worst.time:.6g} s"
                f" (limit from {worst.source})"
            )
        )
    for one in _gravest(result):
        unit = units[one.joint] + _POWERS[one.quantity]
        parts.append(
            line(
                f"jump: {one.quantity} of joint {one.joint} by "
                f"{_number(one.size, units[one.joint])} {unit} at {one.time:.6g} s; "
                f"it jumps at {one.breaks} break{'s' * (one.breaks > 1)}"
            )
        )
    repaired = value_or_none(result.feasible_time)
    if repaired is None:
        parts.append(line(f"repair: none, {result.feasible_time}"))
    elif result.slow_down > 1 + result.tolerance:
        slower = shown_bound(result.slow_down, "upper", places=6)
        whole = shown_bound(repaired, "upper", places=6)
        parts.append(line(f"repair: {slower} times slower keeps the limits, {whole} s"))
    floor = value_or_none(result.floor)
    if floor is None:
        parts.append(line(f"floor: none, {result.floor}", "dim"))
    else:
        least = shown_bound(floor.time, "lower", places=6)
        above = shown_bound(100 * floor.above, "upper", places=1)
        parts.append(
            line(
                f"floor: no motion between the same {floor.standstills} standstills takes less "
                f"than {least} s; this one is at most {above} % above "
                "(way-points that it passes without stopping do not count)"
            )
        )
    parts += [line(text, "dim") for text in (*result.concluded, *result.open)]
    return parts


def _gravest(result: CheckedMotion) -> Sequence[MotionJumpShown]:
    """The largest jump of the lowest derivative that jumps."""
    if not result.jumps:
        return ()
    order = list(MotionQuantity)
    return [min(result.jumps, key=lambda one: (order.index(one.quantity), -abs(one.size)))]


_SENTENCES = {
    Verdict.PASS: "every {limit} is kept at every instant",
    Verdict.VIOLATED: "a limit is exceeded",
    Verdict.DISCONTINUOUS: "the motion jumps",
    Verdict.UNDECIDED: "it is not shown whether every {limit} is kept",
}
"""What a verdict means, in a few words."""


_STATE_IT = "What is not judged: state its limit, or inf where it has none. --strict refuses it."
"""How the verdict comes to speak of everything."""


def _sentence(result: CheckedMotion, joints: Sequence[str]) -> str:
    silent = unstated_words([(one.joint, one.quantity) for one in result.not_judged], joints)
    limit = "stated limit" if silent else "limit"
    sentence = _SENTENCES[result.verdict].format(limit=limit)
    if result.verdict is Verdict.DISCONTINUOUS:
        kept = "kept" if result.limits_verdict is Verdict.PASS else "not decided"
        sentence += f"; limits, jumps apart: {kept}"
    if silent:
        sentence += f"; not judged: {silent}"
    return f"{sentence} (relative tolerance {result.tolerance:g})"


def _number(value: float, unit: str) -> str:
    return f"{from_si(value, unit):.6g}"
