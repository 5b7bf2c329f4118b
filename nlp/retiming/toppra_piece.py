"""TOPP-RA (Pham & Pham, IEEE T-RO 34(3), 2018; package toppra) on one sampled piece of a path."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from toppra.algorithm import TOPPRA
from toppra.constraint import (
    DiscretizationType,
    JointAccelerationConstraint,
    JointVelocityConstraint,
)

from ...problem import Array
from .grid import SampledPath

_UNITS = ((1e4, 10.0), (1e4, 1.0), (1e2, 10.0), (1e4, 3.0), (1e4, 30.0), (1e2, 1.0))
"""Scalings tried: length of the path, and expected path speed.

The linear programs have absolute tolerances around 1e-9 and bounds of 1e8 on all variables, and
now and then fail in one scaling; where several succeed, they agree to 1e-6."""


class _Path:
    """What toppra asks of a path, answered from the samples on its own grid."""

    def __init__(self, grid: Array, tangent: Array) -> None:
        self.grid, self.tangent = grid, tangent
        self.dof = tangent.shape[1]
        self.path_interval = grid[[0, -1]]
        self.duration = float(grid[-1] - grid[0])

    def __call__(self, grid: Array, order: int = 0) -> Array:
        if order != 1 or grid.shape != self.grid.shape:
            raise NotImplementedError("sampled: only the tangent, only on the grid")
        return self.tangent


class _Acceleration(JointAccelerationConstraint):  # type: ignore[misc]
    """Acceleration limits with a curvature that may jump at grid points.

    As toppra's interpolation scheme, q′u + q″x is limited at both ends of every cell, here with
    q″ from inside the cell at either end.
    """

    def __init__(
        self,
        limit: Array,
        tangent: Array,
        before: Array,
        after: Array,
    ) -> None:
        super().__init__(limit, DiscretizationType.Interpolation)
        self.tangent, self.before, self.after = tangent, before, after

    def compute_constraint_params(
        self, path: _Path, gridpoints: Array, *_: object
    ) -> tuple[Array | None, ...]:
        step = np.diff(gridpoints)[:, None]
        d = self.tangent.shape[1]
        u = np.hstack([self.tangent, self.tangent])
        u[:-1, d:] = self.tangent[1:] + 2 * step * self.before[1:]
        x = np.hstack([self.after, self.before])
        x[:-1, d:] = self.before[1:]
        both = np.vstack([np.eye(2 * d), -np.eye(2 * d)])
        room = np.concatenate([self.alim[:, 1]] * 2 + [-self.alim[:, 0]] * 2)
        return u, x, np.zeros_like(u), both, room, None, None


class _Solver(TOPPRA):  # type: ignore[misc]
    """TOPP-RA that ends at most at the end speed, instead of exactly at it.

    It maximises speed at every step, so it ends at that speed if the grid can reach it. A grid
    that is stricter than the continuous limits cannot where the trajectory runs on its limits.
    """

    def compute_controllable_sets(self, sdmin: float, sdmax: float) -> Array:
        return np.asarray(super().compute_controllable_sets(0.0, sdmax))


@contextmanager
def _quiet() -> Iterator[None]:
    """No log lines from toppra: its failures come back as None and are reported by us."""
    logger = logging.getLogger("toppra")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(level)


def optimal_speeds(
    path: SampledPath,
    velocity: Array,
    acceleration: Array,
    end_speeds: tuple[float, float],
    expected: float,
) -> tuple[float, Array] | None:
    """Least time for one piece under velocity and acceleration limits.

    Parameters
    ----------
    path : SampledPath
    velocity, acceleration : ndarray, shape (joints,)
        Limits, rad/s and rad/s²; positive or inf for the joints that move.
    end_speeds : tuple of float
        Path speeds at the two ends, rad/s.
    expected : float
        Order of magnitude of the answer, s; only scales the numbers.

    Returns
    -------
    tuple of float and ndarray, shape (points,), or None
        Duration, s, and path speeds at the points of the grid, rad/s; None if no parametrisation
        was found, or no joint that moves on this piece has an acceleration limit.
    """
    if not np.isfinite(acceleration[path.moving]).any():
        return None
    # No limit stands for a thousand path lengths per expected duration.
    unlimited = 1e3 * float(path.s[-1]) / expected
    velocity = np.where(np.isfinite(velocity), velocity, unlimited)
    for length, speed in _UNITS:
        time_unit = expected * speed / length
        found = _attempt(path, velocity, acceleration, end_speeds, length, time_unit)
        if found is not None:
            return found
    return None


def _attempt(
    path: SampledPath,
    velocity: Array,
    acceleration: Array,
    end_speeds: tuple[float, float],
    length: float,
    time_unit: float,
) -> tuple[float, Array] | None:
    scale = length / float(path.s[-1])
    grid = path.s * scale
    moving, some = path.moving, path.moving & np.isfinite(acceleration)
    limits = [
        JointVelocityConstraint(velocity[moving] * time_unit * scale),
        _Acceleration(
            acceleration[some] * time_unit**2 * scale,
            path.tangent[:, some],
            path.before[:, some] / scale,
            path.after[:, some] / scale,
        ),
    ]
    start, end = (speed * time_unit * scale for speed in end_speeds)
    slower = 1.0 - 10.0 / path.s.size  # an error of the grid: ten cells
    with _quiet(), np.errstate(all="ignore"):
        solver = _Solver(
            limits,
            _Path(grid, path.tangent[:, moving]),
            gridpoints=grid,
            solver_wrapper="seidel",
            parametrizer="ParametrizeConstAccel",
        )
        if start > 0.0:
            reached = float(np.sqrt(solver.compute_controllable_sets(0.0, end)[0, 1]))
            if reached < slower * start:
                return None
            start = min(start, reached)
        speeds = solver.compute_parameterization(start, end)[1]
        if speeds is None or np.isnan(speeds).any():
            return None
        # At constant acceleration a cell takes its length by the mean speed; added one by one.
        duration = float(np.cumsum(2 * np.diff(grid) / (speeds[:-1] + speeds[1:]))[-1])
        if not np.isfinite(duration) or speeds[-1] < slower * end:
            return None
    return duration * time_unit, speeds / (time_unit * scale)
