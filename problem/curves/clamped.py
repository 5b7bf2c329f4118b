"""The clamped B-spline of z1: evaluated, and the readings of it that are determined."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import product

import numpy as np

from ..arrays import Array
from ..errors import TrajgapError
from .clamped_declaration import (
    RULES,
    ClampedDeclaration,
    Knots,
    Parameters,
    count_inner_knots,
    fractions_of,
    nearest_reading,
)
from .clamped_fit import clamped_by_durations, clamped_enclosed, clamped_reach, clamped_shape
from .condition import counts_in_words
from .families import piecewise, quintic_spline
from .kind import Asked, Curve, Derivatives, Enclosed, Shape, Timing, as_batch
from .peak import Extremum
from .stretched import StretchedCurve


@dataclass(frozen=True)
class ClampedBSpline(ClampedDeclaration, StretchedCurve):
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
        What determines the knots. With chords the inner knots lie at fixed fractions of the
        total time.
    time : Timing or str
        "timed": e is time, the way-points are passed where the durations say. "stretched": the
        way-points lie at the parameters themselves and each segment is stretched in time
        separately, so the velocity may jump; with parameters from the times there is no
        difference, so this is refused.
    end_orders : tuple of int
        Derivatives that are 0 at both ends.
    fractions : tuple, optional
        Parameters from 0 to 1 to use instead of the chords of the way-points, one tuple for all
        joints or one for each; the printed ones where ``parameters`` is "given".
    knot_vector : tuple of float
        All knots as printed, on any scale, where ``knots`` is "given": degree + 1 equal ones at
        each end, each inner one once.

    Raises
    ------
    TrajgapError
        If a word is unknown, or the conditions do not determine the control points.

    Notes
    -----
    The way-points and end conditions are W + 2c conditions (c end orders) on as many control
    points as there are inner knots plus p + 1. Knots at the way-points: W − 1 + p, so p = 5
    is determined for v = a = 0, the C4 quintic spline. Averaged as printed: W, so no
    degree leaves room for end conditions. Averaged with the index continued: W + 2c, any degree.
    """

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Rest at both ends."""
        ends = break_index in (0, self.segments)
        return tuple((r, 0.0) for r in self.end_orders) if ends else ()

    def smooth_order(self, break_index: int) -> int:
        """The spline's own order, unless every segment is stretched separately."""
        return 0 if self.stretched else self.degree - 1

    def smooth_shares(self, waypoints: Array) -> Array | None:
        """The proportions of the parameters, if all joints have the same ones."""
        rows = fractions_of(self, waypoints) if self.stretched else None
        return None if rows is None or len(rows) > 1 else np.diff(rows[0])

    def fixed_by(self, waypoints: Array) -> ClampedBSpline:
        """The curve with the chord parameters of these way-points as its `fractions`."""
        return replace(self, fractions=fractions_of(self, waypoints))

    def for_joint(self, waypoints: Array, index: int) -> ClampedBSpline:
        """The curve of one joint: chords of the joint vector stay those of all joints."""
        fixed = self.fixed_by(waypoints)
        if fixed.fractions is None or len(fixed.fractions) == 1:
            return fixed
        return replace(fixed, fractions=(fixed.fractions[index],))

    def polynomial_form(self) -> Curve:
        """The C(p−1) spline of degree p, if the inner knots lie at the way-points' times."""
        if self.knots is not Knots.WAYPOINTS or self.parameters is not Parameters.TIMES:
            return self
        if (self.degree, self.end_orders) == (5, (1, 2)):
            return quintic_spline(self.segments)
        ends = tuple((order, 0.0) for order in self.end_orders)
        return piecewise((self.degree,) * self.segments, self.degree - 1, ends)

    def shape(self, waypoints: Array) -> Shape | None:
        """The curve in its parameter where it is stretched."""
        return clamped_shape(self, waypoints) if self.stretched else None

    def segment_of(self, durations: Array, point: Extremum) -> int:
        """Find the segment by time, because pieces end at knots."""
        inner = np.cumsum(durations)[:-1]
        return int(np.searchsorted(inner, point.time, side="left"))

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """Solved in extended precision, as `clamped_fit` bounds it."""
        if self.stretched:
            return super().enclosed(waypoints, durations)
        return clamped_enclosed(self, waypoints, durations)

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """The way-points themselves, unless stretched."""
        return super().motion_values(waypoints) if self.stretched else waypoints

    def batch_reach(self, values: Array, durations: Array, asked: Asked) -> Array:
        """Compute it for all pieces at once."""
        if self.stretched:
            return super().batch_reach(values, durations, asked)
        return clamped_reach(self, values, as_batch(self, durations), asked)

    def by_durations(self, waypoints: Array, durations: Array, points: list[Extremum]) -> Array:
        """Computed by complex steps; for stretched segments in closed form."""
        if self.stretched:
            return super().by_durations(waypoints, durations, points)
        return clamped_by_durations(self, waypoints, durations, points)


DEGREES = (3, 4, 5, 6, 7)
"""Degrees that `ClampedBSpline` takes: from C2 in time up to the highest compared anywhere."""


class Count(StrEnum):
    """Conditions against control points."""

    DETERMINED = "determined"
    """As many conditions as control points."""
    OVER = "over-determined"
    """More conditions than control points: impossible but for special way-points."""
    UNDER = "under-determined"
    """Control points are left free."""


@dataclass(frozen=True)
class ClampedReading:
    """One way of reading degree, knots and parameters, with its count.

    Attributes
    ----------
    conditions, control_points : int
        Of one joint.
    curve : ClampedBSpline or None
        The declaration, if it is determined.
    words : str
        A description of this reading, and the nearest one that works.
    """

    degree: int
    knots: Knots
    parameters: Parameters
    time: Timing
    conditions: int
    control_points: int
    count: Count
    curve: ClampedBSpline | None
    words: str

    def __str__(self) -> str:
        return (
            f"degree {self.degree}, knots {self.knots}, parameters {self.parameters}, "
            f"{self.time}: {self.words}"
        )


def clamped_readings(
    waypoints: int, end_orders: tuple[int, ...] = (1, 2), degrees: tuple[int, ...] = DEGREES
) -> tuple[ClampedReading, ...]:
    """Every reading of `z1-woa-bspline`, (1) to (12), for a number of way-points.

    Returns
    -------
    tuple of ClampedReading
        By degree, then knots, then parameters; stretched ones only where parameters come from
        chords. Degrees not above the highest of `end_orders` are left out.

    Raises
    ------
    TrajgapError
        If there are fewer than two way-points.

    Examples
    --------
    >>> first = clamped_readings(8, degrees=(5,))[0]
    >>> first.words
    'determined, 12 conditions for 12 control points'
    """
    if waypoints < 2:
        raise TrajgapError("interpolant: at least two way-points are needed")
    found = []
    sources = [one for one in Parameters if one is not Parameters.GIVEN]
    able = [degree for degree in degrees if degree > max(end_orders, default=0)]
    for degree, knots, parameters, time in product(able, RULES, sources, Timing):
        if time is Timing.STRETCHED and parameters is Parameters.TIMES:
            continue
        found.append(_read(waypoints, degree, knots, parameters, time, end_orders))
    return tuple(found)


def _read(
    waypoints: int,
    degree: int,
    knots: Knots,
    parameters: Parameters,
    time: Timing,
    end_orders: tuple[int, ...],
) -> ClampedReading:
    conditions = waypoints + 2 * len(end_orders)
    inner = count_inner_knots(knots, waypoints, degree, end_orders)
    points = inner + degree + 1
    counted = counts_in_words(conditions, points, "control points")
    count, curve, why = Count.OVER, None, nearest_reading(knots, degree, end_orders)
    if inner < 0:
        words = f"impossible as printed: degree {degree} needs more way-points; lower the degree"
    elif points == conditions:
        count = Count.DETERMINED
        curve = ClampedBSpline(waypoints, degree, knots, parameters, time, end_orders)
        words = f"determined, {counted}{'' if parameters is Parameters.TIMES else _CHORDS[time]}"
    elif points < conditions:
        # Only the printed rule, taken at its letter, is called impossible.
        literal = "impossible as printed: " if knots is Knots.AVERAGED else ""
        words = f"{literal}over-determined, {counted}; {why}"
    else:
        count, free = Count.UNDER, points - conditions
        words = f"under-determined, {counted}: {free} left free per joint"
        if parameters is Parameters.TIMES:
            words += (
                f', which family "polynomials" of degree {degree}, continuity {degree - 1} and '
                f"free = {free} leaves to the optimiser"
            )
        words += f"; {why}"
    return ClampedReading(degree, knots, parameters, time, conditions, points, count, curve, words)


_CHORDS = {
    Timing.TIMED: (
        "; chords place the knots, times the way-points: passes only durations not too far from "
        "the chords' proportions"
    ),
    Timing.STRETCHED: (
        "; chords place knots and way-points, and the velocity jumps if a segment's duration "
        "leaves the chords' proportions. With one u = t/T for all, only the total of the durations "
        "remains free"
    ),
}
"""What is added to the words of a determined reading with chord parameters."""
