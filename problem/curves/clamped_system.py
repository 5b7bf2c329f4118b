"""The linear system of a clamped B-spline, and its polynomial pieces with an error bound."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import CurveError
from .clamped_declaration import ClampedDeclaration
from .clamped_knots import inside_support
from .polynomials import PERM
from .refined import contained

Numbers = NDArray[Any]
EPS = np.finfo(np.float64).eps
"""Spacing of float64 at 1: twice the unit roundoff, so that bounds have room."""


def span_bases(knots: Numbers, degree: int, sign: int = -1) -> Numbers:
    """Powers of the basis functions on every span, shape (..., pieces, functions, powers).

    Cox–de Boor (2) on polynomials in the span's own 0..1, for all spans and knot vectors (last
    axis) at once and any kind of number. With ``sign`` + the terms are added instead, which bounds
    their sizes.
    """
    p = degree
    pieces = knots.shape[-1] - 2 * p - 1
    at = p + np.arange(pieces)
    start = knots[..., at]
    width = (knots[..., at + 1] - start)[..., None]
    bases = np.zeros((*knots.shape[:-1], pieces, p + 1, p + 1), dtype=knots.dtype)
    bases[..., 0, 0] = 1
    for q in range(1, p + 1):
        raised = np.zeros_like(bases)
        for a in range(q):
            left, right = knots[..., at - q + 1 + a], knots[..., at + 1 + a]
            c = bases[..., a, :q] / (right - left)[..., None]
            raised[..., a + 1, :q] += (start - left)[..., None] * c
            raised[..., a + 1, 1 : q + 1] += width * c
            raised[..., a, :q] += (right - start)[..., None] * c
            raised[..., a, 1 : q + 1] += sign * width * c
        bases = raised
    return bases


def places_on(knots: Numbers, degree: int, sites: Numbers) -> tuple[NDArray[np.int64], Numbers]:
    """Span of each site, and where in it; both along the last axis."""
    p = degree
    inner = np.asarray(knots.real[..., p : knots.shape[-1] - p], dtype=np.float64)
    passed = inner[..., None, :] <= np.asarray(sites.real, dtype=np.float64)[..., None]
    span = np.clip(passed.sum(axis=-1) - 1, 0, inner.shape[-1] - 2)
    low, high = (np.take_along_axis(knots, p + span + i, axis=-1) for i in (0, 1))
    return span, np.asarray((sites - low) / (high - low))


def conditions_at(
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


def knot_vector(inner: Numbers, end: Numbers, degree: int) -> Numbers:
    """All knots, from the inner ones and the last, (..., 1), along the last axis."""
    repeats = [1] * (inner.ndim - 1) + [degree + 1]
    return np.concatenate([0 * np.tile(end, repeats), inner, np.tile(end, repeats)], axis=-1)


def all_sites(sites: Array, end_orders: tuple[int, ...]) -> Array:
    """Sites with both ends as often as something is asked there, along the last axis."""
    repeats = [1] * (sites.ndim - 1) + [len(end_orders)]
    start, end = np.tile(sites[..., :1], repeats), np.tile(sites[..., -1:], repeats)
    return np.concatenate([start, sites, end], axis=-1)


@dataclass(frozen=True, eq=False)
class Spline:
    """Polynomial pieces of the joints that share one knot vector.

    Attributes
    ----------
    knots : ndarray, shape (pieces + 1,)
        Where the pieces meet, without repetition.
    scaled, error : ndarray, shape (pieces, degree + 1, joints)
        Ascending coefficients in the piece's own 0..1, and a bound on their error.
    by_waypoint : ndarray, shape (pieces, degree + 1, way-points)
        Their derivatives by the way-points.
    control : ndarray, shape (control points, joints)
    """

    knots: Numbers
    scaled: Numbers
    error: Array
    by_waypoint: Numbers
    control: Numbers


def interpolated(
    curve: ClampedDeclaration, sites: Numbers, inner: Numbers, waypoints: Numbers
) -> Spline:
    """Solve for the control points of the B-spline through the way-points at the sites.

    In extended precision where the sites are: an approximate inverse B of the system A in float64
    refines the solution, and (I − |BA − I|)⁻¹ |B| |residual| bounds its error, entry by entry.

    Raises
    ------
    CurveError
        If a site leaves the support of its basis function (Schoenberg and Whitney).
    """
    p = curve.degree
    knots = knot_vector(inner, sites[-1:], p)
    bases = span_bases(knots, p)
    span, place = places_on(knots, p, sites)
    matrix = conditions_at(bases, span, place, curve.end_orders)
    _schoenberg_whitney(curve, knots, sites)
    right = np.zeros((matrix.shape[0], waypoints.shape[1]), dtype=matrix.dtype)
    right[: sites.size] = waypoints
    index = np.arange(bases.shape[0])[:, None] + np.arange(p + 1)

    def powers(control: Numbers, of: Numbers) -> Numbers:
        return np.asarray(np.einsum("pam,paj->pmj", of, control[index]))

    inverse: Numbers
    if np.iscomplexobj(matrix):
        inverse = np.linalg.inv(matrix)
        return Spline(
            knots[p : knots.size - p],
            powers(inverse @ right, bases),
            np.empty(0),
            np.empty(0),
            inverse @ right,
        )
    narrow = matrix.astype(np.float64)
    try:
        inverse = np.linalg.inv(narrow)
    except np.linalg.LinAlgError:
        raise _not_passing(curve, sites, 0) from None
    control: Numbers = inverse @ right.astype(np.float64)
    for _ in range(2):
        control = control + inverse @ (right - matrix @ control).astype(np.float64)
    sizes = span_bases(knots, p, 1)
    absolute = np.abs(conditions_at(sizes, span, np.abs(place), curve.end_orders))
    gap = float(np.diff(knots[p : knots.size - p]).min() / sites[-1])
    # Knots carry a rounding of their own, which counts against the smallest gap between them.
    rounding = float(np.finfo(matrix.dtype).eps) * (4 * p + 12 + matrix.shape[0]) * (1 + 2 / gap)
    residual = np.abs(right - matrix @ control) + rounding * (
        absolute @ np.abs(control) + np.abs(right)
    )
    unsure = contained(inverse, narrow, residual.astype(np.float64))
    if unsure is None:
        raise _not_passing(curve, sites, 0)
    scaled = powers(control, bases)
    error = powers(unsure.astype(matrix.dtype), sizes) + rounding * powers(np.abs(control), sizes)
    rounded = np.asarray(scaled, dtype=np.float64)
    return Spline(
        np.asarray(knots[p : knots.size - p], dtype=np.float64),
        rounded,
        np.asarray(error, dtype=np.float64) + EPS * np.abs(rounded),
        np.asarray(powers(inverse[:, : sites.size].astype(matrix.dtype), bases), dtype=np.float64),
        np.asarray(control, dtype=np.float64),
    )


def _schoenberg_whitney(curve: ClampedDeclaration, knots: Numbers, sites: Numbers) -> None:
    u, x = (np.asarray(of.real, dtype=np.float64) for of in (knots, sites))
    inside = inside_support(u, all_sites(x, curve.end_orders), curve.degree)
    if not inside.all():
        raise _not_passing(curve, sites, int(np.argmin(inside)) - len(curve.end_orders))


def _not_passing(curve: ClampedDeclaration, sites: Numbers, waypoint: int) -> CurveError:
    k = min(max(waypoint, 0), curve.segments - 1)
    return CurveError(
        f"durations: no {curve.name} passes the way-points at these times (way-point {waypoint} "
        "lies outside the support of its basis function); bring the durations nearer to the "
        "proportions of the knots",
        k,
        0.0,
    )
