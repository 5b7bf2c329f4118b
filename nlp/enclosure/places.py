"""Limits as rows at fixed places of a trajectory, and the linear program over such rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, Extremum, Problem, extrema, fit

_MOST_PLACES = 100
"""Rows of one linear program: the largest ratios come first, and few are active."""


@dataclass(frozen=True, eq=False)
class LimitRows:
    """Limits at fixed places: sign·f ≤ offset + t·width, where t is the ratio that they force."""

    points: list[Extremum]
    sign: Array
    offset: Array
    width: Array

    def ratios(self) -> Array:
        """What each row asks of t; −inf if a limit is 0."""
        value = np.array([e.value for e in self.points])
        some = self.width > 0.0
        ratio = (self.sign * value - self.offset) / np.where(some, self.width, 1.0)
        return np.where(some, ratio, -np.inf)

    def pick(self, index: NDArray[np.int64]) -> LimitRows:
        """Some of the rows."""
        points = [self.points[i] for i in index]
        return LimitRows(points, self.sign[index], self.offset[index], self.width[index])

    def __add__(self, other: LimitRows) -> LimitRows:
        return LimitRows(
            self.points + other.points,
            np.concatenate([self.sign, other.sign]),
            np.concatenate([self.offset, other.offset]),
            np.concatenate([self.width, other.width]),
        )


def rows_at(problem: Problem, durations: Array, most: int = _MOST_PLACES) -> LimitRows:
    """Rows at the local extrema of one trajectory, limits of 0 first, then the largest ratios."""
    trajectory = fit(problem.curve, problem.waypoints, durations)
    limits = problem.limits
    points: list[Extremum] = []
    numbers: list[tuple[float, float, float]] = []
    for j in range(trajectory.joints):
        for r, (below, above) in enumerate(limits.sides[:, j].T.tolist(), start=1):
            if not (np.isfinite(below) or np.isfinite(above)):
                continue
            for e in extrema(trajectory, j, r):
                sign, limit = (1.0, above) if e.value >= 0.0 else (-1.0, below)
                # A limit of 0 on one side alone is left out: rows of width 0 hold on both.
                if np.isfinite(limit) and (limit > 0.0 or below == above):
                    points.append(e)
                    numbers.append((sign, 0.0, limit))
        low, high = limits.position_lower[j], limits.position_upper[j]
        for limit, sign in ((low, -1.0), (high, 1.0)):
            if np.isfinite(limit):
                # The ratio of a position as `check` defines it.
                half = (high - low) / 2 if np.isfinite(high - low) else max(1.0, abs(limit))
                found = extrema(trajectory, j, 0)
                points += found
                numbers += [(sign, sign * limit - half, half)] * len(found)
    columns = np.array(numbers, dtype=np.float64).reshape(-1, 3)
    rows = LimitRows(points, columns[:, 0], columns[:, 1], columns[:, 2])
    order = np.lexsort((-rows.ratios(), rows.width > 0.0))
    return rows.pick(order[:most])


def linear_program(
    level: Array, slope: Array, low: Array, high: Array
) -> tuple[Array, Array] | None:
    """Minimise max (level + slope·x) for low ≤ x ≤ high.

    Returns
    -------
    x, weights : ndarray
        The minimiser and the dual weight of each row, which sum to 1; None if the solver fails.
    """
    matrix = np.hstack([slope, -np.ones((level.size, 1))])
    cost = np.append(np.zeros(low.size), 1.0)
    bounds = np.column_stack([np.append(low, -np.inf), np.append(high, np.inf)])
    from scipy.optimize import linprog  # a quarter of a second, and few need it

    result = linprog(cost, A_ub=matrix, b_ub=-level, bounds=bounds, method="highs")
    if result.status != 0:
        return None
    return np.clip(result.x[:-1], low, high), np.maximum(-result.ineqlin.marginals, 0.0)
