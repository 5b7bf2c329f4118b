"""Reasons, each a proof by itself, why no durations within the bounds can keep the limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from ...problem import Array, Problem, Verdict, as_piecewise, check, shown_bound

SURE = 1.0 + 1e-6
"""What a need must exceed to be a proof: far above the checker's tolerance and rounding."""
AMPLE = 1e6
"""Duration of a segment without an upper bound, in shares of the others: nothing is reached."""
ENDLESS = 1e29
"""s; longer than this is beyond what `check` takes."""


def impossible(problem: Problem) -> str | None:
    """The first elementary reason why a problem has no feasible durations, or None.

    None does not mean that the problem is feasible. Where the sides of limits differ, some proofs
    look at the larger one alone: what is impossible within it is impossible.
    """
    wide = problem.hull
    return (
        _limit_zero(wide)
        or _outside_range(wide)
        or _prescribed_beyond_limit(problem)
        or _too_little_time(wide)
        or _too_sharp_a_turn(wide)
        or _each_segment_by_itself(problem)
    )


def _limit_zero(problem: Problem) -> str | None:
    moves = np.ptp(problem.waypoints, axis=0) > 0
    curve = problem.curve
    orders = {r for b in range(curve.segments + 1) for r, _ in curve.prescribed_at(b)}
    for r, quantity in enumerate(problem.limits.quantities, start=1):
        # A joint that must not accelerate may still glide, unless it is at rest somewhere.
        pinned = all(lower in orders for lower in range(1, r))
        for j in np.flatnonzero(moves & (problem.limits.derivatives[:, r - 1] == 0)):
            if pinned and curve.homogeneous:
                return f"joint {problem.joints[j]} moves, but its {quantity} limit is 0"
    return None


def _outside_range(problem: Problem) -> str | None:
    low, high = problem.limits.position_lower, problem.limits.position_upper
    outside = np.argwhere((problem.waypoints < low) | (problem.waypoints > high))
    if outside.size:
        w, j = outside[0]
        return f"way-point {w + 1} of joint {problem.joints[j]} lies outside its position limits"
    return None


def _prescribed_beyond_limit(problem: Problem) -> str | None:
    for b in range(problem.segments + 1):
        for order, value in problem.curve.prescribed_at(b):
            if order > len(problem.limits.quantities):
                continue
            each = np.broadcast_to(np.asarray(value, dtype=np.float64), len(problem.joints))
            below, above = problem.limits.sides[:, :, order - 1]
            over = np.abs(each) > np.where(each > 0.0, above, below)
            if over.any():
                joint = problem.joints[int(np.argmax(over))]
                quantity = problem.limits.quantities[order - 1]
                return f"the {quantity} prescribed at break {b} exceeds the limit of joint {joint}"
    return None


def _smooth(problem: Problem, order: int) -> bool:
    """Whether derivatives up to ``order`` agree at every break of a motion that passes.

    `check` demands it of declared curves; other kinds may jump, unless they say that they do not.
    """
    curve = problem.curve
    inner = range(1, curve.segments)
    return as_piecewise(curve) is not None or all(curve.smooth_order(b) >= order for b in inner)


def _room(problem: Problem) -> tuple[Array, Array]:
    """Least and largest time, s, between successive way-points."""
    breaks = np.array(problem.curve.waypoint_breaks)
    low, high = (
        np.add.reduceat(bound, breaks[:-1])
        for bound in (problem.duration_lower, problem.duration_upper)
    )
    return low, high


def _spans(problem: Problem) -> Iterator[tuple[int, Array, Array, Callable[[int], str]]]:
    """Orders of limits, ways that they bound, the time that there is for each, and its words."""
    q, (_, high) = problem.waypoints, _room(problem)
    yield 1, np.diff(q, axis=0), high, lambda w: f"between way-points {w + 1} and {w + 2}"
    for last, end in enumerate(problem.curve.ends):
        still = {order for order, value in end if value == 0.0}
        for order in range(2, 1 + len(problem.limits.quantities)):
            if not (still >= set(range(1, order)) and _smooth(problem, order - 1)):
                continue
            if last:
                room = np.cumsum(high[::-1])
                yield (
                    order,
                    q[-2::-1] - q[-1],
                    room,
                    lambda w: f"from way-point {len(q) - 1 - w} to rest",
                )
            else:
                yield (
                    order,
                    q[1:] - q[0],
                    np.cumsum(high),
                    lambda w: f"from rest to way-point {w + 2}",
                )


def _too_little_time(problem: Problem) -> str | None:
    """|Δq| ≤ Vt; |Δq| ≤ Lt^r/r! from a start at rest up to order r − 1, L the limit of order r.

    Ends alike.
    """
    for order, way, room, words in _spans(problem):
        distance = np.abs(way)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = math.factorial(order) * distance / problem.limits.derivatives[:, order - 1]
        needed = np.where(distance > 0, share, 0.0) ** (1.0 / order)
        late = needed / room[:, None]
        if late.max(initial=0.0) > SURE:
            w, j = (int(x) for x in np.unravel_index(late.argmax(), late.shape))
            return (
                f"joint {problem.joints[j]} needs at least {shown_bound(needed[w, j], 'lower')} s "
                f"{words(w)} at its {problem.limits.quantities[order - 1]} limit; "
                f"the duration bounds allow {room[w]:.6g} s"
            )
    return None


def _too_sharp_a_turn(problem: Problem) -> str | None:
    """Three way-points whose mean velocities differ by more than the acceleration allows.

    The second divided difference of q is a mean of q̈/2 (Peano), so over two neighbouring spans
    2|Δq₂/T₂ − Δq₁/T₁|/(T₁ + T₂) ≤ A, whatever happens at the way-points.
    """
    if not _smooth(problem, 1):
        return None
    low, high = _room(problem)
    step = np.diff(problem.waypoints, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([step / low[:, None], step / high[:, None]])
    ends = np.where(np.isnan(ends), 0.0, ends)  # 0/0: a still span with a lower bound of 0
    slow, fast = ends.min(axis=0), ends.max(axis=0)
    apart = np.maximum(slow[1:] - fast[:-1], slow[:-1] - fast[1:])
    needed = 2.0 * np.maximum(apart, 0.0) / (high[1:] + high[:-1])[:, None]
    sharp = np.argwhere(needed > problem.limits.acceleration * SURE)
    if sharp.size == 0:
        return None
    w, j = (int(x) for x in sharp[0])
    return (
        f"joint {problem.joints[j]} needs an acceleration of {needed[w, j]:.6g} "
        f"{'m' if problem.linear[j] else 'rad'}/s² near "
        f"way-point {w + 2} within the duration bounds; its limit is "
        f"{problem.limits.acceleration[j]:.6g}"
    )


def apart(problem: Problem) -> bool:
    """Whether each segment's curve depends on its own duration only, by a stretch."""
    curve = as_piecewise(problem.curve)
    if curve is None:
        return problem.curve.shape(problem.waypoints) is not None
    given = [{order for order, _ in curve.prescribed_at(b)} for b in range(1, curve.segments)]
    alone = all(
        set(range(1, order + 1)) <= orders
        for order, orders in zip(curve.continuity, given, strict=True)
    )
    return alone and curve.homogeneous and not curve.free and not curve.virtual


def forbidden_jumps(problem: Problem) -> list[tuple[int, int, int]]:
    """Jumps that the declaration allows and the limits forbid: (break, order, joint) of each.

    Those of joints that move, up to the order of `Limits.smooth_orders`.
    """
    curve, moving = as_piecewise(problem.curve), np.ptp(problem.waypoints, axis=0) > 0
    highest = problem.limits.smooth_orders
    return [
        (b, order, int(j))
        for b in range(1, 0 if curve is None else curve.segments)
        for order in range(1, int(highest.max()) + 1)
        if curve is not None and order > curve.smooth_order(b)
        if order not in dict(curve.prescribed_at(b))
        for j in np.flatnonzero(moving & (highest >= order))
    ]


def _each_segment_by_itself(problem: Problem) -> str | None:
    """A limit that is exceeded at the longest durations, where stretching only lowers ratios.

    The path itself, and with it every position, does not depend on the durations.
    """
    if not apart(problem):
        return None
    longest = np.array(problem.duration_upper)
    open_ = np.isinf(longest)
    usual = float(longest[~open_].max(initial=0.0)) or 1.0
    longest[open_] = np.maximum(AMPLE * usual, problem.duration_lower[open_])
    if longest.max() > ENDLESS:
        return None
    verdict = check(problem, longest)
    worst = verdict.worst
    if verdict.limits is not Verdict.VIOLATED or worst is None or not worst.ratio > SURE:
        return None
    if worst.quantity != "position" and open_[worst.segment]:
        return None
    return (
        f"joint {worst.joint} exceeds its {worst.quantity} limit in segment {worst.segment + 1} "
        f"even at the longest durations, {worst.value:.6g} against {worst.limit:.6g}"
    )
