"""Reasons, each a proof by itself, why no durations within the bounds can keep the limits."""

from __future__ import annotations

import numpy as np

from ...problem import QUANTITIES, Problem


def impossible(problem: Problem) -> str | None:
    """The first elementary reason why a problem has no feasible durations, or None.

    None does not mean that the problem is feasible.
    """
    return (
        _limit_zero(problem)
        or _outside_range(problem)
        or _prescribed_beyond_limit(problem)
        or _too_little_time(problem)
    )


def _limit_zero(problem: Problem) -> str | None:
    moves = np.ptp(problem.waypoints, axis=0) > 0
    curve = problem.curve
    orders = {r for b in range(curve.segments + 1) for r, _ in curve.prescribed_at(b)}
    for r, quantity in enumerate(QUANTITIES, start=1):
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
        return f"way-point {w} of joint {problem.joints[j]} lies outside its position limits"
    return None


def _prescribed_beyond_limit(problem: Problem) -> str | None:
    for b in range(problem.segments + 1):
        for order, value in problem.curve.prescribed_at(b):
            if order > 3:
                continue
            over = abs(value) > problem.limits.derivatives[:, order - 1]
            if over.any():
                joint = problem.joints[int(np.argmax(over))]
                quantity = QUANTITIES[order - 1]
                return f"the {quantity} prescribed at break {b} exceeds the limit of joint {joint}"
    return None


def _too_little_time(problem: Problem) -> str | None:
    breaks = problem.curve.waypoint_breaks
    for w in range(len(breaks) - 1):
        room = float(problem.duration_upper[breaks[w] : breaks[w + 1]].sum())
        distance = np.abs(problem.waypoints[w + 1] - problem.waypoints[w])
        velocity = problem.limits.velocity
        with np.errstate(divide="ignore", invalid="ignore"):
            needed = np.where(distance > 0, distance / velocity, 0.0)
        j = int(np.argmax(needed))
        if needed[j] > room * (1 + 1e-12):
            return (
                f"joint {problem.joints[j]} needs at least {needed[j]:.6g} s between way-points "
                f"{w} and {w + 1} at its velocity limit; the duration bounds allow {room:.6g} s"
            )
    return None
