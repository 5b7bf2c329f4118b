"""What a clamped B-spline declares: degree, knots and parameters, with its conditions counted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .condition import counts_in_words
from .kind import Timing


class Knots(StrEnum):
    """Where the inner knots lie."""

    WAYPOINTS = "waypoints"
    """At the parameters of the inner way-points."""
    AVERAGED = "averaged"
    """u_{j+p} = (ū_j + … + ū_{j+p−1})/p, j = 1..n − p: (6) of z1 with its index as in the sum."""
    CONTINUED = "averaged-continued"
    """The same with the first and last parameter repeated for each end condition, so every
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
    """Chord lengths of each joint separately."""
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
        If it is not a clamped vector of that degree whose inner knots are all different.
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
                "each may stand once, to keep the curve smooth there"
            )
    return tuple((u - knots[0]) / (knots[-1] - knots[0]) for u in knots[ends : len(knots) - ends])


def inside_support(
    knots: NDArray[np.float64], sites: NDArray[np.float64], degree: int
) -> NDArray[np.bool_]:
    """Which sites lie in the support of their basis function (Schoenberg and Whitney).

    Sites of end conditions are included: an end as often as something is asked there.
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
            f"with knots at the way-points, degree {rest + 1} is determined; with the index "
            f"continued, degree {degree} is"
        )
    return f"continue the averaging index at both ends, one knot for each of the {rest} conditions"


def chord_fractions(waypoints: NDArray[np.generic]) -> Fractions:
    """Chord parameters (5) of way-points, from 0 to 1.

    Raises
    ------
    TrajgapError
        If two neighbours coincide.
    """
    chords = np.sqrt((np.abs(np.diff(waypoints, axis=0)) ** 2).sum(axis=1))
    if not (chords > 0).all():
        k = int(np.argmin(chords))
        raise TrajgapError(
            f"waypoints: {k} and {k + 1} coincide, so chord parameters cannot distinguish them; "
            "take the parameters from the times"
        )
    along = np.concatenate([[0.0], np.cumsum(chords)])
    along /= along[-1]
    return (tuple(map(float, along)),)


@dataclass(frozen=True)
class ClampedDeclaration:
    """The fields of `ClampedBSpline`, checked and counted."""

    waypoints: int
    degree: int
    knots: Knots = Knots.WAYPOINTS
    parameters: Parameters = Parameters.TIMES
    time: Timing = Timing.TIMED
    end_orders: tuple[int, ...] = (1, 2)
    fractions: Fractions | None = None
    knot_vector: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for field, words in (("knots", Knots), ("parameters", Parameters), ("time", Timing)):
            given = getattr(self, field)
            if given not in tuple(words):
                raise TrajgapError(
                    f"interpolant.{field}: {given!r} is unknown; use one of {', '.join(words)}"
                )
            object.__setattr__(self, field, words(given))
        object.__setattr__(self, "knot_vector", tuple(map(float, self.knot_vector)))
        if self.waypoints < 2:
            raise TrajgapError("interpolant: at least two way-points are needed")
        if not 3 <= self.degree <= 7:
            raise TrajgapError(f"interpolant.degree: must lie in 3..7, got {self.degree}")
        if any(not 1 <= r < self.degree for r in self.end_orders) or len(
            set(self.end_orders)
        ) != len(self.end_orders):
            raise TrajgapError(
                "interpolant.end_orders: orders must be distinct and lie in 1..degree − 1"
            )
        if self.time is Timing.STRETCHED and self.parameters is Parameters.TIMES:
            raise TrajgapError(
                "interpolant.time: parameters from the times are times already; "
                "leave stretched out, or take the parameters from chords"
            )
        self._check_numbers()
        if self.inner_knots < 0:
            raise TrajgapError(
                f"interpolant {self.name}: degree {self.degree} needs at least "
                f"{self.waypoints - self.inner_knots} way-points; lower the degree"
            )
        if self.free:
            word = "over" if self.free < 0 else "under"
            nearest = nearest_reading(self.knots, self.degree, self.end_orders)
            if self.knots is Knots.GIVEN:
                whole = self.conditions + self.degree + 1
                nearest = f"{whole} knots determine it, but {len(self.knot_vector)} are given"
            raise TrajgapError(
                f"interpolant {self.name}: {word}-determined, "
                f"{counts_in_words(self.conditions, self.control_points, 'control points')}; "
                f"{nearest}"
            )
        for row in self.fractions or ():
            if len(row) != self.waypoints or row[0] != 0.0 or row[-1] != 1.0:
                raise TrajgapError(
                    f"interpolant.fractions: expected {self.waypoints} numbers from 0 to 1"
                )
        if self.knots is Knots.GIVEN and self.stretched:
            self._check_passing()

    def _check_numbers(self) -> None:
        """Find out whether what is printed of knots and parameters is there, and goes together."""
        given = self.knots is Knots.GIVEN
        if given != bool(self.knot_vector):
            raise TrajgapError(
                'interpolant.knot_vector: is missing, although knots are "given"; list all knots'
                if given
                else 'interpolant.knot_vector: is for knots that are "given"; leave it out'
            )
        if self.parameters is Parameters.GIVEN and not self.fractions:
            raise TrajgapError(
                'interpolant.fractions: are missing where parameters are "given"; give one for '
                "each way-point"
            )
        for row in self.fractions or ():
            if any(not a < b for a, b in pairwise(row)):
                raise TrajgapError("interpolant.fractions: each must be larger than the one before")
        fitting = Parameters.GIVEN if self.stretched else Parameters.TIMES
        if given and self.parameters is not fitting:
            where = "printed parameters" if self.stretched else "the times"
            raise TrajgapError(
                f'interpolant.parameters: if knots are "given" and time is "{self.time}", '
                f'way-points are passed at {where}; write "{fitting}"'
            )

    def _check_passing(self) -> None:
        """Find out whether a spline with the printed knots passes the printed parameters."""
        p, rest = self.degree, len(self.end_orders)
        inner = inner_fractions(self.knot_vector, p)
        knots = np.concatenate([np.zeros(p + 1), inner, np.ones(p + 1)])
        for row in self.fractions or ():
            sites = np.concatenate([np.zeros(rest), row, np.ones(rest)])
            inside = inside_support(knots, sites, p)
            if not inside.all():
                outside = int(np.argmin(inside))
                low, high = knots[outside], knots[outside + p + 1]
                raise TrajgapError(
                    f"interpolant.knot_vector: no curve passes way-point {outside - rest + 1}, "
                    f"whose parameter {sites[outside]:g} (of 0 to 1) does not lie between the "
                    f"knots {low:g} and {high:g} (Schoenberg and Whitney); correct knots or "
                    "parameters"
                )

    @property
    def name(self) -> str:
        """Words for messages."""
        where = {
            Knots.WAYPOINTS: "knots at the way-points",
            Knots.AVERAGED: "averaged knots",
            Knots.CONTINUED: "averaged knots, index continued",
            Knots.GIVEN: "printed knots",
        }[self.knots]
        source = {
            Parameters.TIMES: "",
            Parameters.CHORD: " of chord parameters",
            Parameters.JOINT_CHORD: " of each joint's chord parameters",
            Parameters.GIVEN: " of printed parameters",
        }[self.parameters]
        stretched = ", stretched in time" if self.time is Timing.STRETCHED else ""
        return f"clamped B-spline of degree {self.degree}, {where}{source}{stretched}"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1

    @property
    def inner_knots(self) -> int:
        """Number of inner knots; negative if there are too few way-points."""
        if self.knots is Knots.GIVEN:
            return len(inner_fractions(self.knot_vector, self.degree))
        return count_inner_knots(self.knots, self.waypoints, self.degree, self.end_orders)

    @property
    def control_points(self) -> int:
        """Number of control points."""
        return self.inner_knots + self.degree + 1

    @property
    def conditions(self) -> int:
        """Way-points and end conditions."""
        return self.waypoints + 2 * len(self.end_orders)

    @property
    def free(self) -> int:
        """Control points less conditions: 0 for every declaration that can be made."""
        return self.control_points - self.conditions

    @property
    def stretched(self) -> bool:
        """Whether each segment is stretched in time by itself."""
        return self.time is Timing.STRETCHED


def fractions_of(curve: ClampedDeclaration, waypoints: Array) -> Fractions | None:
    """Parameters that are not times; None if they are."""
    if curve.fractions is not None or curve.parameters is Parameters.TIMES:
        return curve.fractions
    if curve.parameters is Parameters.CHORD:
        return chord_fractions(waypoints)
    return tuple(chord_fractions(q[:, None])[0] for q in waypoints.T)


def average_matrix(curve: ClampedDeclaration) -> Array:
    """Inner knots as combinations of the way-points' parameters, shape (inner knots, W)."""
    w, p = curve.waypoints, curve.degree
    if curve.knots is Knots.GIVEN:
        # Parameters start at 0, so a fraction of the last one is a fraction of the whole.
        return np.outer(inner_fractions(curve.knot_vector, p), np.eye(w)[-1])
    if curve.knots is Knots.WAYPOINTS:
        return np.eye(w)[1:-1]
    repeats = len(curve.end_orders) if curve.knots is Knots.CONTINUED else 0
    sites = np.concatenate([np.zeros(repeats, int), np.arange(w), np.full(repeats, w - 1)])
    matrix = np.zeros((curve.inner_knots, w))
    for row, j in enumerate(range(1, curve.inner_knots + 1)):
        np.add.at(matrix[row], sites[j : j + p], 1.0 / p)
    return matrix
