"""The verdict on a motion from elsewhere: every limit for all t, jumps, and the repair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..checker import Verdict
from ..curves import PERM, one_sided_extreme, piece_extremes
from ..errors import TrajgapError
from ..limits import half_range
from .floor import Floor, least_time
from .joint_limits import BRAKING, ORDERS, JointLimits
from .motion import Motion

MOTION_TOLERANCE = 1e-6
"""Relative excess over a limit that still counts as keeping it: files carry printed digits."""
_STANDING = 1e-9
"""Share of a joint's largest speed below which it stands: rounding of planners is below it."""
_JUMP = 1e-9
"""Relative to the terms of a derivative: what differs less at a break is rounding."""
_BLURRED = "Noise or the digits of the file are as large as what is left to a limit."
"""Why a motion that is known for all t is not decided."""
_EPS = 2.0**-52
"""Spacing of float64 at 1."""


@dataclass(frozen=True)
class MotionPeak:
    """The value of one quantity of one joint nearest to its limit, or furthest beyond.

    Attributes
    ----------
    joint, quantity : str
        The quantity is "position", "velocity", "acceleration", "deceleration" or "jerk".
    time : float
        s.
    value, limit : float
        rad, s; signed.
    ratio : float
        value/limit; of a position 1 + excess over half of the range. Above 1 it is exceeded.
    least_ratio, most_ratio : float
        Bounds of the ratio, all errors included.
    source : str
        Where the limit is stated.
    """

    joint: str
    quantity: str
    time: float
    value: float
    limit: float
    ratio: float
    least_ratio: float
    most_ratio: float
    source: str


@dataclass(frozen=True)
class MotionJump:
    """The largest jump of one derivative of one joint, and how many there are.

    Attributes
    ----------
    joint, quantity : str
    time : float
        s.
    size : float
        rad/sᵒʳᵈᵉʳ; value after less value before.
    count : int
        Breaks at which it jumps.
    """

    joint: str
    quantity: str
    time: float
    size: float
    count: int


@dataclass(frozen=True, eq=False)
class MotionCheck:
    """What is true of a motion, or of all motions through samples.

    Attributes
    ----------
    verdict : Verdict
    limits : Verdict
        About the limits alone, jumps apart.
    worst : MotionPeak or None
        Largest ratio; None if nothing is limited.
    peaks : tuple of MotionPeak
        One for each limited quantity of each joint.
    jumps : tuple of MotionJump
    total_time : float
        s.
    stretch : float
        Uniform slow-down that repairs: every duration times this keeps the limits; at least 1. For
        all motions through samples: no smaller one can.
    feasible_time : float or None
        ``total_time`` times ``stretch``; None with the reason beside.
    floor : Floor or None
        No motion between the same standstills is shorter.
    concluded, open : tuple of str
        What follows from the file, and what does not.
    tolerance : float
    """

    verdict: Verdict
    limits: Verdict
    worst: MotionPeak | None
    peaks: tuple[MotionPeak, ...]
    jumps: tuple[MotionJump, ...]
    total_time: float
    stretch: float
    feasible_time: float | None
    feasible_why: str | None
    floor: Floor | None
    floor_why: str | None
    concluded: tuple[str, ...]
    open: tuple[str, ...]
    tolerance: float

    def __str__(self) -> str:
        lines = [f"{self.verdict} (relative tolerance {self.tolerance:g})"]
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
    motion : Motion
    limits : JointLimits
        For the same joints in the same order.
    tolerance : float
        Relative excess over a limit that still counts as keeping it.

    Returns
    -------
    MotionCheck
    """
    check_same_joints(motion.joints, limits)
    peaks, standing = _peaks(motion, limits)
    about_limits = judged(peaks, tolerance)
    jumps = _jumps(motion)
    serious = [
        jump
        for jump in jumps
        if ORDERS.index(jump.quantity) < 2
        or np.isfinite([side[motion.joints.index(jump.joint), 3] for side in _sides(limits)]).any()
    ]
    verdict = about_limits
    if serious and verdict is not Verdict.VIOLATED:
        verdict = Verdict.DISCONTINUOUS
    stretch, why = slow_down(peaks, tolerance)
    if serious:
        why = "the motion jumps; going slower does not repair that"
    floor, floor_why = least_time(motion, limits, standing)
    return MotionCheck(
        verdict=verdict,
        limits=about_limits,
        worst=max(peaks, key=lambda p: p.ratio, default=None),
        peaks=peaks,
        jumps=jumps,
        total_time=motion.total_time,
        stretch=stretch,
        feasible_time=None if why else motion.total_time * stretch,
        feasible_why=why,
        floor=floor,
        floor_why=floor_why,
        concluded=(f"The verdict holds for every instant: {motion.between}.",),
        open=(_BLURRED,) if Verdict.UNDECIDED in (verdict, about_limits) else (),
        tolerance=tolerance,
    )


def check_same_joints(joints: Sequence[str], limits: JointLimits) -> None:
    """Refuse limits of other joints than those of the motion, or in another order.

    Raises
    ------
    TrajgapError
    """
    if tuple(joints) != tuple(limits.joints):
        raise TrajgapError(
            f"limits: given for joints {', '.join(limits.joints)}, the motion has "
            f"{', '.join(joints)}; give them in that order"
        )


def _sides(limits: JointLimits) -> tuple[Array, Array]:
    return limits.lower, limits.upper


def judged(peaks: Sequence[MotionPeak], tolerance: float) -> Verdict:
    """The verdict that bounds of ratios allow."""
    if any(p.least_ratio > 1 + tolerance for p in peaks):
        return Verdict.VIOLATED
    if all(p.most_ratio <= 1 + tolerance for p in peaks):
        return Verdict.PASS
    return Verdict.UNDECIDED


def slow_down(peaks: Sequence[MotionPeak], tolerance: float) -> tuple[float, str | None]:
    """Smallest uniform slow-down that brings every ratio to 1, or why there is none."""
    if any(p.quantity == "position" and p.least_ratio > 1 + tolerance for p in peaks):
        return 1.0, "a position limit is exceeded; going slower does not move the path"
    powers = {"velocity": 1, "acceleration": 2, BRAKING: 2, "jerk": 3}
    factors = [p.ratio ** (1 / powers[p.quantity]) for p in peaks if p.quantity in powers]
    stretch = max([1.0, *factors])
    if not np.isfinite(stretch):
        return stretch, "a joint that must stand still moves; going slower does not repair that"
    return stretch, None


def _peaks(motion: Motion, limits: JointLimits) -> tuple[tuple[MotionPeak, ...], Array]:
    """Peaks of all joints, and the speed below which each stands."""
    count = len(motion.joints)
    found, outer = np.zeros((count, 4, 2)), np.zeros((count, 4, 2))
    place = np.zeros((count, 4, 2, 2))
    data = (motion.scaled, motion.durations, motion.noise, motion.clock, PERM)
    piece_extremes(*data, found, place, outer)
    standing = _STANDING * np.abs(found[:, 1]).max(axis=1)
    peaks: list[MotionPeak] = []
    for j in range(count):
        for r in range(4):
            if r == 2 and np.isfinite(limits.deceleration[j]):
                peaks += _one_sided(motion, limits, j, standing[j])
                continue
            sides = []
            for side, limit in ((0, limits.lower[j, r]), (1, limits.upper[j, r])):
                if not np.isfinite(limit):
                    continue
                k, s = place[j, r, side]
                time = float(motion.breaks[int(k)] + s * motion.durations[int(k)])
                half = half_range(limits.lower[j, 0], limits.upper[j, 0], limit) if r == 0 else None
                error = abs(outer[j, r, side] - found[j, r, side])
                sides.append(
                    peak(limits, j, ORDERS[r], time, found[j, r, side], limit, error, side, half)
                )
            if sides:
                peaks.append(joined(sides))
    return tuple(peaks), standing


def _one_sided(motion: Motion, limits: JointLimits, j: int, standing: float) -> list[MotionPeak]:
    """Acceleration while the speed grows, deceleration while it falls."""
    data = (motion.scaled, motion.durations, motion.noise, motion.clock, PERM)
    peaks = []
    for sign, quantity, limit in (
        (1.0, "acceleration", limits.upper[j, 2]),
        (-1.0, BRAKING, limits.deceleration[j]),
    ):
        if not np.isfinite(limit):
            continue
        place = np.zeros(3)
        best, most = one_sided_extreme(*data, j, sign, standing, place)
        time = float(motion.breaks[int(place[0])] + place[1] * motion.durations[int(place[0])])
        one = peak(limits, j, quantity, time, best, limit, max(0.0, most - best), 1, None)
        sign_of = -1.0 if place[2] < 0 else 1.0
        peaks.append(replace(one, value=sign_of * one.value, limit=sign_of * one.limit))
    return peaks


def peak(
    limits: JointLimits,
    joint: int,
    quantity: str,
    time: float,
    value: float,
    limit: float,
    error: float,
    side: int,
    half: float | None,
) -> MotionPeak:
    """A value beside its limit; ``side`` is 0 for a lower limit, 1 for an upper one.

    ``half`` is given for positions alone.
    """

    def ratio(of: float) -> float:
        if half is not None:
            beyond = of - limit if side else limit - of
            return 1.0 + beyond / half if half > 0 else (1.0 if beyond <= 0 else np.inf)
        reach = max(0.0, of if side else -of)
        if limit == 0.0:
            return 0.0 if reach == 0.0 else np.inf
        return float(reach / abs(limit))

    name = limits.joints[joint]
    low, high = sorted((value - error, value + error), key=ratio)
    return MotionPeak(
        name,
        quantity,
        time,
        float(value),
        float(limit),
        ratio(value),
        ratio(low),
        ratio(high),
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


def _jumps(motion: Motion) -> tuple[MotionJump, ...]:
    """Jumps of position, velocity and acceleration at inner breaks, the gravest first."""
    if motion.pieces < 2:
        return ()
    found = []
    sizes = np.abs(motion.scaled)
    whole = sizes.sum(axis=1) + motion.noise
    for r in range(3):
        start, end = motion.at_ends(r)
        weights = PERM[: motion.scaled.shape[1], r]
        shown = (motion.durations**-r)[:, None]
        terms = np.einsum("p,kpj->kj", weights, sizes) * shown
        # A jump that the digits of the positions explain is none.
        slack = _JUMP * terms + (64 * _EPS * whole + weights.sum() * motion.noise) * shown
        size = start[1:] - end[:-1]
        jumps = np.abs(size) > slack[1:] + slack[:-1]
        for j in np.nonzero(jumps.any(axis=0))[0]:
            worst = int(np.argmax(np.where(jumps[:, j], np.abs(size[:, j]), 0.0)))
            found.append(
                MotionJump(
                    motion.joints[j],
                    ORDERS[r],
                    float(motion.breaks[worst + 1]),
                    float(size[worst, j]),
                    int(jumps[:, j].sum()),
                )
            )
    return tuple(found)
