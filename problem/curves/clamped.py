"""The clamped B-spline of z1, evaluated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from .clamped_declaration import ClampedDeclaration, fractions_of
from .clamped_fit import (
    clamped_enclosed,
    clamped_gradients,
    clamped_reach,
    clamped_shape,
    splines_of,
)
from .clamped_knots import Knots, Parameters
from .families import piecewise, quintic_spline
from .kind import (
    Curve,
    Derivatives,
    Enclosed,
    Shape,
    as_batch,
    as_durations,
    as_waypoints,
)
from .peak import Extremum, PeakGradients
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
    points as there are inner knots plus p + 1. Knots at the way-points: W − 1 + p, so that p = 5
    is determined for v = a = 0, the C4 quintic spline. Averaged as printed: W, so that no
    degree leaves room for end conditions. Averaged with the index continued: W + 2c, any degree.
    """

    def prescribed_at(self, break_index: int) -> Derivatives:
        """Rest at both ends."""
        ends = break_index in (0, self.segments)
        return tuple((r, 0.0) for r in self.end_orders) if ends else ()

    def smooth_order(self, break_index: int) -> int:
        """The spline's own, unless every segment is stretched by itself."""
        return 0 if self.stretched else self.degree - 1

    def smooth_shares(self, waypoints: Array) -> Array | None:
        """Those of the parameters, where all joints have the same ones."""
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
        """The C(p−1) spline of degree p, which inner knots at the way-points' times make it."""
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
        """Segment by time: pieces end at knots."""
        inner = np.cumsum(durations)[:-1]
        return int(np.searchsorted(inner, point.time, side="left"))

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """Solved in extended precision, as `clamped_system.interpolated` bounds it."""
        if self.stretched:
            return super().enclosed(waypoints, durations)
        return clamped_enclosed(self, waypoints, durations)

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """The way-points themselves, unless stretched."""
        return super().motion_values(waypoints) if self.stretched else waypoints

    def batch_reach(
        self,
        values: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        sides: tuple[float, ...],
        least: int = 1,
    ) -> Array:
        """Of all pieces at once."""
        if self.stretched:
            return super().batch_reach(values, durations, wanted, sides, least)
        return clamped_reach(self, values, as_batch(self, durations), wanted, sides, least)

    def value_gradients(
        self,
        waypoints: Array,
        durations: Array,
        points: list[Extremum],
        nodal: Array | None = None,
    ) -> PeakGradients:
        """By complex steps in the durations; by the way-points with knots and parameters held."""
        if self.stretched:
            return super().value_gradients(waypoints, durations, points)
        return clamped_gradients(self, waypoints, durations, points)


def clamped_control_points(
    curve: ClampedBSpline, waypoints: ArrayLike, durations: ArrayLike
) -> tuple[Array, Array]:
    """Control points of each joint, and the knots they belong to.

    Parameters
    ----------
    curve : ClampedBSpline
        With time "timed".
    waypoints : array_like, shape (way-points, joints)
        rad.
    durations : array_like, shape (segments,)
        s.

    Returns
    -------
    control : ndarray, shape (control points, joints)
        rad.
    knots : ndarray, shape (control points + degree + 1, joints)
        s.

    Raises
    ------
    TrajgapError
        If shapes disagree, a duration is not positive, or no such curve passes the way-points.
    """
    q = as_waypoints(curve, waypoints)
    h = as_durations(durations, curve.segments)
    splines = splines_of(curve, q, h)
    p = curve.degree
    columns = [
        np.concatenate([np.zeros(p), s.knots, np.full(p, s.knots[-1])])
        for s in splines
        for _ in range(s.scaled.shape[2])
    ]
    return np.concatenate([s.control for s in splines], axis=1), np.stack(columns, axis=1)
