"""Exact extrema of trajectories of many pieces, the same as `peak.extrema`, without objects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .kernel import MAX_COEFFICIENTS, compiled, roots_in_unit
from .peak import Extremum
from .trajectory import Trajectory

MANY_PIECES = 100
"""Pieces from which the compiled search is used: below, compiling it takes longer than it saves."""


@compiled
def _piece_extrema(  # type: ignore[no-untyped-def]
    scaled, degree, power, k, joint, order, a, turn, work, places, values
):
    """Ends and turning points of one derivative on one piece; returns their number."""
    size = degree + 1
    for i in range(size):
        a[i] = scaled[k, i, joint]
    for _ in range(order):
        for i in range(size - 1):
            a[i] = a[i + 1] * (i + 1)
        size -= 1
        if size < 1:
            size, a[0] = 1, 0.0
    for i in range(size):
        a[i] /= power
    found = 0
    if size > 2:
        for i in range(size - 1):
            turn[i] = a[i + 1] * (i + 1)
        found = roots_in_unit(turn, size - 2, work, places[1:])
    places[0], places[found + 1] = 0.0, 1.0
    for m in range(found + 2):
        value = a[size - 1]
        for i in range(size - 2, -1, -1):
            value = value * places[m] + a[i]
        values[m] = value
    return found + 2


@compiled
def _tops(scaled, degrees, powers, error, joint, order):  # type: ignore[no-untyped-def]
    """Piece, place and value of the largest size, the largest and the least value; worst sum."""
    room = np.empty((4, MAX_COEFFICIENTS + 2))
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    tops = np.zeros((3, 3))
    scores = np.full(3, -np.inf)
    worst = 0.0
    for k in range(degrees.size):
        count = _piece_extrema(
            scaled, degrees[k], powers[k], k, joint, order, room[0], room[1], work, room[2], room[3]
        )
        for m in range(count):
            s, value = room[2, m], room[3, m]
            worst = max(worst, abs(value) + error[k, order, joint])
            for side in range(3):
                score = abs(value) if side == 0 else (value if side == 1 else -value)
                if score > scores[side]:
                    scores[side] = score
                    tops[side, 0], tops[side, 1], tops[side, 2] = k, s, value
    return tops, worst


@compiled
def _near(scaled, degrees, powers, joint, order, low, high, pieces, found):  # type: ignore[no-untyped-def]
    """Extrema at most ``low`` or at least ``high``: piece, place and value; returns their number.

    Beyond the room in ``pieces`` they are counted only.
    """
    room = np.empty((4, MAX_COEFFICIENTS + 2))
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    total = 0
    for k in range(degrees.size):
        count = _piece_extrema(
            scaled, degrees[k], powers[k], k, joint, order, room[0], room[1], work, room[2], room[3]
        )
        for m in range(count):
            value = room[3, m]
            if value <= low or value >= high:
                if total < pieces.size:
                    pieces[total] = k
                    found[total, 0], found[total, 1] = room[2, m], value
                total += 1
    return total


@dataclass(frozen=True, eq=False)
class Tops:
    """The extrema of one derivative of one joint that decide about its limits.

    Attributes
    ----------
    size, highest, lowest : Extremum
        Of the largest absolute value, of the largest and of the least value; the first in time
        where several are equal.
    reach : float
        Largest sum of an absolute value and its error.
    """

    size: Extremum
    highest: Extremum
    lowest: Extremum
    reach: float


def tops(trajectory: Trajectory, error: Array, joint: int, order: int) -> Tops:
    """The extrema that decide, among all of `peak.extrema`.

    Parameters
    ----------
    trajectory : Trajectory
        Polynomials in time.
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of any extremum on a piece.
    joint, order : int

    Returns
    -------
    Tops
    """
    found, reach = _tops(*_given(trajectory, order), error, joint, order)
    breaks = trajectory.breaks
    points = [
        Extremum(
            joint,
            int(k),
            order,
            float(s),
            float(breaks[int(k)] + s * trajectory.durations[int(k)]),
            float(value),
        )
        for k, s, value in found
    ]
    size, highest, lowest = points
    return Tops(size, highest, lowest, float(reach))


def near_extrema(
    trajectory: Trajectory, joint: int, order: int, low: float, high: float
) -> tuple[NDArray[np.int64], Array, Array]:
    """Pieces, places and values of the extrema that lie at most at ``low`` or at least at ``high``.

    Parameters
    ----------
    trajectory : Trajectory
        Polynomials in time.
    joint, order : int
    low, high : float
        rad/sᵒʳᵈᵉʳ.

    Returns
    -------
    pieces, places, values : ndarray, shape (extrema,)
    """
    given = _given(trajectory, order)
    room = 2 * len(trajectory.durations)
    while True:
        pieces, found = np.empty(room, dtype=np.int64), np.empty((room, 2))
        count = _near(*given, joint, order, low, high, pieces, found)
        if count <= room:
            return pieces[:count], found[:count, 0], found[:count, 1]
        room = count


def _given(trajectory: Trajectory, order: int) -> tuple[Array, NDArray[np.int64], Array]:
    degrees = np.array(trajectory.degrees, dtype=np.int64)
    return trajectory.scaled, degrees, trajectory.durations**order


def step_sizes(trajectory: Trajectory, order: int) -> tuple[Array, Array]:
    """Steps of a derivative at the inner breaks, and the sizes of their terms, (breaks, joints)."""
    factor = np.arange(trajectory.scaled.shape[1], dtype=np.float64)
    a = trajectory.scaled
    for _ in range(order):
        a = (a * factor[: a.shape[1], None])[:, 1:]
    a = a / (trajectory.durations**order)[:, None, None]
    sizes = np.abs(a).sum(axis=1)
    return a[1:, 0] - a[:-1].sum(axis=1), sizes[:-1] + sizes[1:]
