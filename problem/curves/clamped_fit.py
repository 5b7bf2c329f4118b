"""From a clamped B-spline's declaration to polynomial pieces between its knots."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .clamped_declaration import ClampedDeclaration, average_matrix, fractions_of
from .clamped_knots import inside_support
from .clamped_system import (
    EPS,
    Numbers,
    Spline,
    all_sites,
    conditions_at,
    interpolated,
    knot_vector,
    places_on,
    span_bases,
)
from .kind import STEP, Enclosed, Shape, are_durations, masked, value_errors
from .peak import Extremum, PeakGradients, rows_at
from .polynomials import MAX_COEFFICIENTS, derived, tops
from .trajectory import Trajectory

_SLIVER = 1e-12
"""Breaks nearer than this share of the whole differ by rounding alone."""
_RESOLVED = 1e13
"""Growth of control points over way-points beyond which float64 resolves nothing of them."""


def _times(durations: Numbers) -> Numbers:
    return np.concatenate([np.zeros(1, dtype=durations.dtype), np.cumsum(durations)])


def splines_of(curve: ClampedDeclaration, waypoints: Numbers, durations: Numbers) -> list[Spline]:
    """Splines of the joints in time: one for all, or one for each."""
    times = _times(durations)
    average = average_matrix(curve)
    fractions = fractions_of(curve, waypoints.real)
    if fractions is None:
        return [interpolated(curve, times, average @ times, waypoints)]
    rows = [average @ np.array(row) * times[-1] for row in fractions]
    if len(rows) == 1:
        return [interpolated(curve, times, rows[0], waypoints)]
    return [
        interpolated(curve, times, inner, waypoints[:, j : j + 1]) for j, inner in enumerate(rows)
    ]


def _cut(spline: Spline, breaks: Numbers) -> tuple[Numbers, Array, Numbers]:
    """Coefficients, errors and derivatives by way-points on finer pieces."""
    real = np.asarray(breaks.real, dtype=np.float64)
    own = np.asarray(spline.knots.real, dtype=np.float64)
    middle = 0.5 * (real[:-1] + real[1:])
    parent = np.clip(np.searchsorted(own, middle, side="right") - 1, 0, own.size - 2)
    width = spline.knots[parent + 1] - spline.knots[parent]
    low = (breaks[:-1] - spline.knots[parent]) / width
    high = (breaks[1:] - spline.knots[parent]) / width
    size = spline.scaled.shape[1]
    shift = np.zeros((middle.size, size, size), dtype=breaks.dtype)
    for m in range(size):
        for k in range(m, size):
            shift[:, m, k] = comb(k, m) * low ** (k - m) * (high - low) ** m
    moved = np.einsum("pmk,pkj->pmj", shift, spline.scaled[parent])
    if np.iscomplexobj(moved):
        return moved, np.empty(0), np.empty(0)
    error = np.einsum("pmk,pkj->pmj", np.abs(shift), spline.error[parent])
    error = error + 4 * size * EPS * np.einsum(
        "pmk,pkj->pmj", np.abs(shift), np.abs(spline.scaled[parent])
    )
    return moved, error, np.einsum("pmk,pkw->pmw", shift, spline.by_waypoint[parent])


@dataclass(frozen=True, eq=False)
class Pieces:
    """All joints on common pieces.

    ``breaks`` (pieces + 1,), ``scaled`` and ``error`` (pieces, 10, joints), ``by_waypoint``
    (joints, pieces, 10, way-points).
    """

    breaks: Numbers
    scaled: Numbers
    error: Array
    by_waypoint: Numbers


def _union(breaks: list[Numbers]) -> Numbers:
    """All breaks in order, those that differ by rounding only once.

    A sliver between two such breaks would be as long as its own rounding error, and a derivative
    divides by that; its polynomial is that of a neighbour up to the jump at one of its ends.
    """
    together = np.concatenate(breaks)
    together = together[np.argsort(together.real, kind="stable")]
    least = _SLIVER * float(together.real[-1] - together.real[0])
    keep = np.append(np.diff(together.real) > least, True)
    # The first break of all must stay, whatever follows it closely.
    kept = together[keep]
    kept[0] = together[0]
    return np.asarray(kept)


def _joined(splines: list[Spline], joints: int, cuts: Numbers | None = None) -> Pieces:
    """Common pieces of splines with different knots, also cut at ``cuts``."""
    parts = [s.knots for s in splines] + ([] if cuts is None else [cuts])
    if len(parts) == 1:
        breaks, cut = parts[0], [(s.scaled, s.error, s.by_waypoint) for s in splines]
    else:
        breaks = _union(parts)
        cut = [_cut(s, breaks) for s in splines]
    pieces, size = breaks.size - 1, cut[0][0].shape[1]
    scaled = np.zeros((pieces, MAX_COEFFICIENTS, joints), dtype=cut[0][0].dtype)
    scaled[:, :size] = np.concatenate([c[0] for c in cut], axis=2)
    if np.iscomplexobj(scaled):
        return Pieces(breaks, scaled, np.empty(0), np.empty(0))
    error = np.zeros(scaled.shape)
    error[:, :size] = np.concatenate([c[1] for c in cut], axis=2)
    waypoints = cut[0][2].shape[2]
    by_waypoint = np.zeros((len(cut), pieces, MAX_COEFFICIENTS, waypoints))
    by_waypoint[:, :, :size] = np.array([c[2] for c in cut])
    by_waypoint = np.broadcast_to(by_waypoint, (joints, *by_waypoint.shape[1:]))
    return Pieces(breaks, scaled, error, by_waypoint)


def _pieces(curve: ClampedDeclaration, waypoints: Array, durations: Numbers) -> Pieces:
    return _joined(splines_of(curve, waypoints, durations), waypoints.shape[1])


def clamped_shape(curve: ClampedDeclaration, waypoints: Array) -> Shape:
    """The curve in its parameter, every segment on an axis of its own."""
    fractions = fractions_of(curve, waypoints)
    assert fractions is not None
    average, joints = average_matrix(curve), waypoints.shape[1]
    wide = waypoints.astype(np.longdouble)
    # Every segment has its own 0..1 on the axis of e, so that joints with other parameters meet.
    axis = np.arange(curve.waypoints, dtype=np.longdouble)
    splines, groups = [], len(fractions)
    for g, row in enumerate(fractions):
        sites = np.array(row, dtype=np.longdouble)
        columns = slice(None) if groups == 1 else slice(g, g + 1)
        spline = interpolated(curve, sites, average @ sites, wide[:, columns])
        splines.append(_on_axis(spline, np.asarray(sites, dtype=np.float64)))
    found = _joined(splines, joints, axis.astype(np.float64))
    lengths = np.diff(found.breaks)
    middle = 0.5 * (found.breaks[:-1] + found.breaks[1:])
    return Shape(
        segment=np.asarray(middle, dtype=np.int64),
        share=np.asarray(lengths, dtype=np.float64),
        degree=curve.degree,
        scaled=np.asarray(found.scaled, dtype=np.float64),
        error=found.error,
        by_waypoint=np.asarray(found.by_waypoint, dtype=np.float64),
    )


def _on_axis(spline: Spline, sites: Array) -> Spline:
    """The spline cut at its sites, its parameter replaced by the segment's number plus 0..1."""
    breaks = _union([spline.knots, sites])
    scaled, error, by_waypoint = _cut(spline, breaks)
    mapped = np.interp(np.asarray(breaks, dtype=np.float64), sites, np.arange(sites.size))
    return Spline(mapped, scaled, error, by_waypoint, spline.control)


def clamped_enclosed(curve: ClampedDeclaration, waypoints: Array, durations: Array) -> Enclosed:
    """Trajectory with pieces between knots, and a bound on the error of every extremum."""
    wide = waypoints.astype(np.longdouble)
    found = _joined(splines_of(curve, wide, durations.astype(np.longdouble)), waypoints.shape[1])
    lengths = np.diff(np.asarray(found.breaks, dtype=np.float64))
    scaled = np.asarray(found.scaled, dtype=np.float64)
    trajectory = Trajectory(lengths, scaled, (curve.degree,) * lengths.size)
    return Enclosed(trajectory, value_errors(trajectory, found.error))


def clamped_gradients(
    curve: ClampedDeclaration, waypoints: Array, durations: Array, points: list[Extremum]
) -> PeakGradients:
    """Gradients of the values at fixed places: by complex steps in the durations."""
    found = _pieces(curve, waypoints, durations)
    lengths = np.diff(found.breaks)
    n = curve.segments
    by_duration = np.empty((len(points), n))
    by_waypoint = np.empty((len(points), curve.waypoints))
    rows = rows_at(points)
    for k in range(n):
        step = durations.astype(np.complex128)
        step[k] += 1j * STEP
        moved = _pieces(curve, waypoints, step)
        scaled, widths = moved.scaled.imag / STEP, np.diff(moved.breaks).imag / STEP
        for i, (e, row) in enumerate(zip(points, rows, strict=True)):
            change = row @ scaled[e.segment, :, e.joint] / lengths[e.segment] ** e.order
            fade = e.order * e.value * widths[e.segment] / lengths[e.segment]
            by_duration[i, k] = change - fade
    for i, (e, row) in enumerate(zip(points, rows, strict=True)):
        by_waypoint[i] = row @ found.by_waypoint[e.joint, e.segment] / lengths[e.segment] ** e.order
    return PeakGradients(by_duration, by_waypoint, np.empty((len(points), 0)))


def clamped_reach(
    curve: ClampedDeclaration,
    waypoints: Array,
    durations: Array,
    wanted: NDArray[np.bool_],
    sides: tuple[float, ...],
    least: int,
) -> Array:
    """`Curve.batch_reach` of a curve whose time is not stretched, for these way-points."""
    found = np.zeros((len(durations), len(sides), *wanted.shape))
    valid = are_durations(durations)
    h = np.where(valid[:, None], durations, 1.0)
    times = np.concatenate([np.zeros((len(h), 1)), np.cumsum(h, axis=1)], axis=1)
    average, fractions = average_matrix(curve), fractions_of(curve, waypoints)
    inner = [np.einsum("vw,iw->vi", times, average)]  # the same bits for any number of vectors
    if fractions is not None:
        inner = [times[:, -1:] * (average @ np.array(row)) for row in fractions]
    for own, place in zip(np.array_split(np.arange(len(wanted)), len(inner)), inner, strict=True):
        knots = knot_vector(place, times[:, -1:], curve.degree)
        asked = all_sites(times, curve.end_orders)
        valid &= inside_support(knots, asked, curve.degree).all(axis=1)
        valid &= (np.diff(knots[:, curve.degree : -curve.degree], axis=1) > 0.0).all(axis=1)
        at = np.flatnonzero(valid)
        q = waypoints[:, own] - waypoints[0, own]
        a, widths, regular = _polynomials(curve, q, times[at], knots[at])
        valid[at] = regular
        for i in np.flatnonzero(wanted[own].any(axis=0)).tolist():
            part = derived(a, least + i) / widths[:, :, None] ** (least + i)
            for side, sign in enumerate(sides):
                found[at[regular, None], side, own, i] = tops(part, sign)
    return masked(found, wanted, valid)


def _polynomials(
    curve: ClampedDeclaration, waypoints: Array, times: Array, knots: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Coefficients (powers, vectors, pieces, joints) and widths of pieces where there is a curve.

    Beside them which of the vectors have one: a system whose solution is larger than its data by
    what float64 resolves has none.
    """
    p = curve.degree
    bases = span_bases(knots, p)
    matrix = conditions_at(bases, *places_on(knots, p, times), curve.end_orders)
    right = np.zeros((matrix.shape[-1], waypoints.shape[1]))
    right[: len(waypoints)] = waypoints
    regular = np.asarray(np.linalg.slogdet(matrix)[0] != 0.0)
    control = np.linalg.solve(matrix[regular], right[None])
    held = np.abs(control).max(axis=(1, 2)) <= _RESOLVED * np.abs(waypoints).max()
    regular[regular] = held
    window = np.arange(bases.shape[1])[:, None] + np.arange(p + 1)
    a = np.einsum("vpam,vpaj->mvpj", bases[regular], control[held][:, window])
    return a, np.diff(knots[regular, p : knots.shape[1] - p], axis=1), regular
