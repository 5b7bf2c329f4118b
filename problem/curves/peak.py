"""Exact extrema of a trajectory's derivatives: every local one, with its place and size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from . import kernel
from .compilation import Deferred

if TYPE_CHECKING:
    from .trajectory import Trajectory


unit_roots = Deferred(kernel.roots_in_unit, 1.0)
"""The root finder; compiling it takes about a second."""


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
    count = unit_roots(np.ascontiguousarray(derivative), degree - 1, work, roots)
    return roots[:count].copy()


def polynomial_extrema(
    coefficients: list[float], joint: int, piece: int, order: int, begin: float, duration: float
) -> list[Extremum]:
    """`extrema` of one polynomial, without an array where a list of ten numbers will do.

    Parameters
    ----------
    coefficients : list of float
        Of the derivative in time, ascending in the piece's own 0..1.
    joint, piece, order : int
    begin, duration : float
        s.

    Returns
    -------
    list of Extremum
    """
    inner = critical_points(np.array(coefficients)).tolist() if len(coefficients) > 2 else []
    found = []
    for s in (0.0, *inner, 1.0):
        value = coefficients[-1]
        for c in coefficients[-2::-1]:
            value = c + value * s
        found.append(Extremum(joint, piece, order, s, begin + s * duration, value))
    return found


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
    own = trajectory.quick_extrema(joint, order)
    if own is not None:
        return own
    found: list[Extremum] = []
    for k in range(len(trajectory.durations)):
        places = np.concatenate([[0.0], trajectory.turning(k, joint, order), [1.0]])
        times, values = trajectory.times(k, places), trajectory.values(k, joint, order, places)
        found += [
            Extremum(joint, k, order, s, time, value)
            for s, time, value in zip(places.tolist(), times.tolist(), values.tolist(), strict=True)
        ]
    return found


def largest(
    trajectory: Trajectory, joint: int, order: int, errors: Array
) -> tuple[Extremum, float]:
    """The largest of `extrema` in size, the first of equal ones, and a bound on its error.

    Parameters
    ----------
    trajectory : Trajectory
    joint, order : int
    errors : ndarray, shape (pieces,)
        Bound on the error of each extremum, by its piece.

    Returns
    -------
    Extremum, float
        The true peak is at least its own extremum less that one's error, and at most the largest
        sum of an extremum and its error: a short segment, whose error is large but whose values are
        small, does not blur the peak of another.
    """
    piece, place, value, size, reach = 0, 0.0, 0.0, -1.0, -np.inf
    for k in range(len(trajectory.durations)):
        places = np.concatenate([[0.0], trajectory.turning(k, joint, order), [1.0]])
        values = trajectory.values(k, joint, order, places)
        i = int(np.abs(values).argmax())
        here = abs(float(values[i]))
        # What is not a number is the largest, and the first such stays.
        if size == size and not here <= size:
            piece, place, value, size = k, float(places[i]), float(values[i]), here
        reach = float(np.maximum(reach, here + errors[k]))
    time = float(trajectory.times(piece, np.array([place]))[0])
    bound = max(float(errors[piece]), reach - size)
    return Extremum(joint, piece, order, place, time, value), bound
