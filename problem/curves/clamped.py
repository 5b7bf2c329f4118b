"""The clamped B-spline of z1: degree, knots and parameters, with its conditions counted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import TrajgapError
from .interpolant import piecewise, quintic_spline
from .kind import Curve, Ends, end_conditions, for_joint, smooth_order
from .uniform import Timing


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


@dataclass(frozen=True)
class ClampedBSpline:
    """Clamped B-spline through the way-points at rest at both ends.

    Source: `z1-woa-bspline`, (1) to (12); (3) puts the way-points at the times.

    Parameters
    ----------
    waypoints : int
        Number of way-points, at least 2.
    degree : int
        p, 3 to 7; z1 does not print it.
    knots : Knots or str
    parameters : Parameters or str
        What the knots are placed by. With chords the inner knots lie at fixed fractions of the
        total time.
    time : Timing or str
        "timed": e is time, the way-points are passed where the durations say. "stretched": the
        way-points sit at the parameters themselves and each segment is stretched in time by
        itself, so that velocity may jump; with parameters from the times there is no difference,
        and it is refused.
    end_orders : tuple of int
        Derivatives that are 0 at both ends.
    fractions : tuple, optional
        Chord parameters to use instead of those of the way-points, one tuple for all joints or
        one for each.

    Raises
    ------
    TrajgapError
        If a word is unknown, or the conditions do not determine the control points.

    Notes
    -----
    The way-points and end conditions are W + 2c conditions (c end orders) on as many control
    points as there are inner knots plus p + 1. Knots at the way-points: W − 1 + p, so that p = 5
    is determined for v = a = 0, the C4 quintic spline. Averaged as printed: W, so that no
    degree leaves room for end conditions. Averaged with the index continued: W + 2c, any degree.
    """

    waypoints: int
    degree: int
    knots: Knots = Knots.WAYPOINTS
    parameters: Parameters = Parameters.TIMES
    time: Timing = Timing.TIMED
    end_orders: tuple[int, ...] = (1, 2)
    fractions: Fractions | None = None

    def __post_init__(self) -> None:
        for field, words in (("knots", Knots), ("parameters", Parameters), ("time", Timing)):
            given = getattr(self, field)
            if given not in tuple(words):
                raise TrajgapError(
                    f"interpolant.{field}: {given!r} is unknown; use one of {', '.join(words)}"
                )
            object.__setattr__(self, field, words(given))
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
        if self.inner_knots < 0:
            raise TrajgapError(
                f"interpolant {self.name}: degree {self.degree} needs at least "
                f"{self.waypoints - self.inner_knots} way-points; lower the degree"
            )
        if self.free:
            word = "over" if self.free < 0 else "under"
            raise TrajgapError(
                f"interpolant {self.name}: {word}-determined, {self.conditions} conditions on "
                f"{self.control_points} control points; {nearest(self)}"
            )
        for row in self.fractions or ():
            if len(row) != self.waypoints or row[0] != 0.0 or row[-1] != 1.0:
                raise TrajgapError(
                    f"interpolant.fractions: expected {self.waypoints} numbers from 0 to 1"
                )

    @property
    def name(self) -> str:
        """Words for messages."""
        where = {
            Knots.WAYPOINTS: "knots at the way-points",
            Knots.AVERAGED: "averaged knots",
            Knots.CONTINUED: "averaged knots, index continued",
        }[self.knots]
        source = {
            Parameters.TIMES: "",
            Parameters.CHORD: " of chord parameters",
            Parameters.JOINT_CHORD: " of each joint's chord parameters",
        }[self.parameters]
        stretched = ", stretched in time" if self.time is Timing.STRETCHED else ""
        return f"clamped B-spline of degree {self.degree}, {where}{source}{stretched}"

    @property
    def segments(self) -> int:
        """Number of segments, one less than way-points."""
        return self.waypoints - 1

    @property
    def waypoint_breaks(self) -> tuple[int, ...]:
        """Every break carries a way-point."""
        return tuple(range(self.waypoints))

    @property
    def homogeneous(self) -> bool:
        """Always: the end derivatives are 0."""
        return True

    @property
    def inner_knots(self) -> int:
        """Number of inner knots; negative if there are too few way-points."""
        if self.knots is Knots.WAYPOINTS:
            return self.waypoints - 2
        sites = self.waypoints
        if self.knots is Knots.CONTINUED:
            sites += 2 * len(self.end_orders)
        return sites - 1 - self.degree

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


def polynomial_form(curve: Curve) -> Curve:
    """The same curve declared as polynomials with breaks at the way-points, where it is one.

    A clamped B-spline of degree p with its inner knots at the times of the inner way-points is
    the C(p−1) spline of degree p; in that form it is evaluated several times faster.

    Parameters
    ----------
    curve : Curve

    Returns
    -------
    Curve
        The given one where it is anything else.
    """
    if not isinstance(curve, ClampedBSpline) or curve.knots is not Knots.WAYPOINTS:
        return curve
    if curve.parameters is not Parameters.TIMES:
        return curve
    if (curve.degree, curve.end_orders) == (5, (1, 2)):
        return quintic_spline(curve.segments)
    ends = tuple((order, 0.0) for order in curve.end_orders)
    return piecewise((curve.degree,) * curve.segments, curve.degree - 1, ends)


def nearest(curve: ClampedBSpline) -> str:
    """The nearest declaration that is determined, in words."""
    rest = 2 * len(curve.end_orders)
    if curve.knots is Knots.WAYPOINTS:
        return (
            f"with knots at the way-points degree {rest + 1} is determined, with the index "
            f"continued degree {curve.degree} is"
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


@for_joint.register
def _(curve: ClampedBSpline, waypoints: Array, index: int) -> Curve:
    fractions = fractions_of(curve, waypoints)
    if fractions is None or len(fractions) == 1:
        return curve if fractions is None else replace(curve, fractions=fractions)
    return replace(curve, fractions=(fractions[index],))


@end_conditions.register
def _(curve: ClampedBSpline) -> Ends:
    rest = tuple((r, 0.0) for r in curve.end_orders)
    return rest, rest


@smooth_order.register
def _(curve: ClampedBSpline, break_index: int) -> int:
    return 0 if curve.time is Timing.STRETCHED else curve.degree - 1
