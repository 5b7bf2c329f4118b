"""Where the search of many segments begins, and how far a motion exceeds its limits."""

from __future__ import annotations

import numpy as np

from ...problem import Array, Problem, evaluate, fit
from ...problem.curves import Trajectory, near_extrema
from .starts import equal_start

PASSES = 4
"""Stretches of single segments; more change little."""
STEP, DAMPING = (0.8, 3.0), 0.7
"""Least and largest factor of a stretch, and its power: neighbours are stretched by it too."""
DWELL = 1.2
"""Share by which a segment is first given more than its way takes at the velocity limit."""
TURN = 8.0
"""Starts have h² = 8|Δq|/A: rest to rest takes 4 at least, a spline's overshoot some more; at 5 the
first round of quintics takes up to twice as many iterations."""
LEAST = 0.3
"""Of the mean duration, the least at the start: neighbours share their accelerations."""


def way_start(problem: Problem) -> Array:
    """Durations after the way of each segment, each stretched by what it and its neighbours exceed.

    Not by what the worst of all exceeds: among many segments one is always far worse than most.
    """
    way = np.abs(np.diff(problem.waypoints, axis=0))
    velocity, acceleration = problem.limits.velocity, problem.limits.acceleration
    with np.errstate(divide="ignore", invalid="ignore"):
        fast = np.where(way > 0, DWELL * way / velocity, 0.0).max(axis=1)
        turn = np.sqrt(np.where(way > 0, TURN * way / acceleration, 0.0)).max(axis=1)
    breaks = np.array(problem.curve.waypoint_breaks)
    parts = np.diff(breaks)
    h = np.repeat(np.maximum(fast, turn) / parts, parts)
    if not (np.isfinite(h).all() and h.mean() > 0):
        return equal_start(problem)
    h = np.maximum(h, LEAST * h.mean())
    for _ in range(PASSES):
        worst = worst_ratios(problem, fit(problem.curve, problem.waypoints, h))
        beside = np.maximum(np.append(worst[1:], 0.0), np.append(0.0, worst[:-1]))
        h = h * np.clip(np.maximum(worst, beside), *STEP) ** DAMPING
    if not np.isfinite(h).all():
        return equal_start(problem)
    return np.asarray(np.clip(h, problem.duration_lower, problem.duration_upper))


def worst_ratios(problem: Problem, trajectory: Trajectory) -> Array:
    """By how much each segment would have to be stretched, were it alone."""
    worst = np.zeros(len(trajectory.durations))
    for (j, i), limit in np.ndenumerate(problem.limits.derivatives):
        if np.isfinite(limit) and limit > 0:
            k, _, value = near_extrema(trajectory, j, i + 1, 0.0, 0.0)
            np.maximum.at(worst, k, (np.abs(value) / limit) ** (1.0 / (i + 1)))
    return worst


def excess_of(problem: Problem, h: Array) -> float:
    """Relative excess over the limits, as a stretch: what `evaluate` says, and sooner."""
    if (problem.limits.derivatives == 0.0).any():
        return float(evaluate(problem, h[None]).stretch[0]) - 1.0
    return float(worst_ratios(problem, fit(problem.curve, problem.waypoints, h)).max()) - 1.0
