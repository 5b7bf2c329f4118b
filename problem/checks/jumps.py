"""Jumps of a motion at its breaks: steps beyond what rounding errors explain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..curves import Trajectory
from ..problem import Problem


@dataclass(frozen=True)
class Jump:
    """A derivative that differs on the two sides of a break."""

    joint: str
    order: int
    """0 position, 1 velocity, 2 acceleration; 3 jerk where snap is limited."""
    break_index: int
    """Break between two pieces of the trajectory, from 1."""
    time: float
    """s."""
    size: float
    """Value after the break minus the value before it, rad/sᵒʳᵈᵉʳ."""


def jumps_of(problem: Problem, trajectory: Trajectory, error: Array) -> tuple[list[Jump], bool]:
    """Steps of derivatives, as in `Jump.order`, that rounding errors do not explain.

    Parameters
    ----------
    error : ndarray, shape (pieces, 5, joints)
        Bound on the error of each derivative on a piece.

    Returns
    -------
    list of Jump, bool
        The second says whether the bound is what keeps some step from being a jump.
    """
    found, hidden = [], False
    for order in range(problem.limits.sides.shape[2]):
        left, right, scale = trajectory.steps(order)
        size, room = right - left, 1e-9 * scale
        steps = np.argwhere(np.abs(size) > room)
        b, j = steps.T
        jumps = np.abs(size[b, j]) > error[b, order, j] + error[b + 1, order, j] + room[b, j]
        hidden = hidden or not jumps.all()
        found += [(b, j, order, size[b, j]) for b, j in steps[jumps].tolist()]
    return [
        Jump(problem.joints[j], order, b + 1, float(trajectory.breaks[b + 1]), float(step))
        for b, j, order, step in sorted(found)
    ], hidden
