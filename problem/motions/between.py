"""What samples prove without an interpolation: divided differences against the limits.

By the mean value theorem r! times the divided difference of r + 1 samples is a value that the r-th
derivative takes between them, or lies between values that it takes where it jumps. So if it leaves
the limit by more than the noise and the rounding allow, every motion through the samples breaks
that limit; no such motion is accused otherwise. Wider windows see less noise, of times as of
positions: strides 1, 2, 4, ...
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..checks import Verdict
from ..limits import half_range
from .divided import divided_extremes
from .joint_limits import BRAKING, ORDERS, JointLimits
from .judged import (
    MOTION_TOLERANCE,
    MotionCheck,
    MotionPeak,
    blurred,
    check_same_joints,
    joined,
    peak,
    slow_down,
)
from .samples import Samples


def check_samples(
    samples: Samples, limits: JointLimits, tolerance: float = MOTION_TOLERANCE
) -> MotionCheck:
    """Judge all motions through samples, without an assumption about what happens between them.

    Parameters
    ----------
    limits : JointLimits
        For the same joints in the same order.
    tolerance : float
        Relative excess over a limit that still counts as keeping it.

    Returns
    -------
    MotionCheck
        Its verdict is *violated* if every such motion breaks a limit, otherwise *undecided*:
        samples cannot show that a motion keeps its limits between them.
    """
    check_same_joints(samples.joints, limits)
    peaks: list[MotionPeak] = []
    ranges = [_ranges(samples, limits, r) for r in range(4)]
    shown = [_proven(samples, r, one) for r, one in enumerate(ranges)]
    for j in range(len(samples.joints)):
        for r in range(4):
            sides = _peaks(limits, j, r, ranges[r][j], shown[r][j])
            if sides:
                peaks.append(joined(sides))
    broken = any(p.least_ratio > 1 + tolerance for p in peaks)
    verdict = Verdict.VIOLATED if broken else Verdict.UNDECIDED
    # No motion through the samples is known to be above what they prove.
    proven = [replace(p, ratio=p.least_ratio, most_ratio=p.least_ratio) for p in peaks]
    stretch, why = slow_down(proven, tolerance)
    total = float(samples.time[-1] - samples.time[0])
    states = "positions" + "".join(
        f", {word}" for word, r in (("velocities", 1), ("accelerations", 2)) if samples.has(r).any()
    )
    noise = [
        sentence
        for sentence in (*blurred(peaks, tolerance), samples.advice)
        if sentence and not broken and any(p.ratio > 1 + tolerance for p in peaks)
    ]
    if broken:
        concluded = "Every motion through these samples breaks a limit."
    else:
        concluded = f"The samples ({states}) prove no limit broken."
    return MotionCheck(
        verdict=verdict,
        limits=verdict,
        worst=max(peaks, key=lambda p: p.least_ratio, default=None),
        peaks=tuple(peaks),
        jumps=(),
        total_time=total,
        stretch=stretch,
        feasible_time=None,
        feasible_why=why
        or "the motion between the samples is unknown"
        + (f"; slower by {stretch:.6g} is not enough" if stretch > 1 else ""),
        floor=None,
        floor_why="samples alone do not show where the motion stands still",
        concluded=(
            concluded,
            samples.assumed or "The numbers count as exact; state --noise for measured ones.",
        ),
        open=(
            *noise,
            "Nothing can be checked between the samples; state an --interpolation for a verdict "
            "at all t.",
        ),
        tolerance=tolerance,
        not_judged=limits.unstated,
        joints=samples.joints,
    )


Proof = list[tuple[float, float, float]]
"""Value, error and time that prove most of a derivative, towards the lower and upper side."""


def _ranges(samples: Samples, limits: JointLimits, r: int) -> list[tuple[float, float]]:
    """The range that each joint's derivative is held to."""
    found = []
    for j in range(len(samples.joints)):
        lower, upper = float(limits.lower[j, r]), float(limits.upper[j, r])
        if r == 2 and np.isfinite(limits.deceleration[j]):
            # No motion may pass both, speeding up or braking.
            lower = min(lower, -float(limits.deceleration[j]))
            upper = max(upper, float(limits.deceleration[j]))
        found.append((lower, upper))
    return found


def _proven(samples: Samples, r: int, ranges: list[tuple[float, float]]) -> list[Proof]:
    """What proves most of a derivative, joint by joint; nothing if it has no limit.

    A wider window lowers the error alone: where that is far below a joint's limit nothing is to be
    gained.
    """
    best: list[Proof] = [[] for _ in ranges]
    sizes = [[abs(x) for x in one if np.isfinite(x)] for one in ranges]
    enough = np.array([1e-7 * min(one) if one else np.inf for one in sizes])
    limited = np.array([j for j, one in enumerate(sizes) if one], dtype=np.intp)
    for order in range(min(r, 2) + 1):
        values, rows = samples.given(order), samples.has(order)
        differences = r - order
        if values is None or rows.sum() <= differences:
            continue
        noise = samples.doubt(order)
        times = samples.time
        if not rows.all():
            times, values = times[rows], values[rows]
        open_joints = limited
        # At 4,096 samples noise is as small as any limit can ask for.
        for stride in (1 << n for n in range(12)):
            if differences * stride >= times.size or not open_joints.size:
                break
            some = values if open_joints.size == len(ranges) else values[:, open_joints]
            found, error = divided_extremes(
                times, some, differences, stride, noise[open_joints], samples.clock
            )
            for j, one in zip(open_joints, found, strict=True):
                best[j] = _better(best[j], [(float(a), float(b), float(c)) for a, b, c in one])
            if differences == 0:
                break
            open_joints = open_joints[~(error <= enough[open_joints])]
    return best


def _better(best: Proof, here: Proof) -> Proof:
    """On each side the one that proves more."""
    if not best:
        return here
    low, high = best
    return [
        here[0] if here[0][0] + here[0][1] < low[0] + low[1] else low,
        here[1] if here[1][0] - here[1][1] > high[0] - high[1] else high,
    ]


def _peaks(
    limits: JointLimits, j: int, r: int, held: tuple[float, float], proven: Proof
) -> list[MotionPeak]:
    """What is proved of one quantity of one joint, beside each limit it has."""
    lower, upper = held
    quantity, source = ORDERS[r], limits.source(limits.joints[j], ORDERS[r])
    # Which of the two files or flags the wider side of an acceleration comes from.
    if (
        r == 2
        and np.isfinite(limits.deceleration[j])
        and limits.deceleration[j] >= limits.upper[j, r]
    ):
        source = limits.source(limits.joints[j], BRAKING)
    half = half_range(lower, upper, lower if np.isfinite(lower) else upper) if r == 0 else None
    peaks = []
    for side, (limit, (value, error, time)) in enumerate(zip(held, proven, strict=False)):
        if np.isfinite(limit):
            # Towards a lower limit what is surely reached lies above the value, by its error.
            away = error if side else -error
            values = (value, value - away, value + away)
            one = peak(limits, j, quantity, time, values, limit, side, half)
            peaks.append(replace(one, source=source))
    return peaks
