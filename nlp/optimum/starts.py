"""Where searches begin: durations that are given, usual ones, and the box around them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ...problem import TOLERANCE, Array, Problem, TrajgapError, evaluate, fit
from ...problem.checks import worst_ratios

DENSE = 24
"""Segments up to which a wide search and dense descents come first: their gradients have
(segments)² entries, and beyond this random trials gain little."""
FARTHEST = 1e12
"""Factor to both sides of the usual duration that no search leaves: float64 has not lost the curve
there."""


@dataclass(frozen=True)
class WayStart:
    """How the way of each segment gives the durations at which rounds of the NLP begin."""

    dwell: float = 1.2
    """Times the time that the way takes at the velocity limit."""
    turn: float = 8.0
    """h² = 8|Δq|/A: rest to rest takes 4 at least, a spline's overshoot some more; at 5 the first
    round of quintics takes up to twice as many iterations."""
    least: float = 0.3
    """Of the mean duration, the least: neighbours share their accelerations."""
    passes: int = 4
    """Stretches of single segments; more change little."""
    factors: tuple[float, float] = (0.8, 3.0)
    """Least and largest factor of a stretch."""
    power: float = 0.7
    """Of a stretch: neighbours are stretched by it too."""


WAY = WayStart()
"""What `way_start` is made with."""


@dataclass(frozen=True, eq=False)
class LogBox:
    """Bounds on the logarithms of the durations."""

    low: Array
    high: Array

    def inside(self, z: Array) -> Array:
        """The nearest point of the box."""
        return np.asarray(np.clip(z, self.low, self.high))


def first_nodal(problem: Problem) -> Array | None:
    """Free derivatives to start from: at rest, virtual breaks on the chord of their neighbours."""
    if not problem.curve.free:
        return None
    interpolant = problem.piecewise
    nodal = np.zeros((interpolant.free, problem.waypoints.shape[1]))
    breaks = interpolant.waypoint_breaks
    for i, (b, order) in enumerate(interpolant.free_derivatives):
        if order == 0:
            nodal[i] = [np.interp(b, breaks, q) for q in problem.waypoints.T]
    return nodal


def slowed(problem: Problem, nodal: Array, factor: float) -> Array:
    """Free derivatives of a motion that is stretched in time by a factor."""
    orders = np.array([r for _, r in problem.piecewise.free_derivatives])[:, None]
    return nodal / factor**orders


@lru_cache(maxsize=16)
def stretching(problem: Problem) -> Problem:
    """The problem without the limits that no stretch repairs, sides of 0, and in narrow ones.

    Where deceleration has a limit of its own, the smaller size on both sides is quicker to judge.
    """
    if problem.limits.braking.any():
        problem = replace(problem, limits=problem.limits.narrow)
    sides = problem.limits.sides
    if (sides > 0).all():
        return problem
    return replace(problem, limits=problem.limits.with_sides(np.where(sides > 0, sides, np.inf)))


def equal_start(problem: Problem) -> Array:
    """Equal durations, rescaled uniformly to be tight and put within the bounds, s."""
    h = np.ones((1, problem.segments))
    stretch = float(evaluate(stretching(problem), h, first_nodal(problem)).stretch[0])
    if not (np.isfinite(stretch) and stretch > 0):
        stretch = 1.0
    return np.asarray(np.clip(h[0] * stretch, problem.duration_lower, problem.duration_upper))


def way_start(problem: Problem) -> Array:
    """Durations after the way of each segment, each stretched by what it and its neighbours exceed.

    Not by what the worst of all exceeds: among many segments one is always far worse than most.
    """
    way = np.abs(np.diff(problem.waypoints, axis=0))
    velocity, acceleration = problem.limits.sides.min(axis=0).T[:2]  # the smaller sides
    with np.errstate(divide="ignore", invalid="ignore"):
        fast = np.where(way > 0, WAY.dwell * way / velocity, 0.0).max(axis=1)
        turn = np.sqrt(np.where(way > 0, WAY.turn * way / acceleration, 0.0)).max(axis=1)
    parts = np.diff(problem.curve.waypoint_breaks)
    h = np.repeat(np.maximum(fast, turn) / parts, parts)
    if not (np.isfinite(h).all() and h.mean() > 0):
        return equal_start(problem)
    h = np.maximum(h, WAY.least * h.mean())
    for _ in range(WAY.passes):
        worst = worst_ratios(problem, fit(problem.curve, problem.waypoints, h))
        beside = np.maximum(np.append(worst[1:], 0.0), np.append(0.0, worst[:-1]))
        h = h * np.clip(np.maximum(worst, beside), *WAY.factors) ** WAY.power
    if not np.isfinite(h).all():
        return equal_start(problem)
    return np.asarray(np.clip(h, problem.duration_lower, problem.duration_upper))


def random_starts(problem: Problem, count: int, generator: np.random.Generator) -> Array:
    """Starts log-uniform in [0.1, 10] times the uniformly rescaled equal durations, s.

    Their shape is (count, segments).
    """
    factors = 10.0 ** generator.uniform(-1.0, 1.0, (count, problem.segments))
    return np.asarray(equal_start(problem) * factors)


def least_durations(problem: Problem) -> Array:
    """Durations, s, that no motion within the velocity limits undercuts; 0 where nothing says so.

    Between two way-points a joint covers |Δq|, which takes |Δq|/V at least.
    """
    least = np.array(problem.duration_lower)
    breaks = problem.curve.waypoint_breaks
    way = np.diff(problem.waypoints, axis=0)
    distance, sides = np.abs(way), problem.limits.sides[:, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        velocity = np.where(way > 0, sides[1], sides[0])
        needed = np.where(distance > 0, distance / velocity, 0.0).max(axis=1)
    for w, seconds in enumerate(needed):
        if breaks[w + 1] == breaks[w] + 1 and np.isfinite(seconds):
            least[breaks[w]] = max(least[breaks[w]], (1.0 - TOLERANCE) * seconds)
    return least


def made_up(problem: Problem, share: float) -> Array:
    """A least duration of each segment, s, that a search makes up; 0 where a higher one is given.

    A share of the mean of the usual durations, or of an upper bound where that is shorter: a floor
    above an upper bound would leave nothing to search. Where a bound or a velocity limit is higher,
    it is 0.
    """
    usual = np.minimum(equal_start(problem).mean(), problem.duration_upper)
    return np.where(least_durations(problem) < share * usual, share * usual, 0.0)


def box_above(problem: Problem, floor: Array) -> LogBox:
    """Bounds on log durations: the problem's own, the least durations, and the floors."""
    usual = float(equal_start(problem).mean())
    least = np.minimum(usual, problem.duration_upper) / FARTHEST
    low = np.maximum(np.maximum(least_durations(problem), floor), least)
    # A least duration above an upper bound leaves no motion; the box stays one for the search.
    high = np.maximum(np.minimum(problem.duration_upper, FARTHEST * usual), low)
    return LogBox(np.log(low), np.log(high))


def vectors(problem: Problem, name: str, given: ArrayLike) -> Array:
    """Durations that are given to `solve`, shape (vectors, segments), or a clear refusal."""
    points = np.atleast_2d(np.asarray(given, dtype=np.float64))
    if points.size == 0:
        return np.empty((0, problem.segments))
    if points.shape[1:] != (problem.segments,) or not (np.isfinite(points) & (points > 0)).all():
        raise TrajgapError(
            f"{name}: expected shape (starts, {problem.segments}) of positive durations, "
            f"got {np.asarray(given).shape}"
        )
    return points
