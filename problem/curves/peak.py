"""Exact extrema of a trajectory's derivatives: every local one, with its place and size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from . import kernel

if TYPE_CHECKING:
    from .trajectory import Trajectory


@dataclass(frozen=True)
class Extremum:
    """One local extremum of a derivative of one joint.

    Attributes
    ----------
    joint, segment : int
        Indices from 0; the segment is a piece of the trajectory, and a segment between
        way-points except where a curve has its knots elsewhere.
    order : int
        Derivative: 0 position, 1 velocity, 2 acceleration, 3 jerk.
    s : float
        Place in its own parameter, 0..1.
    time : float
        Place in time, s.
    value : float
        Signed value, rad/sᵒʳᵈᵉʳ.
    """

    joint: int
    segment: int
    order: int
    s: float
    time: float
    value: float


def critical_points(a: Array) -> Array:
    """Places in (0, 1) where the polynomial with ascending coefficients ``a`` turns.

    The derivative's sign changes are found on monotone pieces (roots of the next derivative cut
    them), to the last bits of float64; nothing is sampled.
    """
    degree = a.size - 1
    if degree < 2:
        return np.empty(0)
    derivative = a[1:] * np.arange(1, degree + 1)
    roots = np.empty(kernel.MAX_COEFFICIENTS)
    work = np.empty((kernel.MAX_COEFFICIENTS, kernel.MAX_COEFFICIENTS))
    count = kernel.roots_in_unit(np.ascontiguousarray(derivative), degree - 1, work, roots)
    return roots[:count].copy()


def extrema(trajectory: Trajectory, joint: int, order: int) -> list[Extremum]:
    """Ends and interior turning points of one derivative of one joint, in order of time.

    Parameters
    ----------
    trajectory : Trajectory
    joint : int
        Index from 0.
    order : int
        0 position, 1 velocity, 2 acceleration, 3 jerk.

    Returns
    -------
    list of Extremum
        The largest absolute value over all t is among them.
    """
    found: list[Extremum] = []
    for k in range(len(trajectory.durations)):
        places = np.concatenate([[0.0], trajectory.turning(k, joint, order), [1.0]])
        times, values = trajectory.times(k, places), trajectory.values(k, joint, order, places)
        found += [
            Extremum(joint, k, order, s, time, value)
            for s, time, value in zip(places.tolist(), times.tolist(), values.tolist(), strict=True)
        ]
    return found
