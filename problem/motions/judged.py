"""The verdict on a motion from elsewhere: every limit for all t, jumps, and the repair."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..checks import Verdict, one_sided_extreme
from ..curves import Trajectory, furthest
from ..errors import TrajgapError
from ..limits import half_range
from .floor import Floor, least_time
from .joint_limits import BRAKING, ORDERS, JointLimits, unstated_words
from .motion import EPS, Motion, derivative_terms

MOTION_TOLERANCE = 1e-6
"""Relative excess over a limit that still counts as keeping it: files carry printed digits."""
_ROUNDING = 1e-9
"""What planners round by at most: a share of a joint's largest speed below which it stands, and of
the terms of a derivative that differ at a break."""


@dataclass(frozen=True)
class MotionPeak:
    """The value of one quantity of one joint nearest to its limit, or furthest beyond."""

    joint: str
    quantity: str
    """The quantity is "position", "velocity", "acceleration", "deceleration" or "jerk"."""
    time: float
    """s."""
    value: float
    limit: float
    """rad, s; signed."""
    ratio: float
    """value/limit; of a position 1 + excess over half of the range. Above 1 it is exceeded."""
    least_ratio: float
    most_ratio: float
    """Bounds of the ratio, all errors included."""
    source: str
    """Where the limit is stated."""


@dataclass(frozen=True)
class MotionJump:
    """The largest jump of one derivative of one joint, and how many there are."""

    joint: str
    quantity: str
    time: float
    """s."""
    size: float
    """rad/sᵒʳᵈᵉʳ; value after minus value before."""
    count: int
    """Number of breaks at which it jumps."""


@dataclass(frozen=True, eq=False)
class MotionCheck:
    """The result of a check of a motion, or of all motions through samples."""

    verdict: Verdict
    limits: Verdict
    """Verdict on the limits alone, apart from jumps."""
    worst: MotionPeak | None
    """Largest ratio; None if nothing is limited."""
    peaks: tuple[MotionPeak, ...]
    """One for each limited quantity of each joint."""
    jumps: tuple[MotionJump, ...]
    total_time: float
    """s."""
    stretch: float
    """Uniform slow-down that repairs the motion: all durations times this factor keep the limits;
    at least 1. For samples: no smaller factor can repair any motion through them."""
    feasible_time: float | None
    """``total_time`` times ``stretch``; None if there is none, with a reason."""
    feasible_why: str | None
    floor: Floor | None
    """No motion between the same standstills is shorter."""
    floor_why: str | None
    concluded: tuple[str, ...]
    open: tuple[str, ...]
    """Conclusions from the file, and what remains open."""
    tolerance: float
    not_judged: tuple[tuple[str, str], ...]
    """Joint and quantity wherever no limit is stated: the verdict does not cover them."""
    joints: tuple[str, ...]

    def __str__(self) -> str:
        silent = unstated_words(self.not_judged, self.joints)
        beside = f"; not judged: {silent}" if silent else ""
        lines = [f"{self.verdict} (relative tolerance {self.tolerance:g}){beside}"]
        lines.append(f"total time      {self.total_time:.6f} s")
        if self.worst is not None:
            w = self.worst
            lines.append(
                f"worst           joint {w.joint} {w.quantity} {w.value:.6g} against {w.limit:.6g}"
                f" (ratio {w.ratio:.6f}) at t = {w.time:.6f} s; limit from {w.source}"
            )
        lines += [
            f"jumps           {one.quantity} of joint {one.joint} at {one.count} breaks, by "
            f"{one.size:.6g} at t = {one.time:.6f} s"
            for one in self.jumps[:1]
        ]
        repaired = (
            f"{self.feasible_time:.6f} s, slower by {self.stretch:.6f}"
            if self.feasible_time is not None
            else f"none: {self.feasible_why}"
        )
        lines.append(f"repaired        {repaired}")
        if self.floor is not None:
            lines.append(f"floor           {self.floor}")
        return "\n".join([*lines, *self.concluded, *self.open])


def check_motion(
    motion: Motion, limits: JointLimits, tolerance: float = MOTION_TOLERANCE
) -> MotionCheck:
    """Judge a motion for all t, by its true extrema.

    Parameters
    ----------
    limits : JointLimits
        For the same joints in the same order.
    tolerance : float
        Relative excess over a limit that still counts as keeping it.
    """
    check_same_joints(motion.joints, limits)
    peaks, standing = _peaks(motion, limits)
    about_limits = judged(peaks, tolerance)
    jumps, hidden = _jumps(motion)
    jerks = np.isfinite(limits.lower[:, 3]) | np.isfinite(limits.upper[:, 3])

    def serious(joint: str, quantity: str) -> bool:
        return ORDERS.index(quantity) < 2 or bool(jerks[motion.joints.index(joint)])

    verdict = about_limits
    jumping = any(serious(one.joint, one.quantity) for one in jumps)
    may_jump = [one for one in hidden if serious(*one)]
    if jumping and verdict is not Verdict.VIOLATED:
        verdict = Verdict.DISCONTINUOUS
    elif may_jump and verdict is Verdict.PASS:
        verdict = Verdict.UNDECIDED
    stretch, why = slow_down(peaks, tolerance)
    if jumping:
        why = "the motion jumps, which slowing down does not repair"
    elif may_jump and why is None:
        why = "the motion may jump, which slowing down would not repair"
    floor, floor_why = least_time(motion, limits, standing)
    every = "The bounds hold for" if verdict is Verdict.UNDECIDED else "The verdict holds for"
    concluded = f"{every} every instant: {motion.between}."
    undecided: list[str] = []
    if Verdict.UNDECIDED in (verdict, about_limits):
        undecided += blurred(peaks, tolerance)
        if may_jump and not jumping:
            joint, quantity = may_jump[0]
            undecided.append(f"The {quantity} of joint {joint} may jump by less than the noise.")
        exact = "Rounding may change the result by as much as the distance to a limit."
        undecided.append(motion.advice or exact)
    return MotionCheck(
        verdict=verdict,
        limits=about_limits,
        worst=worst_of(peaks, about_limits),
        peaks=peaks,
        jumps=jumps,
        total_time=motion.total_time,
        stretch=stretch,
        feasible_time=None if why else motion.total_time * stretch,
        feasible_why=why,
        floor=floor,
        floor_why=floor_why,
        concluded=(concluded, *((motion.assumed,) if motion.assumed else ())),
        open=tuple(undecided),
        tolerance=tolerance,
        not_judged=limits.unstated,
        joints=motion.joints,
    )


def worst_of(peaks: Sequence[MotionPeak], verdict: Verdict) -> MotionPeak | None:
    """The peak that the verdict stands on: a violation is shown by what is sure of it."""
    if verdict is Verdict.VIOLATED:
        return max(peaks, key=lambda p: p.least_ratio)
    return max(peaks, key=lambda p: p.ratio, default=None)


def blurred(peaks: Sequence[MotionPeak], tolerance: float) -> list[str]:
    """What is known of the quantity of which least is known: at most one sentence."""
    open_peaks = [p for p in peaks if p.least_ratio <= 1 + tolerance < p.most_ratio]
    if not open_peaks:
        return []
    one = max(open_peaks, key=lambda p: p.most_ratio)
    least = math.floor(1e4 * max(0.0, one.least_ratio)) / 1e4
    most = one.most_ratio
    reach = f"{math.ceil(1e4 * most) / 1e4:g}" if most < 1e6 else "more than a million"
    return [
        f"The {one.quantity} of joint {one.joint} may be anything from {least:g} to {reach} times "
        "its limit; the numbers in the file are not precise enough to say more."
    ]


def check_same_joints(joints: Sequence[str], limits: JointLimits) -> None:
    """Refuse limits of other joints than those of the motion, or in another order."""
    if not isinstance(limits, JointLimits):
        raise TrajgapError(
            f"limits: {type(limits).__name__} is not JointLimits; write JointLimits.of(limits, "
            "joints) for Limits"
        )
    if tuple(joints) != tuple(limits.joints):
        raise TrajgapError(
            f"limits: given for joints {', '.join(limits.joints)}, the motion has "
            f"{', '.join(joints)}; give them in that order"
        )


def judged(peaks: Sequence[MotionPeak], tolerance: float) -> Verdict:
    """The verdict that bounds of ratios allow."""
    if any(p.least_ratio > 1 + tolerance for p in peaks):
        return Verdict.VIOLATED
    if all(p.most_ratio <= 1 + tolerance for p in peaks):
        return Verdict.PASS
    return Verdict.UNDECIDED


def slow_down(peaks: Sequence[MotionPeak], tolerance: float) -> tuple[float, str | None]:
    """Smallest uniform slow-down that brings every ratio to 1, or why there is none.

    Where the noise leaves open which factor that is, the factor is one below which none can be.
    """
    if any(p.quantity == "position" and p.least_ratio > 1 + tolerance for p in peaks):
        return 1.0, "a position limit is exceeded, and slowing down does not change the path"
    if any(p.quantity == "position" and p.most_ratio > 1 + tolerance for p in peaks):
        return 1.0, "a position limit may be exceeded, and slowing down does not change the path"
    powers = {"velocity": 1, "acceleration": 2, BRAKING: 2, "jerk": 3}

    def factor(ratio: Callable[[MotionPeak], float]) -> float:
        held = [p for p in peaks if p.quantity in powers]
        return float(max([1.0, *(max(0.0, ratio(p)) ** (1 / powers[p.quantity]) for p in held)]))

    least = factor(lambda p: p.least_ratio)
    if not np.isfinite(least):
        return least, "a joint that must stand still moves, which slowing down does not repair"
    most = factor(lambda p: p.most_ratio)
    if most > least * (1 + max(tolerance, MOTION_TOLERANCE)):
        needed = f"{math.floor(1e6 * least) / 1e6:.6f} times slower or more is needed, but "
        return least, (
            f"{needed if least > 1 + tolerance else ''}the uncertainty of the numbers leaves open "
            "which slow-down is enough"
        )
    return factor(lambda p: p.ratio), None


def _peaks(motion: Motion, limits: JointLimits) -> tuple[tuple[MotionPeak, ...], Array]:
    """Peaks of all joints, and the speed below which each stands."""
    pieces, powers, _ = motion.scaled.shape
    trajectory = Trajectory(motion.durations, motion.scaled, (powers - 1,) * pieces)
    # Horner's rounding of ten coefficients is 20 · 2⁻⁵³ of a polynomial's absolute terms.
    errors = motion.error + 32 * EPS * derivative_terms(motion.scaled, motion.durations)
    reach = [furthest(trajectory, r, errors[:, r]) for r in range(4)]
    standing = _ROUNDING * np.abs(reach[1].values).max(axis=0)
    peaks: list[MotionPeak] = []
    for j in range(len(motion.joints)):
        for r in range(4):
            if r == 2 and np.isfinite(limits.deceleration[j]):
                peaks += _one_sided(motion, trajectory, errors, limits, j, standing[j])
                continue
            sides = []
            for side, limit in ((0, limits.lower[j, r]), (1, limits.upper[j, r])):
                if not np.isfinite(limit):
                    continue
                k, s = int(reach[r].pieces[side, j]), float(reach[r].places[side, j])
                time = float(motion.breaks[k] + s * motion.durations[k])
                half = half_range(limits.lower[j, 0], limits.upper[j, 0], limit) if r == 0 else None
                of = (reach[r].values, reach[r].inner, reach[r].outer)
                value, inner, outer = (float(one[side, j]) for one in of)
                sides.append(
                    peak(limits, j, ORDERS[r], time, (value, inner, outer), limit, side, half)
                )
            if sides:
                peaks.append(joined(sides))
    return tuple(peaks), standing


def _one_sided(
    motion: Motion,
    trajectory: Trajectory,
    errors: Array,
    limits: JointLimits,
    j: int,
    standing: float,
) -> list[MotionPeak]:
    """Acceleration while the speed grows, deceleration while it falls."""
    peaks = []
    for sign, quantity, limit in (
        (1.0, "acceleration", limits.upper[j, 2]),
        (-1.0, BRAKING, limits.deceleration[j]),
    ):
        if not np.isfinite(limit):
            continue
        found = one_sided_extreme(trajectory, errors, j, sign, standing)
        time = float(motion.breaks[found.piece] + found.s * motion.durations[found.piece])
        best = abs(found.value)
        values = (best, found.sure, max(best, found.most))
        one = peak(limits, j, quantity, time, values, limit, 1, None)
        sign_of = -1.0 if found.value < 0 else 1.0
        peaks.append(replace(one, value=sign_of * one.value, limit=sign_of * one.limit))
    return peaks


def peak(
    limits: JointLimits,
    joint: int,
    quantity: str,
    time: float,
    values: tuple[float, float, float],
    limit: float,
    side: int,
    half: float | None,
) -> MotionPeak:
    """A value beside its limit; ``side`` is 0 for a lower limit, 1 for an upper one.

    ``values`` are the one found, one that is surely reached, and one that nothing is beyond;
    ``half`` is given for positions alone.
    """

    def ratio(of: float) -> float:
        if np.isnan(of):
            return np.inf
        if half is not None:
            beyond = of - limit if side else limit - of
            return 1.0 + beyond / half if half > 0 else (1.0 if beyond <= 0 else np.inf)
        reach = max(0.0, of if side else -of)
        if limit == 0.0:
            return 0.0 if reach == 0.0 else np.inf
        return float(reach / abs(limit))

    name = limits.joints[joint]
    value, inner, outer = values
    least, most = ratio(inner), ratio(outer)
    if not np.isfinite(values).all():
        least, most = 0.0, np.inf  # what is no number shows nothing, neither kept nor broken
    return MotionPeak(
        name,
        quantity,
        time,
        float(value),
        float(limit),
        ratio(value),
        least,
        most,
        limits.source(name, quantity),
    )


def joined(sides: Sequence[MotionPeak]) -> MotionPeak:
    """The side that is nearer to its limit, with the bounds of both."""
    worst = max(sides, key=lambda one: one.ratio)
    return replace(
        worst,
        least_ratio=max(one.least_ratio for one in sides),
        most_ratio=max(one.most_ratio for one in sides),
    )


def _jumps(motion: Motion) -> tuple[tuple[MotionJump, ...], list[tuple[str, str]]]:
    """Jumps of position, velocity and acceleration at inner breaks, the gravest first.

    Beside them joint and quantity of those that noise may hide. What is continuous by construction
    does not jump, whatever its coefficients were rounded to.
    """
    found: list[MotionJump] = []
    hidden: list[tuple[str, str]] = []
    if motion.pieces < 2 or motion.smooth >= 2:
        return (), hidden
    whole = np.abs(motion.scaled).sum(axis=1)
    terms = derivative_terms(motion.scaled, motion.durations)
    for r in range(motion.smooth + 1, 3):
        start, end = motion.at_ends(r)
        shown = (motion.durations**-r)[:, None]
        # A jump that the digits of the positions explain is none.
        digits = _ROUNDING * terms[:, r] + 64 * EPS * whole * shown
        size = start[1:] - end[:-1]
        noise = motion.error[1:, r] + motion.error[:-1, r]
        jumps = np.abs(size) > digits[1:] + digits[:-1] + noise
        if motion.assumed:
            # Beside a jump that is sure, one that is hidden says nothing more.
            may = (np.abs(size) + noise > digits[1:] + digits[:-1]).any(axis=0)
            may &= ~jumps.any(axis=0)
            hidden += [(motion.joints[j], ORDERS[r]) for j in np.nonzero(may)[0]]
        for j in np.nonzero(jumps.any(axis=0))[0]:
            worst = int(np.argmax(np.where(jumps[:, j], np.abs(size[:, j]), 0.0)))
            time, step = float(motion.breaks[worst + 1]), float(size[worst, j])
            count = int(jumps[:, j].sum())
            found.append(MotionJump(motion.joints[j], ORDERS[r], time, step, count))
    return tuple(found), hidden
