"""Where the knots of a clamped B-spline lie."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from itertools import pairwise
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from ..errors import TrajgapError


class Knots(StrEnum):
    """Where the inner knots lie."""

    WAYPOINTS = "waypoints"
    """At the parameters of the inner way-points."""
    AVERAGED = "averaged"
    """u_{j+p} = (ū_j + … + ū_{j+p−1})/p, j = 1..n − p: (6) of z1 with its index as in the sum."""
    CONTINUED = "averaged-continued"
    """The same with the first and last parameter repeated for each end condition, so that every
    condition brings a knot (The NURBS Book, 9.2.2, does so for first derivatives)."""
    GIVEN = "given"
    """A printed knot vector, at fixed fractions of the whole."""


class Parameters(StrEnum):
    """What the parameters ū_k of the way-points are taken from."""

    TIMES = "times"
    """The times at which they are passed."""
    CHORD = "chord"
    """Chord lengths of the joint vector, (4) and (5) of z1."""
    JOINT_CHORD = "joint-chord"
    """Chord lengths of each joint by itself."""
    GIVEN = "given"
    """Printed numbers."""


RULES = (Knots.WAYPOINTS, Knots.AVERAGED, Knots.CONTINUED)
"""Ways of placing knots: what a paper that prints none leaves to choose from."""
Fractions = tuple[tuple[float, ...], ...]
"""Parameters of the way-points from 0 to 1: one row for all joints, or one for each."""


def inner_fractions(vector: Sequence[float], degree: int) -> tuple[float, ...]:
    """Inner knots of a printed knot vector, as fractions of the whole.

    Parameters
    ----------
    vector : sequence of float
        All knots, those that are repeated at the ends included, on any scale.
    degree : int

    Returns
    -------
    tuple of float
        Between 0 and 1, increasing.

    Raises
    ------
    TrajgapError
        If it is no clamped vector of that degree whose inner knots are all different.
    """
    ends, knots = degree + 1, [float(u) for u in vector]
    if not all(map(isfinite, knots)):
        raise TrajgapError("interpolant.knot_vector: knots must be finite")
    if len(knots) < 2 * ends:
        raise TrajgapError(
            f"interpolant.knot_vector: has {len(knots)} knots, but degree {degree} needs "
            f"{2 * ends} at least, {ends} equal ones at each end; give the whole vector"
        )
    for one, other in pairwise(knots):
        if other < one:
            raise TrajgapError(
                f"interpolant.knot_vector: {one:g} is followed by {other:g}, but knots do not "
                "decrease; correct one of them"
            )
    for end, name in ((knots[0], "first"), (knots[-1], "last")):
        if knots.count(end) != ends:
            raise TrajgapError(
                f"interpolant.knot_vector: the {name} knot, {end:g}, stands {knots.count(end)} "
                f"times; a clamped vector of degree {degree} has it {ends} times"
            )
    for one, other in pairwise(knots[degree + 1 : len(knots) - degree - 1]):
        if one == other:
            raise TrajgapError(
                f"interpolant.knot_vector: the inner knot {one:g} stands {knots.count(one)} times; "
                "each may stand once, so that the curve is smooth there"
            )
    return tuple((u - knots[0]) / (knots[-1] - knots[0]) for u in knots[ends : len(knots) - ends])


def inside_support(
    knots: NDArray[np.float64], sites: NDArray[np.float64], degree: int
) -> NDArray[np.bool_]:
    """Which sites lie in the support of their basis function (Schoenberg and Whitney).

    Parameters
    ----------
    knots : ndarray, shape (..., sites + degree + 1)
    sites : ndarray, shape (..., sites)
        Those of end conditions included: an end as often as something is asked there.
    degree : int

    Returns
    -------
    ndarray of bool, shape (..., sites)
    """
    count = sites.shape[-1]
    low, high = knots[..., :count], knots[..., degree + 1 : degree + 1 + count]
    start, end = sites[..., :1], sites[..., -1:]
    at_ends = (sites == start) & (low == start) | (sites == end) & (high == end)
    return np.asarray((low < sites) & (sites < high) | at_ends)


def count_inner_knots(
    knots: Knots, waypoints: int, degree: int, end_orders: tuple[int, ...]
) -> int:
    """Number of inner knots that a rule places; negative if there are too few way-points."""
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
