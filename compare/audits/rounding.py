"""A printed solution judged however its digits were rounded, and totals that no motion takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

import numpy as np

from ...nlp.enclosure import (
    EPS,
    Ball,
    Place,
    bound_by_bisection,
    bound_ratio,
    linear_program,
    rows_at,
)
from ...problem import (
    TOLERANCE,
    Array,
    Check,
    CurveError,
    Interval,
    Printed,
    Problem,
    TrajgapError,
    Verdict,
    check,
    peak_gradients,
)
from ...problem.cases import RoundingBox as RoundingBox
from ..documents import Rounding

ROUNDING = 1e-9
"""Relative margin of every comparison of computed numbers: far above what float64 loses in long
sums, and what `check` tolerates; far below any printed digit."""
FEW_ROUNDINGS = 1e-12
"""The same where a few sums, products and quotients lie between two numbers."""


class Agreement(StrEnum):
    """How a printed number agrees with what others allow it to be, the most charitable first."""

    ROUNDING = "rounding"
    CUT_OFF = "cut off"
    MIXED = "some rounded, others cut off"
    RAISED = "rounded up"
    RAISED_PARTS = "parts rounded up"
    SAMPLING = "sampling"
    NORM = "norm over the joints"
    ROOT = "root left out"
    UNIT = "other unit"
    OFF = "off"


Ends = tuple[Fraction | float, Fraction | float]
"""The lower and the upper end of an interval, both inside; an `Interval` is one."""


def rounds_to(interval: tuple[float, float], time: float) -> bool:
    """Whether a computed time lies in an interval, but for what floats round."""
    return meet(interval, (time * (1.0 - ROUNDING), time * (1.0 + ROUNDING)))


def meet(a: Ends, b: Ends) -> bool:
    """Whether two intervals have a number in common."""
    return bool(a[0] <= b[1] and b[0] <= a[1])


def agreement(*tried: tuple[Agreement, Ends, Ends]) -> Agreement:
    """The first explanation under which what digits stand for meets what is computed.

    Each comes with the ends of the printed number and of the computed one, most charitable first.
    """
    return next((kind for kind, own, computed in tried if meet(own, computed)), Agreement.OFF)


def either(a: Interval, b: Interval) -> Interval:
    """The least interval that holds two."""
    return Interval(min(a.lower, b.lower), max(a.upper, b.upper))


def hull(number: Printed) -> Interval:
    """Every value whose digits, rounded or cut off, are the printed ones."""
    return either(number.interval, number.truncated)


@dataclass(frozen=True, eq=False)
class Point:
    """One point of the box: durations (segments,) in s, way-points (way-points, joints) in rad."""

    durations: Array
    waypoints: Array


@dataclass(frozen=True, eq=False)
class RoundingVerdict:
    """What `judge_rounding` found.

    Attributes
    ----------
    worst_at_print : float
        Largest ratio of a peak to its limit at the printed point; 0 if nothing is limited.
    exhibit : Point, Place or None
        A point that passes (keeps, consistent), the place of the excess (breaks), else None.
    lower_bound_of_worst : float or None
        Rigorous lower bound of the worst ratio over every point of the box whose durations lie
        within their bounds (over every point, if none does); None if none was computed.
    """

    verdict: Rounding
    worst_at_print: float
    exhibit: Point | Place | None
    lower_bound_of_worst: float | None


def judge_rounding(
    problem: Problem,
    durations: RoundingBox,
    waypoints: RoundingBox | None = None,
    loosest: Problem | None = None,
    loose_ends: bool = False,
) -> RoundingVerdict:
    """Judge a printed solution for all values that round to its digits.

    Parameters
    ----------
    problem : Problem
        All its joints share the durations; use `Problem.joint` for the row of one joint. Its
        limits and duration bounds are those printed.
    durations : RoundingBox, shape (segments,)
        s.
    waypoints : RoundingBox, shape (way-points, joints), optional
        rad, instead of the problem's own, which are used as exact by default.
    loosest : Problem, optional
        The same problem with every limit and every bound on durations as loose as its printed
        digits allow; by default they are exact.
    loose_ends : bool
        Whether derivatives at the ends are printed numbers. No proof covers their rounding,
        so nothing is called broken then.

    Raises
    ------
    TrajgapError
        If a shape does not fit the problem, a printed duration is not positive, or the
        interpolant leaves coefficients free.

    Notes
    -----
    `keeps` and `consistent` rest on `check` at one point. `breaks` rests on a proof that no
    rounding can upset (`bound` and `interval`). A velocity that jumps is not an excess over a
    limit: where nothing else is wrong, the answer is `undecided`.
    """
    found = _judge(problem, durations, waypoints)
    kept = (Rounding.KEEPS, Rounding.CONSISTENT)
    exact = loosest is None or same_limits(problem, loosest)
    if loosest is not None and not exact and found.verdict not in kept:
        wide = _judge(loosest, durations, waypoints)
        verdict = Rounding.CONSISTENT if wide.verdict in kept else wide.verdict
        found = replace(wide, verdict=verdict, worst_at_print=found.worst_at_print)
    if loose_ends and found.verdict is Rounding.BREAKS:
        return RoundingVerdict(Rounding.UNDECIDED, found.worst_at_print, None, None)
    return found


def same_limits(one: Problem, other: Problem) -> bool:
    """Whether two problems have equal limits and bounds on the durations."""
    return (
        one.limits.same(other.limits)
        and np.array_equal(one.duration_lower, other.duration_lower)
        and np.array_equal(one.duration_upper, other.duration_upper)
    )


def _judge(
    problem: Problem, durations: RoundingBox, waypoints: RoundingBox | None
) -> RoundingVerdict:
    q = RoundingBox.exact(problem.waypoints) if waypoints is None else waypoints
    if q.value.shape != problem.waypoints.shape:
        raise TrajgapError(
            f"waypoints: the box has shape {q.value.shape}, "
            f"but the problem has {problem.waypoints.shape}; give both the same shape"
        )
    at_print = check(replace(problem, waypoints=q.value), durations.value)
    worst = 0.0 if at_print.worst is None else at_print.worst.ratio
    if at_print.verdict is Verdict.PASS:
        return RoundingVerdict(Rounding.KEEPS, worst, Point(durations.value, q.value), None)
    outside = _outside_bounds(problem, durations)
    if outside is not None:
        return RoundingVerdict(Rounding.BREAKS, worst, outside, outside.lower_bound)
    if at_print.worst is not None and at_print.worst.quantity == "curve":
        # Bounds are built around the printed point, which defines no curve here.
        return RoundingVerdict(Rounding.UNDECIDED, worst, None, None)
    ball = Ball.between(q.lower, q.upper)
    target = 1.0 + TOLERANCE
    # All of the box that `check` does not refuse for a duration outside its bounds; where that is
    # empty, which only the last bits can make it, one end is as good as the other.
    slack = (1.0 + TOLERANCE) * (1.0 + 4.0 * EPS)
    least = np.maximum(durations.lower, problem.duration_lower / slack * (1.0 - 4.0 * EPS))
    most = np.minimum(durations.upper, problem.duration_upper * slack)
    root = bound_ratio(problem, np.minimum(least, most), np.maximum(least, most), ball)
    if root.value > target:
        return RoundingVerdict(Rounding.BREAKS, worst, root.place, root.value)
    best, passed = _search(problem, durations, q, at_print)
    if passed:
        return RoundingVerdict(Rounding.CONSISTENT, worst, best, max(root.value, 0.0) or None)
    found = rows_at(replace(problem, waypoints=best.waypoints), best.durations)
    if found.ratios().max(initial=-np.inf) <= target:
        return RoundingVerdict(Rounding.UNDECIDED, worst, None, max(root.value, 0.0) or None)
    proof = bound_by_bisection(problem, root, ball, target, found)
    if proof.value > target:
        return RoundingVerdict(Rounding.BREAKS, worst, proof.place, proof.value)
    return RoundingVerdict(Rounding.UNDECIDED, worst, None, max(proof.value, 0.0) or None)


def _outside_bounds(problem: Problem, durations: RoundingBox) -> Place | None:
    """The duration that lies farthest outside its bounds wherever in the box it is, if any."""
    short = problem.duration_lower / np.maximum(durations.upper, np.finfo(np.float64).tiny)
    long = durations.lower / problem.duration_upper
    ratio = np.nextafter(np.maximum(short, long), -np.inf)
    k = int(np.argmax(ratio))
    if not ratio[k] > 1.0 + TOLERANCE:
        return None
    return Place(None, "duration", k, None, float(ratio[k]))


def _search(
    problem: Problem, durations: RoundingBox, waypoints: RoundingBox, at_print: Check
) -> tuple[Point, bool]:
    """Look for a passing point: cheap candidates, then descent from the best of them."""
    least, most = durations.inside()
    # Digits that stand for 0 as well: the search stays where a duration is positive.
    least = np.maximum(least, 1e-3 * durations.value)
    least = np.minimum(np.maximum(least, problem.duration_lower), most)
    most = np.maximum(np.minimum(most, problem.duration_upper), least)
    start, inner = np.clip(durations.value, least, most), waypoints.inside()
    angles = np.clip(waypoints.value, *inner)
    candidates = [start, most]
    if np.isfinite(at_print.stretch):
        repaired = start * (at_print.stretch * (1.0 + FEW_ROUNDINGS))
        widest = start * (most / start).min()
        candidates[:0] = [np.clip(h, least, most) for h in (repaired, widest)]
    tried: list[tuple[float, Point]] = []
    for h in candidates:
        point = Point(h, angles)
        result = _checked(problem, point)
        if result.verdict is Verdict.PASS:
            return point, True
        tried.append((np.inf if result.worst is None else result.worst.ratio, point))
    best = min(tried, key=lambda one: one[0])[1]
    return _descend(problem, best, np.append(least, inner[0]), np.append(most, inner[1]))


def _checked(problem: Problem, point: Point) -> Check:
    return check(replace(problem, waypoints=point.waypoints), point.durations)


def _descend(problem: Problem, start: Point, low: Array, high: Array) -> tuple[Point, bool]:
    """Lower the worst ratio by sequential linear programs in a trust region.

    Every peak's exact gradient by the durations and its joint's way-points makes one row; `reach`
    is the trust region as a share of the box, whose ends hold durations and then way-points.
    """
    span = high - low
    n, shape = problem.segments, problem.waypoints.shape
    x = np.append(start.durations, start.waypoints)
    point, reach, worst = start, 1.0, np.inf
    trial = point
    # Descents that find a passing point need fewer than 5 linear programs.
    for _ in range(12):
        there = replace(problem, waypoints=trial.waypoints)
        try:
            # More than 300 peaks in one linear program change its answer no further.
            rows = rows_at(there, trial.durations, 300)
            ratios = rows.ratios()
            ratio = float(ratios.max(initial=-np.inf))
        except CurveError:  # no spline passes these way-points at these times
            ratio = np.inf
        if ratio < worst:
            gain, worst, point = worst - ratio, ratio, trial
            x = np.append(point.durations, point.waypoints)
            passing = ratio <= 1.0 + TOLERANCE
            if passing and _checked(problem, point).verdict is Verdict.PASS:
                return point, True
            if gain < 1e-13 or not 0.0 < ratio < np.inf:
                break  # no gain, nothing is limited, or nothing moves as far as rounding tells
            rows = rows.pick(np.flatnonzero(ratios > 0.7 * ratio))
            gradients = peak_gradients(there, point.durations, rows.points)
            slope = np.zeros((len(rows.points), *shape))
            for i, e in enumerate(rows.points):
                slope[i, :, e.joint] = gradients.waypoints[i]
            slope = np.hstack([gradients.durations, slope.reshape(len(rows.points), -1)])
            slope = (rows.sign / rows.width)[:, None] * slope * span
            level = rows.ratios()
        else:
            reach *= 0.25
        if not (np.isfinite(worst) and slope.any()):
            break
        with np.errstate(invalid="ignore", divide="ignore"):
            room_low = np.where(span > 0.0, (low - x) / span, 0.0)
            room_high = np.where(span > 0.0, (high - x) / span, 0.0)
        solved = linear_program(
            level, slope, np.maximum(room_low, -reach), np.minimum(room_high, reach)
        )
        if solved is None:
            break
        moved = np.clip(x + solved[0] * span, low, high)
        trial = Point(moved[:n], moved[n:].reshape(shape))
    return point, False


BOXES = 1000
"""Boxes of durations that are examined, each in milliseconds: a few seconds at most, and the result
does not depend on the machine."""


def excludes_total(
    problem: Problem, total: float, waypoints: RoundingBox | None = None, boxes: int = BOXES
) -> bool | None:
    """Prove that no durations of a total or less keep the limits, for all way-points of a box.

    It is True if that is proved, False if nothing is said, None if it would take more boxes. The
    problem has its limits and bounds on durations where they allow most.

    Notes
    -----
    Branch and bound over the durations: the mean speed between way-points bounds each of them
    from below, and each box either holds no durations so short or has a worst ratio above 1,
    proved as for `breaks`.
    """
    q = RoundingBox.exact(problem.waypoints) if waypoints is None else waypoints
    ball = Ball.between(q.lower, q.upper)
    target = 1.0 + TOLERANCE
    low = _least_durations(problem, q) / target * (1.0 - FEW_ROUNDINGS)
    low = np.maximum(low, problem.duration_lower / target * (1.0 - FEW_ROUNDINGS))
    total *= 1.0 + FEW_ROUNDINGS
    if low.sum() > total:
        return True
    # Where coefficients are free, durations alone have no ratios to bound; of more than eight
    # segments, splitting boxes cannot come to an end in time.
    if problem.curve.free or not (low > 0.0).all() or problem.segments > 8:
        return False
    todo = [(low, np.minimum(total - (low.sum() - low), problem.duration_upper * target))]
    for _ in range(boxes):
        if not todo:
            return True
        least, most = todo.pop()
        # No duration is longer than what the total leaves beside the least of all others.
        most = np.minimum(most, total - (least.sum() - least))
        if (most < least).any():
            continue
        bound = bound_ratio(problem, least, most, ball)
        if bound.value > target:
            continue
        widths = most / least
        k = int(np.argmax(widths))
        if widths[k] <= 1.0 + 1e-6:
            return False
        cut = float(np.sqrt(least[k] * most[k]))
        upper, lower = most.copy(), least.copy()
        upper[k] = lower[k] = cut
        todo += [(least, upper), (lower, most)]
    return None if todo else True


def _least_durations(problem: Problem, waypoints: RoundingBox) -> Array:
    """Durations below which the mean speed between two way-points exceeds a velocity limit."""
    least = np.zeros(problem.segments)
    breaks = problem.curve.waypoint_breaks
    most = problem.limits.widest[:, 0]
    speed = np.where(most > 0.0, most, np.inf)
    for w, ways in enumerate(waypoints.steps[0]):
        if breaks[w + 1] - breaks[w] == 1:
            least[breaks[w]] = float((ways / speed).max())
    return least
