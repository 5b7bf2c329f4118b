"""Curves of a fixed shape in a parameter, each segment stretched linearly in time."""

from __future__ import annotations

from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from ..limits import QUANTITIES
from .kind import (
    Curve,
    Enclosed,
    PeakGradients,
    Shape,
    as_batch,
    as_waypoints,
    value_errors,
)
from .peak import Extremum, rows_at
from .polynomials import derived, tops
from .trajectory import Trajectory


class Timing(StrEnum):
    """How time enters a curve that is given in a parameter e."""

    STRETCHED = "stretched"
    """Each segment by itself: time grows linearly in e, so velocity may jump between segments."""
    TIMED = "timed"
    """Time is itself a smooth function of e, or e is time."""


def shape_of(curve: Curve, waypoints: Array) -> Shape:
    """`Curve.shape`, refused where segments are not stretched.

    Raises
    ------
    TrajgapError
    """
    form = curve.shape(waypoints)
    if form is None:
        raise TrajgapError(
            f"curve: the segments of {curve.name} are not stretched in time by themselves, "
            "which is needed here"
        )
    return form


def segment_peaks(curve: Curve, waypoints: ArrayLike) -> Array:
    """Largest |q′|, |q″|, |q‴| of every segment when its duration is 1 s.

    A duration l divides them by l, l², l³.

    Parameters
    ----------
    curve : Curve
        One whose segments are stretched.
    waypoints : array_like, shape (way-points, joints)
        rad.

    Returns
    -------
    ndarray, shape (segments, joints, 3)
    """
    return np.asarray(segment_sides(curve, waypoints).max(axis=0))


def segment_sides(curve: Curve, waypoints: ArrayLike) -> Array:
    """`segment_peaks` below 0 and above, shape (2, segments, joints, 3); 0 for none.

    Parameters
    ----------
    curve : Curve
        One whose segments are stretched.
    waypoints : array_like, shape (way-points, joints)
        rad.
    """
    q = as_waypoints(curve, waypoints)
    form = shape_of(curve, q - q[0])
    peaks = np.zeros((2, curve.segments, q.shape[1], 3))
    a = form.scaled[:, : form.degree + 1].transpose(1, 0, 2)[:, :, None]
    for r in range(1, min(3, form.degree) + 1):
        part = derived(a, r) / form.share[:, None, None] ** r
        for side, sign in ((0, -1.0), (1, 1.0)):
            np.maximum.at(peaks[side, :, :, r - 1], form.segment, tops(part, sign))
    return peaks


def solve_in_closed_form(curve: Curve, waypoints: ArrayLike, limits: ArrayLike) -> Array:
    """Shortest durations of a stretched curve within limits of v, a and j, without a solver.

    With t linear in a segment, v = q′/l, a = q″/l², j = q‴/l³, and no duration enters another
    segment: the total is least when each is, l = max over joints of
    max(max|q′|/V, √(max|q″|/A), ∛(max|q‴|/J)). Jumps of the velocity between segments are not
    limited by V, A, J inside the segments, and are not looked at here.

    Parameters
    ----------
    curve : Curve
        One whose segments are stretched.
    waypoints : array_like, shape (way-points, joints)
        rad.
    limits : array_like, shape (joints, 3)
        As `Limits.derivatives`; infinite for no limit.

    Returns
    -------
    ndarray, shape (segments,)
        s; 0 for a segment in which nothing that is limited moves, infinite where a joint with
        limit 0 moves.
    """
    peaks = segment_peaks(curve, waypoints)
    bound = np.asarray(limits, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(peaks > 0.0, peaks / bound, 0.0)
    return np.asarray((ratios ** (1.0 / np.arange(1, len(QUANTITIES) + 1))).max(axis=(1, 2)))


def path_ranges(curve: Curve, waypoints: Array) -> Array:
    """Least and largest positions of a curve whose path no duration moves, shape (joints, 2).

    Parameters
    ----------
    curve : Curve
    waypoints : ndarray, shape (way-points, joints)
        rad; positions are counted from the first.
    """
    every = np.ones(waypoints.shape[1], dtype=bool)
    unit = np.ones((1, curve.segments))
    return np.asarray(Curve.batch_ranges(curve, waypoints - waypoints[0], unit, every)[0])


def ranges_where(valid: NDArray[np.bool_], ranges: Array, wanted: NDArray[np.bool_]) -> Array:
    """The same ranges for every valid vector, as `Curve.batch_ranges` returns them.

    Parameters
    ----------
    valid : ndarray of bool, shape (batch,)
        Whether a vector defines a curve.
    ranges : ndarray, shape (joints, 2)
        From `path_ranges`.
    wanted : ndarray of bool, shape (joints,)
    """
    asked = np.where(wanted[:, None], ranges, 0.0)
    nowhere = np.broadcast_to([-np.inf, np.inf], asked.shape)
    return np.where(valid[:, None, None], asked, nowhere)


class StretchedCurve(Curve):
    """A curve that is known by its `Curve.shape`: a subclass provides that, and these follow."""

    def enclosed(self, waypoints: Array, durations: Array, nodal: Array | None = None) -> Enclosed:
        """Pieces of the shape, each over its share of the segment's duration."""
        form = shape_of(self, waypoints)
        lengths = durations[form.segment] * form.share
        found = Trajectory(lengths, form.scaled, (form.degree,) * lengths.size)
        return Enclosed(found, value_errors(found, form.error))

    def motion_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """`segment_peaks`, which is all that a batch needs; shape (segments, 3, joints)."""
        return segment_peaks(self, waypoints).transpose(0, 2, 1)

    def batch_peaks(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """True peaks by one division a segment."""
        return self._stretched_peaks(values, as_batch(self, durations), wanted)

    def batch_sides(
        self,
        waypoints: Array,
        durations: Array,
        wanted: NDArray[np.bool_],
        nodal: Array | None = None,
    ) -> Array:
        """True peaks to each side by one division a segment."""
        h = as_batch(self, durations)
        sides = zip(segment_sides(self, waypoints).transpose(0, 1, 3, 2), wanted, strict=True)
        return np.stack([self._stretched_peaks(values, h, part) for values, part in sides])

    def _stretched_peaks(self, values: Array, h: Array, wanted: NDArray[np.bool_]) -> Array:
        valid = np.asarray((np.isfinite(h) & (h > 0)).all(axis=1))
        rate = 1.0 / np.where(valid[:, None], h, 1.0)
        peaks = np.zeros((h.shape[0], values.shape[2], 3))
        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(self.segments):
                for r in range(3):
                    scale = rate[:, k] ** (r + 1)
                    np.fmax(peaks[:, :, r], scale[:, None] * values[k, r], out=peaks[:, :, r])
        peaks[:, ~wanted] = 0.0
        peaks[~valid] = np.inf
        return peaks

    def range_values(self, waypoints: Array, nodal: Array | None = None) -> Array:
        """`path_ranges`, which is all that a batch needs."""
        return path_ranges(self, waypoints)

    def batch_ranges(self, values: Array, durations: Array, wanted: NDArray[np.bool_]) -> Array:
        """The path's own for every vector that is positive and finite."""
        h = as_batch(self, durations)
        valid = np.asarray((np.isfinite(h) & (h > 0)).all(axis=1))
        return ranges_where(valid, values, wanted)

    def value_gradients(
        self,
        waypoints: Array,
        durations: Array,
        points: list[Extremum],
        nodal: Array | None = None,
    ) -> PeakGradients:
        """Gradients of D/hʳ, which only the segment's own duration h enters."""
        form = shape_of(self, waypoints)
        by_duration = np.zeros((len(points), self.segments))
        by_waypoint = np.empty((len(points), waypoints.shape[0]))
        for i, (e, row) in enumerate(zip(points, rows_at(points), strict=True)):
            k = form.segment[e.segment]
            scale = (durations[k] * form.share[e.segment]) ** e.order
            by_duration[i, k] = -e.order * e.value / durations[k]
            by_waypoint[i] = row / scale @ form.by_waypoint[e.joint, e.segment]
        return PeakGradients(by_duration, by_waypoint, np.empty((len(points), 0)))
