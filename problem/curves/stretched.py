"""Curves of a fixed shape in a parameter, each segment stretched linearly in time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import TrajgapError
from ..limits import QUANTITIES
from . import kernel
from . import kind as kinds
from .kind import Curve, Enclosed, PeakGradients, derivative_row, value_errors
from .peak import Extremum, critical_points
from .spline import as_durations, trajectory_from_scaled
from .trajectory import Trajectory
from .uniform import StretchedUniformBSpline, shape_matrix


@dataclass(frozen=True, eq=False)
class Shape:
    """A curve in its parameter, cut into polynomial pieces, before time enters.

    Attributes
    ----------
    segment : ndarray of int, shape (pieces,)
        Segment that a piece belongs to.
    share : ndarray, shape (pieces,)
        Part of the segment's duration that it takes.
    degree : int
    scaled, error : ndarray, shape (pieces, 10, joints)
        Ascending coefficients in the piece's own 0..1, and a bound on their error.
    by_waypoint : ndarray, shape (joints, pieces, 10, way-points)
        Their derivatives by the joint's way-points.
    """

    segment: NDArray[np.int64]
    share: Array
    degree: int
    scaled: Array
    error: Array
    by_waypoint: Array


@singledispatch
def shape(curve: Curve, waypoints: Array) -> Shape:
    """The curve in its parameter, with a bound on rounding errors."""
    raise TypeError(type(curve).__name__)


@shape.register
def _(curve: StretchedUniformBSpline, waypoints: Array) -> Shape:
    matrix = shape_matrix(curve.waypoints)
    n, joints = curve.segments, waypoints.shape[1]
    wide = waypoints.astype(np.longdouble)
    exact = matrix @ wide
    epsilon = np.finfo(np.longdouble).eps * (curve.waypoints + 4)
    scaled, error = np.zeros((2, n, kernel.MAX_COEFFICIENTS, joints))
    scaled[:, :4] = exact
    error[:, :4] = epsilon * (np.abs(matrix) @ np.abs(wide))
    error += np.finfo(np.float64).eps * np.abs(scaled)
    by_waypoint = np.zeros((n, kernel.MAX_COEFFICIENTS, curve.waypoints))
    by_waypoint[:, :4] = matrix
    return Shape(
        segment=np.arange(n),
        share=np.ones(n),
        degree=3,
        scaled=scaled,
        error=error,
        by_waypoint=np.broadcast_to(by_waypoint, (joints, *by_waypoint.shape)),
    )


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
    q = as_waypoints(curve, waypoints)
    form = shape(curve, q - q[0])
    peaks = np.zeros((curve.segments, q.shape[1], 3))
    for p, k in enumerate(form.segment):
        for j in range(q.shape[1]):
            a = form.scaled[p, : form.degree + 1, j]
            for r in range(min(3, form.degree)):
                a = a[1:] * np.arange(1, a.size) / form.share[p]
                places = np.concatenate([[0.0], critical_points(a), [1.0]])
                top = float(np.abs(np.polynomial.polynomial.polyval(places, a)).max())
                peaks[k, j, r] = max(peaks[k, j, r], top)
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


def as_waypoints(curve: Curve, waypoints: ArrayLike) -> Array:
    """Way-points as a float64 array of the right number of rows, or a clear refusal."""
    q = np.asarray(waypoints, dtype=np.float64)
    wanted = len(curve.waypoint_breaks)
    if q.ndim != 2 or q.shape[0] != wanted:
        raise TrajgapError(
            f"waypoints: {curve.name} with {curve.segments} segments needs {wanted} rows, "
            f"got shape {q.shape}"
        )
    return q


def stretched_enclosed(curve: Curve, waypoints: Array, durations: Array) -> Enclosed:
    """`enclosed` of a stretched curve."""
    form = shape(curve, waypoints)
    lengths = durations[form.segment] * form.share
    found = trajectory_from_scaled(form.scaled, (form.degree,) * lengths.size, lengths)
    return Enclosed(found, value_errors(found, form.error))


def stretched_values(curve: Curve, waypoints: Array) -> Array:
    """`segment_peaks`, which is all that a batch needs; shape (segments, 3, joints)."""
    return segment_peaks(curve, waypoints).transpose(0, 2, 1)


def stretched_peaks(
    curve: Curve, values: Array, durations: Array, wanted: NDArray[np.bool_]
) -> Array:
    """`batch_peaks` of a stretched curve: one division a segment."""
    h = np.asarray(durations, dtype=np.float64)
    if h.ndim != 2 or h.shape[1] != curve.segments:
        raise TrajgapError(
            f"durations: a batch has shape (vectors, {curve.segments}), got {h.shape}"
        )
    valid = np.asarray((np.isfinite(h) & (h > 0)).all(axis=1))
    rate = 1.0 / np.where(valid[:, None], h, 1.0)
    peaks = np.zeros((h.shape[0], values.shape[2], 3))
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(curve.segments):
            for r in range(3):
                scale = rate[:, k] ** (r + 1)
                np.fmax(peaks[:, :, r], scale[:, None] * values[k, r], out=peaks[:, :, r])
    peaks[:, ~wanted] = 0.0
    peaks[~valid] = np.inf
    return peaks


def stretched_gradients(
    curve: Curve, waypoints: Array, durations: Array, points: list[Extremum]
) -> PeakGradients:
    """`value_gradients` of a stretched curve."""
    form = shape(curve, waypoints)
    by_duration = np.zeros((len(points), curve.segments))
    by_waypoint = np.empty((len(points), waypoints.shape[0]))
    for i, e in enumerate(points):
        k = form.segment[e.segment]
        scale = (durations[k] * form.share[e.segment]) ** e.order
        by_duration[i, k] = -e.order * e.value / durations[k]
        row = derivative_row(e.s, e.order) / scale
        by_waypoint[i] = row @ form.by_waypoint[e.joint, e.segment]
    return PeakGradients(by_duration, by_waypoint, np.empty((len(points), 0)))


@kinds.fit.register
def _(
    curve: StretchedUniformBSpline,
    waypoints: ArrayLike,
    durations: ArrayLike,
    nodal: ArrayLike | None = None,
) -> Trajectory:
    q = as_waypoints(curve, waypoints)
    return stretched_enclosed(curve, q, as_durations(durations, curve.segments)).trajectory


@kinds.enclosed.register
def _(
    curve: StretchedUniformBSpline, waypoints: Array, durations: Array, nodal: Array | None = None
) -> Enclosed:
    return stretched_enclosed(curve, waypoints, durations)


@kinds.motion_values.register
def _(curve: StretchedUniformBSpline, waypoints: Array, nodal: Array | None = None) -> Array:
    return stretched_values(curve, waypoints)


@kinds.batch_peaks.register
def _(
    curve: StretchedUniformBSpline, values: Array, durations: Array, wanted: NDArray[np.bool_]
) -> Array:
    return stretched_peaks(curve, values, durations, wanted)


@kinds.value_gradients.register
def _(
    curve: StretchedUniformBSpline,
    waypoints: Array,
    durations: Array,
    points: list[Extremum],
    nodal: Array | None = None,
) -> PeakGradients:
    return stretched_gradients(curve, waypoints, durations, points)
