"""Exact extrema of trajectories by compiled code, the same as `peak.extrema`, without objects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .compilation import Deferred
from .kernel import MAX_COEFFICIENTS, compiled, roots_in_unit
from .peak import Extremum
from .spline import PERM
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
        value = a[size - 1] + places[m] * 0.0
        for i in range(size - 2, -1, -1):
            value = a[i] + value * places[m]
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


@compiled
def _largest_of_each(scaled, degrees, powers, error, wanted, tops, reach):  # type: ignore[no-untyped-def]
    """Piece, place and value of the largest size, and the worst sum, of each wanted derivative."""
    room = np.empty((4, MAX_COEFFICIENTS + 2))
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    for joint in range(wanted.shape[0]):
        for order in range(1, wanted.shape[1] + 1):
            if not wanted[joint, order - 1]:
                continue
            size, worst = -1.0, -np.inf
            for k in range(degrees.size):
                count = _piece_extrema(
                    scaled, degrees[k], powers[k, order], k, joint, order,
                    room[0], room[1], work, room[2], room[3],
                )  # fmt: skip
                best = 0
                for m in range(1, count):
                    # The first of equal ones; what is not a number is the largest.
                    top = abs(room[3, best])
                    if top == top and not abs(room[3, m]) <= top:
                        best = m
                here = abs(room[3, best])
                if size == size and not here <= size:
                    size = here
                    tops[joint, order - 1, 0] = k
                    tops[joint, order - 1, 1] = room[2, best]
                    tops[joint, order - 1, 2] = room[3, best]
                total = here + error[k, order, joint]
                if worst == worst and not total <= worst:
                    worst = total
            reach[joint, order - 1] = worst


_each = Deferred(_largest_of_each, 2.0)
"""Of a few pieces; compiling it takes two to three seconds."""
_deciding = Deferred(_tops, 2.0)
"""Of many pieces; compiling it takes as long."""
_beyond = Deferred(_near, 2.0)
"""Extrema beyond two values; compiling it takes as long."""


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
    found, reach = _deciding(*_polynomials(trajectory, order), error, joint, order)
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


def largest_of_each(
    trajectory: Trajectory, error: Array, wanted: NDArray[np.bool_]
) -> list[tuple[Extremum, float]]:
    """`peak.largest` of each wanted derivative, by one call, to the last bit.

    Parameters
    ----------
    trajectory : Trajectory
        Polynomials in time.
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of any extremum on a piece.
    wanted : ndarray of bool, shape (joints, 3)
        Velocity, acceleration and jerk of which joints.

    Returns
    -------
    list of (Extremum, float)
        By joint, then by order: the extremum, and the bound on its error.
    """
    durations, breaks = trajectory.durations.tolist(), trajectory.breaks.tolist()
    # Powers of single numbers, as `Trajectory.derivative` takes them: those of arrays may differ
    # in the last bit.
    powers = np.array([[d**r for r in range(4)] for d in trajectory.durations])
    tops, reach = np.zeros((*wanted.shape, 3)), np.zeros(wanted.shape)
    degrees = np.array(trajectory.degrees, dtype=np.int64)
    _each(trajectory.scaled, degrees, powers, error, wanted, tops, reach)
    found = []
    for joint, column in np.argwhere(wanted).tolist():
        piece, place, value = tops[joint, column].tolist()
        k, order = int(piece), column + 1
        time = breaks[k] + place * durations[k]
        bound = max(float(error[k, order, joint]), float(reach[joint, column]) - abs(value))
        found.append((Extremum(joint, k, order, place, time, value), bound))
    return found


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
    given = _polynomials(trajectory, order)
    room = 2 * len(trajectory.durations)
    while True:
        pieces, found = np.empty(room, dtype=np.int64), np.empty((room, 2))
        count = _beyond(*given, joint, order, low, high, pieces, found)
        if count <= room:
            return pieces[:count], found[:count, 0], found[:count, 1]
        room = count


def _polynomials(trajectory: Trajectory, order: int) -> tuple[Array, NDArray[np.int64], Array]:
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


def may_jump(trajectory: Trajectory, error: Array) -> bool:
    """Whether a step at an inner break comes near the size of a jump, for `trajgap.problem.check`.

    A look at all breaks at once: it misses no jump. Sums in another order differ by some 1e-16 of
    their terms, and the size of a jump is 1e-9 of them.

    Parameters
    ----------
    trajectory : Trajectory
        Polynomials in time.
    error : ndarray, shape (pieces, 4, joints)
        Bound on the error of position, velocity and acceleration on each piece.

    Returns
    -------
    bool
    """
    scaled = trajectory.scaled
    sums = PERM[: scaled.shape[1], :3].T
    rates = (trajectory.durations[:, None] ** np.arange(3))[:, :, None]
    starts = (np.diagonal(sums)[:, None] * scaled[:, :3]) / rates
    ends, sizes = (sums @ scaled) / rates, (sums @ np.abs(scaled)) / rates
    least = error[:-1, :3] + error[1:, :3] + 1e-9 * (sizes[:-1] + sizes[1:])
    return not (np.abs(starts[1:] - ends[:-1]) <= 0.5 * least).all()
