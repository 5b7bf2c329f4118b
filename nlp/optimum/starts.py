"""Starts for the solver: equal durations, random ones, and a search for basins on exact totals."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...problem import Array, Problem, evaluate
from .clock import time_up

CHAINS, CHAIN_STEPS = 384, 40
"""Short random descents (shared by the joints' cost) and their number of steps."""
GRID_POINTS = {2: 400, 3: 2500}
"""Points of the grid of duration ratios that is searched first where it is affordable."""
SETTLING_STEPS, OFFSPRING = 30, 16
"""Steps by which a start is brought near its basin's floor, and random trials of each."""
SETTLED_SEGMENTS = 24
"""Random trials gain little in more dimensions than these."""


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


@lru_cache(maxsize=16)
def stretching(problem: Problem) -> Problem:
    """The problem without the limits that no stretch repairs: sides of 0."""
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


def random_starts(problem: Problem, count: int, generator: np.random.Generator) -> Array:
    """Starts log-uniform in [0.1, 10] times the uniformly rescaled equal durations.

    Parameters
    ----------
    problem : Problem
    count : int
    generator : numpy.random.Generator

    Returns
    -------
    ndarray, shape (count, segments)
        Durations, s.
    """
    factors = 10.0 ** generator.uniform(-1.0, 1.0, (count, problem.segments))
    return np.asarray(equal_start(problem) * factors)


def screened_starts(problem: Problem, count: int, generator: np.random.Generator) -> Array:
    """The equal start, then the best mutually distant basins found on the exact repaired total.

    Local optima with a small basin are found here, by many cheap batched evaluations, and not by
    drawing more starts for the solver: on two or three durations by the local minima of a grid of
    their ratios, otherwise by short random descents.
    """
    base = equal_start(problem)
    if count <= 1 or problem.curve.free or problem.segments == 1:
        return np.vstack([base, random_starts(problem, max(count - 1, 0), generator)])
    if problem.segments in GRID_POINTS:
        pool = _grid_minima(problem, base)
    else:
        chains = max(48, CHAINS // problem.waypoints.shape[1])
        pool = random_starts(problem, chains, generator)
    ends, total = _descents(problem, pool, generator)
    chosen = [base]
    for i in np.argsort(total, kind="stable"):
        if len(chosen) == count:
            break
        apart = [np.abs(np.log(ends[i] / np.maximum(c, 1e-12))).max() for c in chosen[1:]]
        if np.isfinite(total[i]) and min(apart, default=np.inf) > 0.5:
            chosen.append(ends[i])
    return np.array(chosen)


def settled(problem: Problem, start: Array) -> Array:
    """A start, brought near its basin's floor by random steps on the exact repaired total.

    A few hundred batched evaluations cost less than one step of the solver from a start far from
    its optimum. The steps' widths follow their success; the same start settles in the same place.
    """
    if problem.curve.free or not 1 < problem.segments <= SETTLED_SEGMENTS:
        return start
    generator = np.random.default_rng(0)
    pool, totals = _repaired_total(problem, start[None])
    point, total, width = pool[0], totals[0], 0.5
    for _ in range(SETTLING_STEPS):
        if time_up():
            break
        steps = np.exp(width * generator.standard_normal((OFFSPRING, problem.segments)))
        pool, totals = _repaired_total(problem, point * steps)
        best = int(np.argmin(totals))
        if totals[best] < total:
            point, total, width = pool[best], totals[best], 1.2 * width
        else:
            width = 0.6 * width
    return np.asarray(point if np.isfinite(total) else start)


def _repaired_total(problem: Problem, h: Array) -> tuple[Array, Array]:
    """Duration vectors made tight and put within the bounds, and their exact repaired totals."""
    stretch = evaluate(problem, h).stretch
    usable = np.isfinite(stretch) & (stretch > 0)
    tight = np.where(usable[:, None], h * np.where(usable, stretch, 1.0)[:, None], h)
    inside = np.clip(tight, problem.duration_lower, problem.duration_upper)
    total = inside.sum(axis=1)
    moved = (inside != tight).any(axis=1)
    if moved.any():
        total[moved] *= np.maximum(1.0, evaluate(problem, inside[moved]).stretch)
    return inside, np.where(usable, total, np.inf)


def _grid_minima(problem: Problem, base: Array) -> Array:
    """Local minima of the repaired total over a grid of log duration ratios."""
    n = problem.segments
    side = round(GRID_POINTS[n] ** (1.0 / (n - 1)))
    axis = np.linspace(-4.5, 4.5, side)
    ratios = np.stack(np.meshgrid(*[axis] * (n - 1), indexing="ij"), axis=-1)
    logs = np.concatenate([np.zeros((*ratios.shape[:-1], 1)), ratios], axis=-1).reshape(-1, n)
    _, total = _repaired_total(problem, base.mean() * np.exp(logs))
    values = total.reshape(ratios.shape[:-1])
    lowest = np.ones(values.shape, dtype=bool)
    padded = np.pad(values, 1, constant_values=np.inf)
    for shift in np.ndindex(*(3,) * (n - 1)):
        window = tuple(slice(s, s + side) for s in shift)
        lowest &= values <= padded[window]
    keep = np.flatnonzero(lowest.ravel() & np.isfinite(total))
    keep = keep[np.argsort(total[keep], kind="stable")][:24]
    if keep.size == 0:
        return base[None]
    return np.repeat(base.mean() * np.exp(logs[keep]), 2, axis=0)


def _descents(problem: Problem, pool: Array, generator: np.random.Generator) -> tuple[Array, Array]:
    """Greedy random steps of shrinking width, every member of the pool by itself."""
    chains, total = _repaired_total(problem, pool)
    for width in np.geomspace(0.3, 0.02, CHAIN_STEPS):
        if time_up():
            break
        step = np.exp(width * generator.standard_normal(chains.shape))
        moved, moved_total = _repaired_total(problem, chains * step)
        better = moved_total < total
        chains[better], total[better] = moved[better], moved_total[better]
    return chains, total
