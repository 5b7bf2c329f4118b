"""Jumps of a motion at its breaks: steps beyond what rounding errors explain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Array
from .curves import MANY_PIECES, Trajectory, may_jump, step_sizes
from .problem import Problem


@dataclass(frozen=True)
class Jump:
    """A derivative that differs on the two sides of a break.

    Attributes
    ----------
    joint : str
    order : int
        0 position, 1 velocity, 2 acceleration.
    break_index : int
        Break between two pieces of the trajectory, from 1.
    time : float
        s.
    size : float
        Value after the break less the value before it, rad/sᵒʳᵈᵉʳ.
    """

    joint: str
    order: int
    break_index: int
    time: float
    size: float


def of_many(trajectory: Trajectory) -> bool:
    """Whether there are so many pieces that their extrema are found by compiled code."""
    return trajectory.polynomial_in_time and len(trajectory.durations) >= MANY_PIECES


def jumps_of(problem: Problem, trajectory: Trajectory, error: Array) -> list[Jump]:
    """Steps of position, velocity and acceleration that rounding errors do not explain.

    Parameters
    ----------
    problem : Problem
    trajectory : Trajectory
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of each derivative on a piece.

    Returns
    -------
    list of Jump
    """
    jumps: list[Jump] = []
    if of_many(trajectory):
        return _jumps_of_many(problem, trajectory, error)
    if trajectory.polynomial_in_time and not may_jump(trajectory, error):
        return jumps
    for b in range(1, len(trajectory.durations)):
        for j, label in enumerate(problem.joints):
            for order in range(3):
                left, right, scale = trajectory.sides(b, j, order)
                size = right - left
                bound = float(error[b - 1, order, j] + error[b, order, j]) + 1e-9 * scale
                if abs(size) > bound:
                    jumps.append(Jump(label, order, b, float(trajectory.breaks[b]), size))
    return jumps


def _jumps_of_many(problem: Problem, trajectory: Trajectory, error: Array) -> list[Jump]:
    found = []
    for order in range(3):
        size, scale = step_sizes(trajectory, order)
        bound = error[:-1, order] + error[1:, order] + 1e-9 * scale
        found += [(b, j, order, size[b, j]) for b, j in np.argwhere(np.abs(size) > bound).tolist()]
    return [
        Jump(problem.joints[j], order, b + 1, float(trajectory.breaks[b + 1]), float(step))
        for b, j, order, step in sorted(found)
    ]
