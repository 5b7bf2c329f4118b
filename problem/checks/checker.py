"""The only judge of feasibility: true peaks against limits, with a bound on rounding errors."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..curves import Enclosed, Extremum, Furthest, Trajectory, as_durations, furthest
from ..errors import CurveError, SingularError
from ..in_notebooks import InNotebooks
from ..limits import BRAKING, ORDERS, QUANTITIES, half_range
from ..problem import Problem
from .jumps import Jump, jumps_of
from .one_sided import one_sided_extreme

TOLERANCE = 1e-9
"""Relative excess over a limit that still counts as keeping it."""
STANDING = 1e-9
"""Share of a joint's largest speed below which it stands, and neither speeds up nor brakes."""


class Verdict(StrEnum):
    """Outcome of a check, for all t."""

    PASS = "pass"
    """Every limit is kept within the tolerance, rounding errors included."""
    VIOLATED = "violated"
    """Some limit is exceeded by more than the tolerance, rounding errors included."""
    DISCONTINUOUS = "discontinuous"
    """Position or velocity jumps at a break; or acceleration, if jerk or snap is limited; or jerk,
    if snap is limited."""
    UNDECIDED = "undecided"
    """The bound on rounding errors does not separate the peak from its limit."""


@dataclass(frozen=True)
class Peak:
    """The largest value of one quantity of one joint, compared with its limit."""

    joint: str | None
    """Joint label; None for a segment duration."""
    quantity: str
    """"position", "velocity", "acceleration", "deceleration", "jerk", "snap", "duration"; or
    "curve" if the durations define none."""
    segment: int
    """Segment, from 0."""
    time: float | None
    """Time on the trajectory, s."""
    value: float
    limit: float
    """In rad, s; the limit of a derivative as a size, that of the side with the larger ratio."""
    ratio: float
    """|value|/limit; above 1 the limit is exceeded. 0 if only the other side is limited."""
    error: float
    """Bound on the rounding error of ``value``."""

    @property
    def margin(self) -> float:
        """1 − ratio: the remaining share of the limit."""
        return 1.0 - self.ratio


@dataclass(frozen=True, eq=False)
class Check(InNotebooks):
    """The result of a check of one duration vector.

    Attributes
    ----------
    feasible_time, tight_time : float or None
        T·max(1, c*), the uniform repair; T·c*, the free rescaling. None if there is none; a reason
        is given.
    """

    verdict: Verdict
    limits: Verdict
    """The verdict on the limits alone, apart from jumps: pass, violated or undecided. The limits
    may be kept inside every piece although the motion jumps between pieces."""
    worst: Peak | None
    """Largest ratio; None if nothing is limited. A duration counts only beyond its bound."""
    peaks: tuple[Peak, ...]
    """One per joint and quantity."""
    jumps: tuple[Jump, ...]
    """Discontinuities of position, velocity and acceleration, and of jerk if snap is limited."""
    total_time: float
    """Sum of the durations, s."""
    stretch: float
    """c* = max (|v|/V, √(|a|/A), ∛(|j|/J), ∜(|s|/S)): stretching all durations by it makes them
    tight."""
    feasible_time: float | None
    feasible_why: str | None
    tight_time: float | None
    tight_why: str | None
    tolerance: float
    """Relative excess that counts as kept."""

    @property
    def max_violation(self) -> float:
        """Largest relative excess over any limit, 0 if none."""
        return max([0.0, *(p.ratio - 1.0 for p in self.peaks)])

    def __str__(self) -> str:
        lines = [f"{self.verdict} (for all t, relative tolerance {self.tolerance:g})"]
        lines.append(f"total time      {self.total_time:.6f} s")
        if self.worst is not None:
            w = self.worst
            where = f"joint {w.joint}" if w.joint is not None else f"segment {w.segment + 1}"
            at = f" at t = {w.time:.6f} s" if w.time is not None else ""
            lines.append(
                f"worst           {where} {w.quantity} {w.value:.6g} against {w.limit:.6g}"
                f" (ratio {w.ratio:.9f}){at}"
            )
        if self.jumps:
            top = max(self.jumps, key=lambda jump: (-jump.order, abs(jump.size)))
            lines.append(
                f"jumps           {len(self.jumps)}, the largest of {ORDERS[top.order]} by "
                f"{top.size:.6g} at t = {top.time:.6f} s (joint {top.joint}); "
                f"limits, apart from jumps: {self.limits}"
            )
        for name, time, why in (
            ("feasible time", self.feasible_time, self.feasible_why),
            ("tight time", self.tight_time, self.tight_why),
        ):
            lines.append(f"{name:<15} " + (f"{time:.6f} s" if time is not None else f"none: {why}"))
        return "\n".join(lines)


def _derivative_peaks(
    problem: Problem,
    h: Array,
    trajectory: Trajectory,
    error: Array,
) -> list[Peak]:
    """The deciding peak of each limited derivative, by joint, then by order."""
    sides, peaks = problem.limits.sides, []
    limited = np.isfinite(sides)
    orders = np.flatnonzero(limited.any(axis=(0, 1))).tolist()
    reach = {r: furthest(trajectory, r + 1, error[:, r + 1]) for r in orders}
    for j, r in np.argwhere(limited.any(axis=0)).tolist():
        if r == 1 and problem.limits.braking[j]:
            peaks += _one_sided_peaks(problem, h, trajectory, error, j)
            continue
        top, size, ratio, bound = _nearest(
            trajectory, reach[r], j, sides[:, j, r].tolist(), error[:, r + 1]
        )
        at = problem.curve.segment_of(h, top)
        label, quantity = problem.joints[j], QUANTITIES[r]
        peaks.append(Peak(label, quantity, at, top.time, top.value, size, ratio, bound))
    return peaks


def _one_sided_peaks(
    problem: Problem, h: Array, trajectory: Trajectory, error: Array, j: int
) -> list[Peak]:
    """The largest acceleration while the speed of a joint grows, and while it falls."""
    fastest = float(np.nanmax(np.abs(trajectory.turns(1)[1][:, :, j])))
    rest = max(STANDING * fastest, 2.0 * float(error[:, 1, j].max()))
    found = []
    for sign, quantity, size in (
        (1.0, QUANTITIES[1], float(problem.limits.ends(QUANTITIES[1])[1][j])),
        (-1.0, BRAKING, float(problem.limits.deceleration[j])),
    ):
        top = one_sided_extreme(trajectory, error, j, sign, rest)
        bound = max(top.most - abs(top.value), abs(top.value) - top.sure)
        time = float(trajectory.times(top.piece, np.array(top.s)))
        at = problem.curve.segment_of(h, Extremum(j, top.piece, 2, top.s, time, top.value))
        ratio = _size_ratio(abs(top.value), size, bound)
        found.append(Peak(problem.joints[j], quantity, at, time, top.value, size, ratio, bound))
    return found


def _nearest(
    trajectory: Trajectory, reach: Furthest, j: int, sizes: list[float], errors: Array
) -> tuple[Extremum, float, float, float]:
    """The extremum nearest to its limit or furthest beyond it, that limit, its ratio, an error.

    No value on either side goes further beyond its limit than ratio + error/size: the true peak is
    at least its own extremum less that one's error, and at most what `Furthest` says that none is
    beyond. So a short segment, whose error is large but whose values are small, does not blur the
    peak of another.
    """
    found = []
    for side, size in enumerate(sizes):
        if np.isfinite(size):
            best, sign = reach.at(trajectory, side, j), (-1.0, 1.0)[side]
            top, most = sign * best.value, sign * float(reach.outer[side, j])
            ratio = _size_ratio(top, size, max(float(errors[best.segment, j]), most - top))
            # What is not a number decides; of equal ones the first in time.
            order = (np.inf if np.isnan(ratio) else ratio, top, -best.segment, -best.s)
            found.append((order, best, size, top, most))
    _, best, size, top, _ = max(found, key=lambda one: one[0])
    outer = [
        most if own == size else most / own * size
        for *_, own, _, most in found
        if own or own == size
    ]
    bound = max(float(errors[best.segment, j]), max(outer) - top)
    return best, size, _size_ratio(top, size, bound), bound


def _size_ratio(top: float, size: float, error: float) -> float:
    """What lies on one side over its limit; what may be 0 keeps a limit of 0."""
    if size == 0.0:
        return 0.0 if top <= error else np.inf
    return float(np.maximum(0.0, top)) / size


def _position_peaks(
    problem: Problem,
    h: Array,
    trajectory: Trajectory,
    error: Array,
) -> list[Peak]:
    peaks: list[Peak] = []
    if not problem.limits.limits_position:
        return peaks
    reach = furthest(trajectory, 0, error[:, 0])
    for j, label in enumerate(problem.joints):
        low, high = problem.limits.position_lower[j], problem.limits.position_upper[j]
        if not (np.isfinite(low) or np.isfinite(high)):
            continue
        for limit, sign, side in ((low, -1.0, 0), (high, 1.0, 1)):
            if not np.isfinite(limit):
                continue
            top = reach.at(trajectory, side, j)
            excess = sign * (top.value - limit)
            half = half_range(low, high, limit)
            bound = float(error[:, 0, j].max())
            ratio = 1.0 + excess / half if half > 0 else _size_ratio(abs(excess), 0.0, bound)
            at = problem.curve.segment_of(h, top)
            peaks.append(
                Peak(label, "position", at, top.time, top.value, float(limit), ratio, bound)
            )
    return peaks


def _slack(problem: Problem, peak: Peak) -> float:
    """Bound on the rounding error of a peak's ratio."""
    scale = peak.limit
    if peak.quantity == "position":
        limits, j = problem.limits, problem.joints.index(str(peak.joint))
        scale = half_range(limits.position_lower[j], limits.position_upper[j], peak.limit)
    return peak.error / scale if scale else 0.0


def _duration_peaks(problem: Problem, h: Array) -> list[Peak]:
    peaks = []
    bounded = (problem.duration_lower > 0) | np.isfinite(problem.duration_upper)
    for k in np.flatnonzero(bounded).tolist():
        d, low, high = h[k], problem.duration_lower[k], problem.duration_upper[k]
        if low > 0:
            peaks.append(Peak(None, "duration", k, None, float(d), float(low), float(low / d), 0.0))
        if np.isfinite(high):
            peaks.append(
                Peak(None, "duration", k, None, float(d), float(high), float(d / high), 0.0)
            )
    return peaks


def _no_curve(problem: Problem, h: Array, why: CurveError, tolerance: float) -> Check:
    """Durations that define no curve keep no limit; where rounding hides it, nothing is decided."""
    verdict = Verdict.UNDECIDED if isinstance(why, SingularError) else Verdict.VIOLATED
    peak = Peak(None, "curve", why.segment, None, why.value, 0.0, np.inf, 0.0)
    return Check(
        verdict=verdict,
        limits=verdict,
        worst=peak,
        peaks=(peak, *_duration_peaks(problem, h)),
        jumps=(),
        total_time=float(h.sum()),
        stretch=np.inf,
        feasible_time=None,
        feasible_why=str(why),
        tight_time=None,
        tight_why=str(why),
        tolerance=tolerance,
    )


def _rescaled(
    problem: Problem, h: Array, factor: float, peaks: list[Peak]
) -> tuple[float | None, str | None]:
    stretched = h * factor
    slack = 1 + TOLERANCE
    if not np.isfinite(factor):
        return None, "a joint with limit 0 moves, which no stretch repairs"
    if factor != 1.0 and not problem.curve.homogeneous:
        return None, "a prescribed end derivative is not 0, and stretching would change it"
    if any(p.quantity == "position" and p.ratio > 1 + TOLERANCE for p in peaks):
        return None, "a position limit is exceeded, and stretching does not change the path"
    if (stretched * slack < problem.duration_lower).any():
        return None, "a stretched duration falls below its lower bound"
    if (stretched > problem.duration_upper * slack).any():
        return None, "a stretched duration exceeds its upper bound"
    if factor == 0.0:
        return None, "nothing moves or nothing is limited, so the total time can shrink to 0"
    return float(stretched.sum()), None


def check(
    problem: Problem,
    durations: ArrayLike,
    nodal: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
) -> Check:
    """Judge one duration vector at all t, whatever produced it.

    Parameters
    ----------
    durations : array_like, shape (segments,)
        Segment durations shared by all joints, s.
    nodal : array_like, shape (free, joints), optional
        Values of the free derivatives of an under-determined curve.
    tolerance : float
        Relative excess over a limit that still counts as keeping it.

    Raises
    ------
    TrajgapError
        If the durations have the wrong length or are not positive and finite.
    """
    h = as_durations(durations, problem.segments)
    extra = None if nodal is None else np.asarray(nodal, dtype=np.float64)
    try:
        found = problem.curve.enclosed(problem.waypoints, h, extra)
    except CurveError as why:
        return _no_curve(problem, h, why, tolerance)
    judged, hidden = _judged(problem, h, found, tolerance)
    # A closer bound is asked for where the ratio may be off by a tenth of the tolerance.
    loose = any(_slack(problem, p) > TOLERANCE / 10 * max(1.0, p.ratio) for p in judged.peaks)
    if found.closer is not None and (hidden or loose or judged.verdict is Verdict.UNDECIDED):
        with suppress(SingularError):  # the first bound holds all the same
            judged, _ = _judged(problem, h, found.closer(), tolerance)
    return judged


def _judged(problem: Problem, h: Array, found: Enclosed, tolerance: float) -> tuple[Check, bool]:
    """What a trajectory and its bound say, and whether the bound may hide a jump."""
    trajectory, error = found.trajectory, found.error
    peaks = [
        *_derivative_peaks(problem, h, trajectory, error),
        *_position_peaks(problem, h, trajectory, error),
        *_duration_peaks(problem, h),
    ]
    jumps, hidden = jumps_of(problem, trajectory, error)
    forbidden = problem.limits.smooth_orders
    serious = [jump for jump in jumps if jump.order <= forbidden[problem.joints.index(jump.joint)]]
    verdict = Verdict.PASS
    for p in peaks:
        slack = _slack(problem, p)
        if p.ratio - slack > 1 + tolerance:
            verdict = Verdict.VIOLATED
            break
        if not p.ratio + slack <= 1 + tolerance:
            verdict = Verdict.UNDECIDED
    about_limits = verdict
    if serious and verdict is not Verdict.VIOLATED:
        verdict = Verdict.DISCONTINUOUS
    roots = {q: 1.0 / r for r, q in enumerate(QUANTITIES, start=1)} | {BRAKING: 0.5}
    stretch = max([0.0, *(p.ratio ** roots[p.quantity] for p in peaks if p.quantity in roots)])
    feasible_time, feasible_why = _rescaled(problem, h, max(1.0, stretch), peaks)
    tight_time, tight_why = _rescaled(problem, h, stretch, peaks)
    if serious:
        feasible_time, tight_time = None, None
        feasible_why = tight_why = "the motion jumps at a break, which stretching does not repair"
    elif any(p.quantity in roots and _slack(problem, p) >= 1.0 for p in peaks):
        feasible_time, tight_time = None, None
        feasible_why = tight_why = "rounding errors hide whether a stretch repairs it"
    judged = Check(
        verdict=verdict,
        limits=about_limits,
        worst=max(
            (p for p in peaks if p.quantity != "duration" or p.ratio > 1 + tolerance),
            key=lambda p: p.ratio,
            default=None,
        ),
        peaks=tuple(peaks),
        jumps=tuple(jumps),
        total_time=float(h.sum()),
        stretch=float(stretch),
        feasible_time=feasible_time,
        feasible_why=feasible_why,
        tight_time=tight_time,
        tight_why=tight_why,
        tolerance=tolerance,
    )
    return judged, hidden
