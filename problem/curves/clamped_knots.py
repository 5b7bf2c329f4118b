"""Where the knots of a clamped B-spline lie."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError

if TYPE_CHECKING:
    from .clamped import ClampedBSpline


class Knots(StrEnum):
    """Where the inner knots lie."""

    WAYPOINTS = "waypoints"
    """At the parameters of the inner way-points."""
    AVERAGED = "averaged"
    """u_{j+p} = (ū_j + … + ū_{j+p−1})/p, j = 1..n − p: (6) of z1 with its index as in the sum."""
    CONTINUED = "averaged-continued"
    """The same with the first and last parameter repeated for each end condition, so that every
    condition brings a knot (The NURBS Book, 9.2.2, does so for first derivatives)."""


class Parameters(StrEnum):
    """What the parameters ū_k of the way-points are taken from."""

    TIMES = "times"
    """The times at which they are passed."""
    CHORD = "chord"
    """Chord lengths of the joint vector, (4) and (5) of z1."""
    JOINT_CHORD = "joint-chord"
    """Chord lengths of each joint by itself."""


Fractions = tuple[tuple[float, ...], ...]
"""Chord parameters of the way-points from 0 to 1: one row for all joints, or one for each."""


def count_inner_knots(
    knots: Knots, waypoints: int, degree: int, end_orders: tuple[int, ...]
) -> int:
    """Number of inner knots; negative if there are too few way-points."""
    if knots is Knots.WAYPOINTS:
        return waypoints - 2
    repeated = 2 * len(end_orders) if knots is Knots.CONTINUED else 0
    return waypoints + repeated - 1 - degree


def nearest_reading(knots: Knots, degree: int, end_orders: tuple[int, ...]) -> str:
    """The nearest declaration that is determined, in words."""
    rest = 2 * len(end_orders)
    if knots is Knots.WAYPOINTS:
        return (
            f"with knots at the way-points degree {rest + 1} is determined, with the index "
            f"continued degree {degree} is"
        )
    return f"continue the averaging index at both ends, one knot for each of the {rest} conditions"


def chord_fractions(waypoints: NDArray[np.generic]) -> Fractions:
    """Chord parameters (5) of way-points, from 0 to 1.

    Parameters
    ----------
    waypoints : ndarray, shape (way-points, joints)

    Raises
    ------
    TrajgapError
        If two neighbours coincide.
    """
    chords = np.sqrt((np.abs(np.diff(waypoints, axis=0)) ** 2).sum(axis=1))
    if not (chords > 0).all():
        k = int(np.argmin(chords))
        raise TrajgapError(
            f"waypoints: {k} and {k + 1} coincide, chord parameters do not tell them apart; "
            "take the parameters from the times"
        )
    along = np.concatenate([[0.0], np.cumsum(chords)])
    along /= along[-1]
    return (tuple(map(float, along)),)


def fractions_of(curve: ClampedBSpline, waypoints: Array) -> Fractions | None:
    """Chord parameters that place the knots; None where the times do."""
    if curve.fractions is not None or curve.parameters is Parameters.TIMES:
        return curve.fractions
    if curve.parameters is Parameters.CHORD:
        return chord_fractions(waypoints)
    return tuple(chord_fractions(q[:, None])[0] for q in waypoints.T)


def average_matrix(curve: ClampedBSpline) -> Array:
    """Inner knots as combinations of the way-points' parameters, shape (inner knots, W)."""
    w, p = curve.waypoints, curve.degree
    if curve.knots is Knots.WAYPOINTS:
        return np.eye(w)[1:-1]
    repeats = len(curve.end_orders) if curve.knots is Knots.CONTINUED else 0
    sites = np.concatenate([np.zeros(repeats, int), np.arange(w), np.full(repeats, w - 1)])
    matrix = np.zeros((curve.inner_knots, w))
    for row, j in enumerate(range(1, curve.inner_knots + 1)):
        np.add.at(matrix[row], sites[j : j + p], 1.0 / p)
    return matrix
