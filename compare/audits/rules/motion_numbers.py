"""TG203, TG208 and TG211: printed peaks, means and values beside those of the printed motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from ....problem import QUANTITIES, Array, Printed, Trajectory, extrema, fit
from ....problem.cases import (
    AnyClaim,
    MeasureClaim,
    PeakClaim,
    ValueClaim,
    motions_of,
    named_places,
    profile_of,
)
from ...documents import Basis, ClaimVerdict, Finding
from ..printed_row import PrintedRow, printed_rows
from ..rounding import ROUNDING, Agreement
from ..stated import DERIVATIVES, called, place_of_value
from ..study import Study
from ..words import seconds
from .beside import SAMPLES, Beside, nearest_number
from .peaks import peak_beside, peak_described
from .rule_group import Explained, rule_group

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
"""Gauss-Legendre on -1..1: exact up to degree 19, and squares of declared polynomials have 18."""
_POWERS = {"mean": (1, 0), "rms": (1, 0), "integral": (1, 1), "integral-square": (2, 1)}
"""Powers of the derivative's unit and of time in each measure."""


NAMES = {
    "mean": "mean absolute value",
    "rms": "root mean square",
    "integral": "integral of the absolute value",
    "integral-square": "integral of the square",
}
"""Each measure in words."""


@dataclass(frozen=True)
class MotionMeasure:
    """A measure of each joint, and of their Euclidean norm."""

    joints: Array
    norm: float

    def meant(self, joint: int | None) -> dict[str, float]:
        """What one printed number may be, in words: that of a joint, or of the robot."""
        if joint is not None:
            return {"": float(self.joints[joint])}
        if len(self.joints) == 1:
            return {"": float(self.joints[0])}
        return {
            " of the norm over the joints": self.norm,
            " of the largest joint": float(self.joints.max()),
            " averaged over the joints": float(self.joints.mean()),
            " summed over the joints": float(self.joints.sum()),
        }


def measured(trajectory: Trajectory, order: int, measure: str) -> MotionMeasure:
    """A mean or an integral of a derivative of a motion.

    Of each joint it is exact up to float rounding where the pieces are polynomials in time, since
    they are split where the derivative changes its sign.

    Units are rad or m, and s.

    Parameters
    ----------
    order : int
        1 for velocity, 2 for acceleration, 3 for jerk.
    measure : str
        A key of `NAMES`.
    """
    first, square, norm = np.zeros(trajectory.joints), np.zeros(trajectory.joints), 0.0
    for piece in range(len(trajectory.durations)):
        places, shares = _nodes(trajectory, piece, order)
        values = np.array(
            [trajectory.values(piece, j, order, places) for j in range(trajectory.joints)]
        )
        first += np.abs(values) @ shares
        square += values**2 @ shares
        norm += float(np.linalg.norm(values, axis=0) @ shares)
    total = float(trajectory.breaks[-1] - trajectory.breaks[0])
    return _finished(first, square, norm, total, measure)


def _finished(
    first: Array, square: Array, norm: float, total: float, measure: str
) -> MotionMeasure:
    match measure:
        case "mean":
            return MotionMeasure(first / total, norm / total)
        case "rms":
            return MotionMeasure(np.sqrt(square / total), float(np.sqrt(square.sum() / total)))
        case "integral":
            return MotionMeasure(first, norm)
    return MotionMeasure(square, float(square.sum()))


def _nodes(trajectory: Trajectory, piece: int, order: int) -> tuple[Array, Array]:
    """Places of a piece and the time that each stands for."""
    # 8 parts of each piece beside its zeros: norms, and curves that are no polynomial in time, are
    # smooth enough there.
    cuts = [np.linspace(0.0, 1.0, 9)]
    for joint in range(trajectory.joints):
        level = np.trim_zeros(trajectory.level(piece, joint, order, 0.0), "b")
        if level.size > 1:
            cuts.append(np.polynomial.polynomial.polyroots(level).real)
    ends = np.unique(np.clip(np.concatenate(cuts), 0.0, 1.0))
    middle, half = (ends[1:] + ends[:-1]) / 2, (ends[1:] - ends[:-1]) / 2
    places = (middle[:, None] + half[:, None] * _NODES).ravel()
    # Time is a polynomial of degree 3 at most over a piece.
    four = np.linspace(0.0, 1.0, 4)
    clock = np.polynomial.Polynomial.fit(four, trajectory.times(piece, four), 3)
    return places, (half[:, None] * _WEIGHTS).ravel() * clock.deriv()(places)


def sampled(trajectory: Trajectory, order: int, measure: str) -> list[MotionMeasure]:
    """The same value computed from samples, one for each number of samples."""
    start, end = trajectory.breaks[0], trajectory.breaks[-1]
    found = []
    for count in SAMPLES:
        for whole in (True, False):
            times = np.linspace(start, end, count, endpoint=whole)
            values = trajectory(times, order)
            total = float(end - start)
            first, square = (x.mean(axis=0) * total for x in (np.abs(values), values**2))
            norm = float(np.linalg.norm(values, axis=1).mean()) * total
            found.append(_finished(first, square, norm, total, measure))
    return found


def measure_beside(
    row: PrintedRow[AnyClaim], claim: MeasureClaim, printed: Printed, joint: str | None
) -> Beside | None:
    """A printed number beside the measure that it is nearest to, of those that it may be."""
    problem = row.posed()
    if joint is not None and joint not in problem.joints:
        return None
    order = QUANTITIES.index(claim.derivative) + 1
    index = None if joint is None else problem.joints.index(joint)
    own, by_time = _POWERS[claim.measure]
    unit = row.in_units(claim.derivative, 1.0, joint) ** own
    unit *= row.in_units("time", 1.0) ** by_time
    shown = row.unit(claim.derivative, joint)
    shown = shown if own == 1 else f"({shown})²"
    shown += f"·{row.study.time_unit}" if by_time else ""

    def meant(waypoints: Array, durations: Array) -> dict[str, float]:
        trajectory = fit(problem.curve, waypoints, durations)
        found = measured(trajectory, order, claim.measure).meant(index)
        return {words: unit * value for words, value in found.items()}

    coarse = sampled(row.motion, order, claim.measure)
    samples = [{words: unit * x for words, x in one.meant(index).items()} for one in coarse]
    return nearest_number(printed, shown, joint, meant, samples, row.boxes)


def measure_described(row: PrintedRow[AnyClaim], claim: MeasureClaim, one: Beside) -> str:
    """One printed measure beside that of the motion."""
    whose = one.meaning if one.joint is None else f" of joint {one.joint}"
    return one.told(f"the {NAMES[claim.measure]} of {claim.derivative}{whose}")


def value_beside(
    row: PrintedRow[AnyClaim], claim: ValueClaim, printed: Printed, joint: str | None
) -> Beside | None:
    """A printed number beside the value of one joint; where it jumps, on its nearer side."""
    problem = row.posed()
    if joint is None and len(problem.joints) == 1:
        joint = problem.joints[0]
    if joint not in problem.joints:
        return None
    j, order = problem.joints.index(joint), DERIVATIVES.index(claim.derivative)
    unit = row.in_units(claim.derivative, 1.0, joint)
    statement = row.statement
    at = None if claim.place is None else named_places(statement)[claim.place]
    marks = [] if at is None else [problem.curve.waypoint_breaks[at]]
    spread, instant, sides = (0.0, 0.0), None, _near
    drawn, printed_durations = row.motion, row.durations.value
    if claim.time is not None:
        measured = row.measured(claim.time, "time")
        instant, sides = measured.value, _around
        if instant > float(printed_durations.sum()) * (1 + ROUNDING):
            return None  # the motion has ended, and where the arm goes then is not printed
        ends = [(one.lower, one.upper) for one in (measured, measured.cut_off())]
        marks = _jumps_between(drawn, *ends[1], j, order)
        rounded, cut = (_spread(drawn, instant, low, high, j, order) for low, high in ends)
        spread = unit * rounded, unit * cut
    close = ROUNDING * float(drawn.breaks[-1])
    apart = instant is not None and all(abs(drawn.breaks[b] - instant) > close for b in marks)

    def meant(waypoints: Array, durations: Array) -> dict[str, float]:
        trajectory = fit(problem.curve, waypoints, durations)
        if instant is None and not marks:
            tops = [one.value for one in extrema(trajectory, j, order)]
            return {"": unit * (max(tops) if claim.place == "largest" else min(tops))}
        found = {}
        if instant is not None and apart:
            found[""] = unit * sides(trajectory, instant, j, order)[1]
        for b in marks:
            before, after = sides(trajectory, float(trajectory.breaks[b]), j, order)
            if not apart and not _jumps(sides(drawn, float(drawn.breaks[b]), j, order)):
                return {"": unit * after}
            it = f"the jump at {seconds(drawn.breaks[b])}" if apart else "it"
            found |= {f" just before {it}": unit * before, f" just after {it}": unit * after}
        return found

    samples = []
    if instant is None and not marks:
        for count in SAMPLES:
            values = drawn(np.linspace(drawn.breaks[0], drawn.breaks[-1], count), order)[:, j]
            top = values.max() if claim.place == "largest" else values.min()
            samples.append({"": unit * float(top)})
    shown = row.unit(claim.derivative, joint)
    return nearest_number(printed, shown, joint, meant, samples, row.boxes, spread)


def _near(motion: Trajectory, time: float, joint: int, order: int) -> tuple[float, float]:
    """Values just before and just after an instant, alike where nothing jumps there."""
    breaks = motion.breaks
    time = min(max(time, float(breaks[0])), float(breaks[-1]))
    close = ROUNDING * float(breaks[-1] - breaks[0])
    at = int(np.argmin(np.abs(breaks - time)))
    if abs(breaks[at] - time) > close:
        value = float(motion(np.array([time]), order)[0, joint])
        return value, value
    pieces = len(breaks) - 1
    before = motion.values(max(at - 1, 0), joint, order, np.array([1.0 if at > 0 else 0.0]))[0]
    after = motion.values(
        min(at, pieces - 1), joint, order, np.array([0.0 if at < pieces else 1.0])
    )[0]
    return float(before), float(after)


def _around(motion: Trajectory, time: float, joint: int, order: int) -> tuple[float, float]:
    """The same of an instant: before a start at rest, and after a finish at rest, all is 0."""
    before, after = _near(motion, time, joint, order)
    close = ROUNDING * float(motion.breaks[-1])
    for end, side in zip(motion.breaks[[0, -1]], (1.0, -1.0), strict=True):
        left = side * (time - end)
        if order > 1 and left <= close and abs(motion(np.array([end]), 1)[0, joint]) <= close:
            inside = 0.0 if left < -close else after if side > 0.0 else before
            before, after = (0.0, inside) if side > 0.0 else (inside, 0.0)
    return before, after


def _jumps(sides: tuple[float, float]) -> bool:
    return abs(sides[0] - sides[1]) > ROUNDING * max(map(abs, sides))


def _jumps_between(
    motion: Trajectory, low: float, high: float, joint: int, order: int
) -> list[int]:
    """Breaks within a time at which a derivative jumps."""
    close = ROUNDING * float(motion.breaks[-1])
    inside = (low - close <= motion.breaks) & (motion.breaks <= high + close)
    return [
        int(b)
        for b in np.flatnonzero(inside)
        if _jumps(_around(motion, float(motion.breaks[b]), joint, order))
    ]


def _spread(
    motion: Trajectory, instant: float, low: float, high: float, joint: int, order: int
) -> float:
    """Largest change within a time around an instant, apart from jumps."""
    breaks = [float(motion.breaks[b]) for b in _jumps_between(motion, low, high, joint, order)]
    times = sorted({low, high, instant, *breaks})
    steps = [
        abs(_around(motion, p, joint, order)[1] - _around(motion, q, joint, order)[0])
        for p, q in pairwise(times)
    ]
    return max(steps, default=0.0)


def value_described(row: PrintedRow[AnyClaim], claim: ValueClaim, one: Beside) -> str:
    """One printed value beside that of the motion."""
    size = f"{claim.place} " if claim.place in ("largest", "smallest") else ""
    where = place_of_value(row.study.case, claim)
    return one.told(f"the {size}{claim.derivative} of joint {one.joint}{where}{one.meaning}")


_Value = TypeVar("_Value", PeakClaim, MeasureClaim, ValueClaim)


def _judged(
    study: Study,
    rule: Explained,
    kind: type[_Value],
    beside: Callable[[PrintedRow[AnyClaim], _Value, Printed, str | None], Beside | None],
    described: Callable[[PrintedRow[AnyClaim], _Value, Beside], str],
    without: str = "Without durations, this cannot be computed.",
) -> Iterator[Finding]:
    """Findings on each claim of a kind beside each motion that it may describe.

    Parameters
    ----------
    beside : callable
        From a row of durations, a claim, one of its numbers and its joint; None if the motion
        has no such number.
    described : callable
        One number beside the motion's, as a part of a sentence.
    without : str
        What is said of a claim where nothing printed defines such a motion.
    """
    for claim in study.claims:
        # TG304 judges numbers of a profile.
        if not isinstance(claim, kind) or profile_of(study.case.claims, claim) is not None:
            continue
        meant = motions_of(study.case.claims, claim)
        for row in (row for motion in meant for row in printed_rows(study, motion)):
            if claim.problem in (None, row.problem) and row.has_curve:
                each = study.printed_numbers(claim)
                found = [beside(row, claim, number, joint) for joint, number in each]
                known = [one for one in found if one is not None]
                # It tells what does not fit, or everything where all of it does.
                told = [one for one in known if not one.fits] or known
                if known:
                    said = [described(row, claim, one) for one in told]
                    yield _found(row, rule, claim, known, told, "; ".join(said))
        if not meant:
            yield rule.finding(claim, "no motion", without, basis=Basis.TEXT)


def _found(
    row: PrintedRow[AnyClaim],
    rule: Explained,
    claim: _Value,
    found: Sequence[Beside],
    told: Sequence[Beside],
    said: str,
) -> Finding:
    verdict, note, loose = ClaimVerdict.SUPPORTED, "", row.statement.declaration.loose
    if not told[0].fits:
        verdict = ClaimVerdict.NOT_CHECKABLE if loose else ClaimVerdict.INCONSISTENT
        # What rounds to derivatives at the ends, knots and parameters is not looked at.
        note = f"{loose} are rounded numbers, which may explain it." if loose else ""
    open_ = sum(one.kind is Agreement.OFF for one in told)
    if open_ and not loose:
        note = "Neither rounding, cut-off digits nor sampling was found to explain the difference"
        note += "s." if open_ > 1 else "."
    clash = verdict is ClaimVerdict.INCONSISTENT
    fit = {True: "fits", False: "off"}
    # The class of a peak; of other numbers whether they fit.
    words = [fit[one.fits] if one.linear is None else str(one.kind) for one in told]
    return rule.finding(
        row,
        ", ".join(words),
        f"For the printed durations ({called(row.claim)}): {said}.",
        note,
        verdict=verdict,
        basis=Basis.CHECK if all(one.met for one in found) else Basis.COMPUTED,
        claim=claim.id,
        printed=", ".join(map(str, claim.printed)),
        computed="; ".join(one.around for one in found),
        root=f"{claim.quantity}s of {row.claim.id}" if clash else "",
        between=(claim.id, row.claim.id) if clash else (),
    )


TG203 = Explained(
    "TG203",
    "Printed peaks follow from the printed durations",
    "Does a printed peak belong to the motion that it describes?",
    "Supported if it agrees within rounding or with digits cut off, or is slightly lower, as "
    "sampling would give; one number for all joints may be the largest of them or their "
    "largest norm. "
    "Inconsistent if none of these explains it. If the ratio is that of two units, the report "
    "names them.",
    "The exact peak is 21.351 rad/s². A printed 21.35 is rounded, 21.34 comes from sampling, "
    "and 1223 is the same number in degrees.",
    basis=Basis.COMPUTED,
)
TG208 = Explained(
    "TG208",
    "Printed means and integrals follow from the printed durations",
    "Does a printed mean, root mean square or integral of velocity, acceleration or jerk "
    "belong to the motion that it describes?",
    "Supported if it agrees within rounding, with digits cut off, or with 50 samples or more; "
    "one number for all joints may be of their norm, of the largest joint, or their mean or "
    "sum. "
    "Inconsistent if none of these explains it.",
    "The root mean square of jerk is 5.1920 rad/s³, and 1000 samples give the printed 5.1908.",
    basis=Basis.COMPUTED,
)
TG211 = Explained(
    "TG211",
    "Printed values at one place follow from the printed durations",
    "Does a printed position or derivative at a way-point, at an instant or at its largest "
    "value follow from the printed durations?",
    "Inconsistent if it differs by more than the printed digits allow. If a derivative jumps, "
    "either side may be meant; a largest or smallest value may also come from samples.",
    "At the second way-point a table prints -175.7 °/s. The spline through the way-points in "
    "the printed times passes it at -175.71 °/s.",
    basis=Basis.COMPUTED,
)


@rule_group(TG203, TG208, TG211)
def judge_numbers(study: Study) -> Iterator[Finding]:
    """Findings of TG203, TG208 and TG211."""
    without = "No durations are printed from which this peak could be computed."
    yield from _judged(study, TG203, PeakClaim, peak_beside, peak_described, without)
    yield from _judged(study, TG208, MeasureClaim, measure_beside, measure_described)
    yield from _judged(study, TG211, ValueClaim, value_beside, value_described)
