"""From a clamped B-spline's declaration to bounded polynomial pieces between its knots."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import comb

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import CurveError
from .adjoint import places_of
from .clamped_declaration import ClampedDeclaration, average_matrix, fractions_of, inside_support
from .kind import STEP, Asked, Enclosed, Shape, are_durations, masked, value_errors
from .peak import Extremum
from .polynomials import MAX_COEFFICIENTS, PERM, Numbers, derivative_rows, derived, tops
from .refined import contained
from .trajectory import Trajectory

_EPS = np.finfo(np.float64).eps
"""Spacing of float64 at 1: twice the unit roundoff, so bounds have room."""
_SLIVER = 1e-12
"""Breaks nearer than this share of the whole differ by rounding alone."""
_RESOLVED = 1e13
"""Growth of control points over way-points beyond which float64 resolves nothing of them."""


@dataclass(frozen=True, eq=False)
class Spline:
    """Polynomial pieces of joints that share their breaks.

    Attributes
    ----------
    breaks : ndarray, shape (pieces + 1,)
        Where the pieces meet, without repetition.
    scaled, error : ndarray, shape (pieces, powers, joints)
        Ascending coefficients in the piece's own 0..1, and a bound on their error.
    """

    breaks: Array
    scaled: Array
    error: Array

    @property
    def lengths(self) -> Array:
        """Of the pieces."""
        return np.diff(self.breaks)


def _span_bases(knots: Numbers, degree: int, sign: int = -1) -> Numbers:
    """Powers of the basis functions on every span, shape (..., pieces, functions, powers).

    Cox–de Boor (2) on polynomials in the span's own 0..1, for all spans and knot vectors (last
    axis) at once and any kind of number. With ``sign`` + the terms are added instead, which bounds
    their sizes.
    """
    p = degree
    pieces = knots.shape[-1] - 2 * p - 1
    at = p + np.arange(pieces)
    start = knots[..., at, None, None]
    width = knots[..., at + 1, None, None] - start
    bases = np.zeros((*knots.shape[:-1], pieces, p + 1, p + 1), dtype=knots.dtype)
    bases[..., 0, 0] = 1
    for q in range(1, p + 1):
        among = at[:, None] + np.arange(1, q + 1)
        left, right = knots[..., among - q, None], knots[..., among, None]
        c = bases[..., :q, :q] / (right - left)
        raised = np.zeros_like(bases)
        raised[..., 1 : q + 1, :q] += (start - left) * c
        raised[..., 1 : q + 1, 1 : q + 1] += width * c
        raised[..., :q, :q] += (right - start) * c
        raised[..., :q, 1 : q + 1] += sign * width * c
        bases = raised
    return bases


def _places_on(knots: Numbers, degree: int, sites: Numbers) -> tuple[NDArray[np.int64], Numbers]:
    """Span of each site, and where in it; both along the last axis."""
    p = degree
    inner = np.asarray(knots.real[..., p : knots.shape[-1] - p], dtype=np.float64)
    passed = inner[..., None, :] <= np.asarray(sites.real, dtype=np.float64)[..., None]
    span = np.clip(passed.sum(axis=-1) - 1, 0, inner.shape[-1] - 2)
    low, high = (np.take_along_axis(knots, p + span + i, axis=-1) for i in (0, 1))
    return span, np.asarray((sites - low) / (high - low))


def _conditions_at(
    bases: Numbers, span: NDArray[np.int64], place: Numbers, end_orders: tuple[int, ...]
) -> Numbers:
    """Conditions (3) at the sites and of the ends on the control points, one row each."""
    (*lead, pieces, functions, _), sites = bases.shape, span.shape[-1]
    size = (*lead, sites + 2 * len(end_orders), pieces + functions - 1)
    matrix, every = np.zeros(size, bases.dtype), np.arange(functions)
    own = np.take_along_axis(bases, span[..., None, None], axis=-3)
    values = (own @ (place[..., None] ** every)[..., None])[..., 0]
    np.put_along_axis(matrix[..., :sites, :], span[..., None] + every, values, axis=-1)
    for i, r in enumerate(end_orders):
        row = sites + 2 * i
        # Scaled by the span's width to the order, which does not matter for a derivative of 0.
        matrix[..., row, :functions] = bases[..., 0, :, r]
        matrix[..., row + 1, pieces - 1 :] = bases[..., -1, :, :] @ PERM[:functions, r]
    return matrix


def _with_ends(inner: Numbers, start: Numbers, end: Numbers, times: int) -> Numbers:
    """Numbers with both ends, (..., 1), so many times before and after; along the last axis."""
    repeats = [1] * (inner.ndim - 1) + [times]
    return np.concatenate([np.tile(start, repeats), inner, np.tile(end, repeats)], axis=-1)


def _knots(inner: Numbers, end: Numbers, degree: int) -> Numbers:
    """All knots, from the inner ones and the last, (..., 1)."""
    return _with_ends(inner, 0 * end, end, degree + 1)


def _inside(curve: ClampedDeclaration, knots: Array, sites: Array) -> NDArray[np.bool_]:
    """Which way-points, ends as often as something is asked there, Schoenberg and Whitney allow."""
    asked = _with_ends(sites, sites[..., :1], sites[..., -1:], len(curve.end_orders))
    return inside_support(knots, asked, curve.degree)


def _interpolated(
    curve: ClampedDeclaration, sites: Numbers, knots: Numbers, waypoints: Numbers
) -> Spline:
    """Solve for the control points of the B-spline through the way-points at the sites.

    In extended precision where the sites are: an approximate inverse B of the system A in float64
    refines the solution, and (I − |BA − I|)⁻¹ |B| |residual| bounds its error, entry by entry.
    """
    p, bases = curve.degree, _span_bases(knots, curve.degree)
    span, place = _places_on(knots, p, sites)
    matrix = _conditions_at(bases, span, place, curve.end_orders)
    inside = _inside(curve, *(of.astype(np.float64) for of in (knots, sites)))
    if not inside.all():
        raise _not_passing(curve, int(np.argmin(inside)) - len(curve.end_orders))
    right = np.zeros((matrix.shape[0], waypoints.shape[1]), dtype=matrix.dtype)
    right[: sites.size] = waypoints
    index = np.arange(bases.shape[0])[:, None] + np.arange(p + 1)
    breaks = knots[p : knots.size - p]

    def powers(control: Numbers, of: Numbers) -> Numbers:
        return np.asarray(np.einsum("pam,paj->pmj", of, control[index]))

    narrow = matrix.astype(np.float64)
    try:
        inverse = np.linalg.inv(narrow)
    except np.linalg.LinAlgError:
        raise _not_passing(curve, 0) from None
    control: Numbers = inverse @ right.astype(np.float64)
    for _ in range(2):
        control = control + inverse @ (right - matrix @ control).astype(np.float64)
    sizes = _span_bases(knots, p, 1)
    absolute = np.abs(_conditions_at(sizes, span, np.abs(place), curve.end_orders))
    gap = float(np.diff(breaks).min() / sites[-1])
    # Knots carry a rounding of their own, which counts against the smallest gap between them.
    rounding = float(np.finfo(matrix.dtype).eps) * (4 * p + 12 + matrix.shape[0]) * (1 + 2 / gap)
    residual = np.abs(right - matrix @ control) + rounding * (
        absolute @ np.abs(control) + np.abs(right)
    )
    unsure = contained(inverse, narrow, residual.astype(np.float64))
    if unsure is None:
        raise _not_passing(curve, 0)
    scaled = powers(control, bases)
    error = powers(unsure.astype(matrix.dtype), sizes) + rounding * powers(np.abs(control), sizes)
    scaled, error = (np.asarray(one, dtype=np.float64) for one in (scaled, error))
    return Spline(breaks.astype(np.float64), scaled, error + _EPS * np.abs(scaled))


def _not_passing(curve: ClampedDeclaration, waypoint: int) -> CurveError:
    at = min(max(waypoint, 0), curve.segments)
    return CurveError(
        f"durations: no {curve.name} passes the way-points at these times (way-point {at + 1} "
        "lies outside the support of its basis function); bring the durations nearer to the "
        "proportions of the knots",
        min(at, curve.segments - 1),
        0.0,
    )


def splines_of(curve: ClampedDeclaration, waypoints: Numbers, durations: Numbers) -> list[Spline]:
    """Splines of the joints in time: one for all, or one for each, between its own knots.

    Raises
    ------
    CurveError
        If no such curve passes the way-points at these times.
    """
    times, groups = _knots_of(curve, waypoints, durations[None])
    return [_interpolated(curve, times[0], knots[0], waypoints[:, own]) for own, knots in groups]


def _parents(own: Array, breaks: Array) -> NDArray[np.int64]:
    """Which of its own pieces each of the finer ones lies on."""
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    return np.clip(np.searchsorted(own, middle, side="right") - 1, 0, own.size - 2)


def _cut(spline: Spline, breaks: Array) -> Spline:
    """The same on finer pieces."""
    knots, parent = spline.breaks, _parents(spline.breaks, breaks)
    width = knots[parent + 1] - knots[parent]
    low = (breaks[:-1] - knots[parent]) / width
    high = (breaks[1:] - knots[parent]) / width
    size = spline.scaled.shape[1]
    shift = np.zeros((parent.size, size, size))
    for m in range(size):
        for k in range(m, size):
            shift[:, m, k] = comb(k, m) * low ** (k - m) * (high - low) ** m
    sizes = spline.error[parent] + 4 * size * _EPS * np.abs(spline.scaled[parent])
    return Spline(breaks, shift @ spline.scaled[parent], np.abs(shift) @ sizes)


def _union(breaks: list[Array]) -> Array:
    """All breaks in order, those that differ by rounding only once.

    A sliver between two such breaks would be as long as its own rounding error, and a derivative
    divides by that; its polynomial is that of a neighbour up to the jump at one of its ends.
    """
    together = np.sort(np.concatenate(breaks))
    keep = np.append(np.diff(together) > _SLIVER * (together[-1] - together[0]), True)
    # The first break of all must stay, whatever follows it closely.
    kept = together[keep]
    kept[0] = together[0]
    return np.asarray(kept)


def _joined(splines: list[Spline], cuts: tuple[Array, ...] = ()) -> Spline:
    """All joints on common pieces, also cut at ``cuts``, with ten coefficients each."""
    if len(splines) > 1 or cuts:
        breaks = _union([*(s.breaks for s in splines), *cuts])
        splines = [_cut(s, breaks) for s in splines]
    first, size = splines[0], splines[0].scaled.shape[1]
    scaled, error = np.zeros(
        (2, first.lengths.size, MAX_COEFFICIENTS, sum(s.scaled.shape[2] for s in splines))
    )
    scaled[:, :size] = np.concatenate([s.scaled for s in splines], axis=2)
    error[:, :size] = np.concatenate([s.error for s in splines], axis=2)
    return Spline(first.breaks, scaled, error)


def clamped_shape(curve: ClampedDeclaration, waypoints: Array) -> Shape:
    """The curve in its parameter, every segment on an axis of its own."""
    fractions = fractions_of(curve, waypoints)
    assert fractions is not None
    average, wide = average_matrix(curve), waypoints.astype(np.longdouble)
    groups = np.array_split(np.arange(waypoints.shape[1]), len(fractions))
    splines = []
    for row, own in zip(fractions, groups, strict=True):
        sites = np.array(row, dtype=np.longdouble)
        knots = _knots(average @ sites, sites[-1:], curve.degree)
        spline = _interpolated(curve, sites, knots, wide[:, own])
        splines.append(_on_axis(spline, np.asarray(sites, dtype=np.float64)))
    found = _joined(splines, (np.arange(curve.waypoints, dtype=np.float64),))
    return Shape(
        segment=(0.5 * (found.breaks[:-1] + found.breaks[1:])).astype(np.int64),
        share=found.lengths,
        degree=curve.degree,
        scaled=found.scaled,
        error=found.error,
    )


def _on_axis(spline: Spline, sites: Array) -> Spline:
    """The spline cut at its sites, its parameter replaced by the segment's number plus 0..1.

    So joints with other parameters meet.
    """
    cut = _cut(spline, _union([spline.breaks, sites]))
    return replace(cut, breaks=np.interp(cut.breaks, sites, np.arange(sites.size)))


def clamped_enclosed(curve: ClampedDeclaration, waypoints: Array, durations: Array) -> Enclosed:
    """Trajectory with pieces between knots, and a bound on the error of every extremum."""
    wide, long = waypoints.astype(np.longdouble), durations.astype(np.longdouble)
    found = _joined(splines_of(curve, wide, long))
    degrees = (curve.degree,) * found.lengths.size
    trajectory = Trajectory(found.lengths, found.scaled, degrees)
    return Enclosed(trajectory, lambda: value_errors(trajectory, found.error))


def _knots_of(
    curve: ClampedDeclaration, waypoints: Array, durations: Numbers
) -> tuple[Numbers, list[tuple[NDArray[np.int64], Numbers]]]:
    """Times of the way-points of many duration vectors, and the knots of joints that share them."""
    start = np.zeros((len(durations), 1), durations.dtype)
    times = np.concatenate([start, np.cumsum(durations, axis=1)], axis=1)
    average, fractions = average_matrix(curve), fractions_of(curve, waypoints)
    inner = [np.einsum("vw,iw->vi", times, average)]  # the same bits for any number of vectors
    if fractions is not None:
        inner = [times[:, -1:] * (average @ np.array(row)) for row in fractions]
    joints = np.array_split(np.arange(waypoints.shape[1]), len(inner))
    knots = [_knots(place, times[:, -1:], curve.degree) for place in inner]
    return times, list(zip(joints, knots, strict=True))


def clamped_by_durations(
    curve: ClampedDeclaration, waypoints: Array, durations: Array, points: list[Extremum]
) -> Array:
    """`Curve.by_durations` of a curve whose time is not stretched, by complex steps.

    Joints with knots of their own have them at fixed shares of the total, so a place that stays
    where it is on common pieces does so on theirs.
    """
    at, found, p = places_of(points), np.empty((len(points), curve.segments)), curve.degree
    times, groups = _knots_of(curve, waypoints, durations + 1j * STEP * np.eye(curve.segments))
    every = [knots[0, p : knots.shape[1] - p].real for _, knots in groups]
    breaks = every[0] if len(every) == 1 else _union(every)
    time = breaks[at.segment] + at.s * np.diff(breaks)[at.segment]
    for (own, knots), inner in zip(groups, every, strict=True):
        a, widths, _ = _polynomials(curve, waypoints[:, own], times, knots)
        mine = np.isin(at.joint, own)
        piece, order = _parents(inner, breaks)[at.segment[mine]], at.order[mine]
        rows = derivative_rows((time[mine] - inner[piece]) / np.diff(inner)[piece], order)
        part = a[:, :, piece, at.joint[mine] - own[0]]
        values = np.einsum("mvi,im->vi", part, rows[:, : p + 1]) / widths[:, piece] ** order
        found[mine] = values.imag.T / STEP
    return found


def clamped_reach(
    curve: ClampedDeclaration, waypoints: Array, durations: Array, asked: Asked
) -> Array:
    """`Curve.batch_reach` of a curve whose time is not stretched, for these way-points."""
    found, wanted, least = asked.room(len(durations)), asked.wanted, asked.least
    valid = are_durations(durations)
    times, groups = _knots_of(curve, waypoints, np.where(valid[:, None], durations, 1.0))
    for own, knots in groups:
        valid &= _inside(curve, knots, times).all(axis=1)
        valid &= (np.diff(knots[:, curve.degree : -curve.degree], axis=1) > 0.0).all(axis=1)
        at = np.flatnonzero(valid)
        q = waypoints[:, own] - waypoints[0, own]
        a, widths, regular = _polynomials(curve, q, times[at], knots[at])
        valid[at] = regular
        for i in np.flatnonzero(wanted[own].any(axis=0)).tolist():
            part = derived(a, least + i) / widths[:, :, None] ** (least + i)
            caps = None if asked.caps is None else asked.caps[own, i]
            for side, sign in enumerate(asked.sides):
                found[at[regular, None], side, own, i] = tops(part, sign, caps=caps)
    return masked(found, asked, valid)


def _polynomials(
    curve: ClampedDeclaration, waypoints: Array, times: Numbers, knots: Numbers
) -> tuple[Numbers, Numbers, NDArray[np.bool_]]:
    """Coefficients (powers, vectors, pieces, joints) and widths of pieces where there is a curve.

    Beside them which of the vectors have one: a system whose solution is larger than its data by
    what float64 resolves has none.
    """
    p = curve.degree
    bases = _span_bases(knots, p)
    matrix = _conditions_at(bases, *_places_on(knots, p, times), curve.end_orders)
    right = np.zeros((matrix.shape[-1], waypoints.shape[1]))
    right[: len(waypoints)] = waypoints
    regular = np.asarray(np.linalg.slogdet(matrix)[0] != 0.0)
    control = np.linalg.solve(matrix[regular], right[None])
    held = np.abs(control).max(axis=(1, 2)) <= _RESOLVED * np.abs(waypoints).max()
    regular[regular] = held
    window = np.arange(bases.shape[1])[:, None] + np.arange(p + 1)
    a = np.einsum("vpam,vpaj->mvpj", bases[regular], control[held][:, window])
    return a, np.diff(knots[regular, p : knots.shape[1] - p], axis=1), regular
