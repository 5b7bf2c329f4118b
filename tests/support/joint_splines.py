"""C2 cubic splines from a few numbers, and the shortest time of one joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from trajgap.problem import Limits, Problem, cubic_spline


def spline_problem(
    waypoints: ArrayLike,
    velocity: ArrayLike = np.inf,
    acceleration: ArrayLike = np.inf,
    ends: tuple[tuple[int, float], ...] = ((1, 0.0),),
    **bounds: ArrayLike,
) -> Problem:
    q = np.asarray(waypoints, dtype=float)
    q = q[:, None] if q.ndim == 1 else q
    limits = Limits(np.asarray(velocity), np.asarray(acceleration), joints=q.shape[1])
    return Problem(q, limits, cubic_spline(len(q) - 1, ends), **bounds)


def rest_to_rest_time(distance: float, velocity: float, acceleration: float) -> float:
    d = abs(distance)
    if d * acceleration < velocity**2:
        return float(2 * np.sqrt(d / acceleration))
    return d / velocity + velocity / acceleration
