"""What a clamped B-spline declares: degree, knots and parameters, with its conditions counted."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..errors import TrajgapError
from .clamped_knots import (
    Fractions,
    Knots,
    Parameters,
    chord_fractions,
    count_inner_knots,
    inner_fractions,
    inside_support,
    nearest_reading,
)
from .condition import counts_in_words
from .stretched import Timing


@dataclass(frozen=True)
class ClampedDeclaration:
    """The fields of `ClampedBSpline`, checked and counted.

    Raises
    ------
    TrajgapError
        If a word is unknown, or the conditions do not determine the control points.
    """

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
                nearest = (
                    f"{whole} knots in all determine it, and {len(self.knot_vector)} are given"
                )
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
                'interpolant.knot_vector: is missing where knots are "given"; name all of them'
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
                f'interpolant.parameters: where knots are "given" and time is "{self.time}", '
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
                    f"interpolant.knot_vector: no curve passes way-point {outside - rest}, whose "
                    f"parameter {sites[outside]:g} (of 0 to 1) does not lie between the knots "
                    f"{low:g} and {high:g} (Schoenberg and Whitney); correct knots or parameters"
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
    """Parameters that are no times; None where they are."""
    if curve.fractions is not None or curve.parameters is Parameters.TIMES:
        return curve.fractions
    if curve.parameters is Parameters.CHORD:
        return chord_fractions(waypoints)
    return tuple(chord_fractions(q[:, None])[0] for q in waypoints.T)


def average_matrix(curve: ClampedDeclaration) -> Array:
    """Inner knots as combinations of the way-points' parameters, shape (inner knots, W)."""
    w, p = curve.waypoints, curve.degree
    if curve.knots is Knots.GIVEN:
        # Parameters start at 0, so that a fraction of the last one is a fraction of the whole.
        return np.outer(inner_fractions(curve.knot_vector, p), np.eye(w)[-1])
    if curve.knots is Knots.WAYPOINTS:
        return np.eye(w)[1:-1]
    repeats = len(curve.end_orders) if curve.knots is Knots.CONTINUED else 0
    sites = np.concatenate([np.zeros(repeats, int), np.arange(w), np.full(repeats, w - 1)])
    matrix = np.zeros((curve.inner_knots, w))
    for row, j in enumerate(range(1, curve.inner_knots + 1)):
        np.add.at(matrix[row], sites[j : j + p], 1.0 / p)
    return matrix
