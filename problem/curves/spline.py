"""From a declaration, way-points and durations to coefficients, and their derivatives."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PPoly

from ..arrays import Array
from ..errors import TrajgapError
from . import kernel
from .interpolant import ConditionKind, Interpolant
from .trajectory import Trajectory

PERM = np.array(
    [[float(math.perm(p, r)) for r in range(kernel.MAX_COEFFICIENTS)] for p in range(10)]
)
_THREAD_WORK = 4000
_LONGEST = 1e30


@dataclass(frozen=True, eq=False)
class Layout:
    """The rows of a determined declaration as arrays, with the numbering of the unknowns."""

    kinds: NDArray[np.int64]
    breaks: NDArray[np.int64]
    orders: NDArray[np.int64]
    degrees: NDArray[np.int64]
    column: NDArray[np.int64]
    unknowns: int
    lower: int
    upper: int
    prescribed: Array
    waypoint: NDArray[np.int64]
    nodal: NDArray[np.int64]


@lru_cache(maxsize=256)
def layout(interpolant: Interpolant) -> Layout:
    """Layout of ``interpolant``; its free derivatives, if any, become prescribed rows."""
    full = interpolant.completed() if interpolant.free else interpolant
    rows = full.rows
    n = full.segments
    column = np.full((n, kernel.MAX_COEFFICIENTS), -1, dtype=np.int64)
    given = {(r.at, r.order) for r in rows if r.kind == ConditionKind.RIGHT_VALUE}
    count = 0
    for k, d in enumerate(full.degrees):
        for p in range(d + 1):
            if (k, p) not in given:
                column[k, p] = count
                count += 1
    lower = upper = 0
    equations = [r for r in rows if r.kind != ConditionKind.RIGHT_VALUE]
    for e, row in enumerate(equations):
        k = row.at - 1
        touched = [column[k, p] for p in range(row.order, full.degrees[k] + 1)]
        if row.kind == ConditionKind.MATCH and row.order <= full.degrees[row.at]:
            touched.append(column[row.at, row.order])
        used = [c for c in touched if c >= 0]
        lower = max([lower, *(e - c for c in used)])
        upper = max([upper, *(c - e for c in used)])
    free = {key: i for i, key in enumerate(interpolant.free_derivatives)} if full.free == 0 else {}
    waypoint = {b: i for i, b in enumerate(interpolant.waypoint_breaks)}
    values = [dict(e) for e in full.prescribed]
    return Layout(
        kinds=np.array([r.kind for r in rows], dtype=np.int64),
        breaks=np.array([r.at for r in rows], dtype=np.int64),
        orders=np.array([r.order for r in rows], dtype=np.int64),
        degrees=np.array(full.degrees, dtype=np.int64),
        column=column,
        unknowns=count,
        lower=lower,
        upper=upper,
        prescribed=np.array(
            [0.0 if r.kind == ConditionKind.MATCH else values[r.at].get(r.order, 0.0) for r in rows]
        ),
        waypoint=np.array(
            [
                waypoint.get(r.at, -1) if r.order == 0 and r.kind != ConditionKind.MATCH else -1
                for r in rows
            ],
            dtype=np.int64,
        ),
        nodal=np.array(
            [free.get((r.at, r.order), -1) if r.kind != ConditionKind.MATCH else -1 for r in rows],
            dtype=np.int64,
        ),
    )


def right_hand_sides(interpolant: Interpolant, waypoints: Array, nodal: Array | None) -> Array:
    """Values of the rows, shape (rows, joints): way-points, prescribed and free derivatives."""
    plan = layout(interpolant)
    joints = waypoints.shape[1]
    if waypoints.shape[0] != len(interpolant.waypoint_breaks):
        raise TrajgapError(
            f"waypoints: {interpolant.name} with {interpolant.segments} segments needs "
            f"{len(interpolant.waypoint_breaks)}, got {waypoints.shape[0]}"
        )
    if interpolant.free and (nodal is None or nodal.shape != (interpolant.free, joints)):
        raise TrajgapError(
            f"interpolant {interpolant.name}: {interpolant.conditions} conditions on "
            f"{interpolant.coefficients} coefficients; give nodal derivatives of shape "
            f"({interpolant.free}, {joints}) or add conditions"
        )
    values = np.repeat(plan.prescribed[:, None], joints, axis=1)
    rows = plan.waypoint >= 0
    values[rows] = waypoints[plan.waypoint[rows]]
    if interpolant.free and nodal is not None:
        rows = plan.nodal >= 0
        values[rows] = nodal[plan.nodal[rows]]
    return values


def coefficients(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> Array:
    """Coefficients in the segments' own parameter s in [0, 1], shape (segments, 10, joints)."""
    plan = layout(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    joints = waypoints.shape[1]
    out = np.zeros((interpolant.segments, kernel.MAX_COEFFICIENTS, joints))
    kernel.fit_coefficients(
        np.ascontiguousarray(durations).reshape(-1, 1),
        1,
        values,
        plan.kinds,
        plan.breaks,
        plan.orders,
        plan.degrees,
        plan.column,
        plan.lower,
        plan.upper,
        PERM,
        np.empty((plan.unknowns, 2 * plan.lower + plan.upper + 1, 1)),
        np.empty((plan.unknowns, joints)),
        out,
    )
    if not np.isfinite(out).all():
        raise _singular(interpolant, durations)
    return out


def _singular(interpolant: Interpolant, durations: Array) -> TrajgapError:
    return TrajgapError(f"interpolant {interpolant.name}: singular for durations {durations} s")


def as_durations(durations: ArrayLike, segments: int) -> Array:
    """Duration vector as a clean float64 array, or a clear refusal.

    Raises
    ------
    TrajgapError
        On a wrong length, NaN, infinite, zero or negative entries, or such that powers overflow.
    """
    try:
        h = np.ascontiguousarray(durations, dtype=np.float64)
    except (TypeError, ValueError):
        raise TrajgapError("durations: not numbers; give seconds, one per segment") from None
    if h.shape != (segments,):
        raise TrajgapError(
            f"durations: expected {segments} (one per segment), got {h.size if h.ndim else 1}"
            + (f" in shape {h.shape}" if h.ndim > 1 else "")
        )
    if not np.isfinite(h).all() or (h <= 0).any():
        raise TrajgapError(f"durations: {h.tolist()} s must all be positive and finite")
    if h.min() < 1 / _LONGEST or h.max() > _LONGEST:
        raise TrajgapError(
            f"durations: {h.tolist()} s must all lie between {1 / _LONGEST:g} and {_LONGEST:g} s"
        )
    return h


def fit(
    interpolant: Interpolant,
    waypoints: ArrayLike,
    durations: ArrayLike,
    nodal: ArrayLike | None = None,
) -> Trajectory:
    """The trajectory that the declaration, the way-points and the durations determine.

    Parameters
    ----------
    interpolant : Interpolant
        Declaration.
    waypoints : array_like, shape (way-points, joints)
        Joint angles, rad.
    durations : array_like, shape (segments,)
        Segment durations, s.
    nodal : array_like, shape (free, joints), optional
        Values of ``interpolant.free_derivatives`` where the declaration leaves some open.

    Returns
    -------
    Trajectory

    Raises
    ------
    TrajgapError
        If shapes disagree, a duration is not positive, or the system is singular.
    """
    q = np.asarray(waypoints, dtype=np.float64)
    h = as_durations(durations, interpolant.segments)
    extra = None if nodal is None else np.asarray(nodal, dtype=np.float64)
    scaled = coefficients(interpolant, q, h, extra)
    return trajectory_from_scaled(scaled, interpolant.degrees, h)


def trajectory_from_scaled(scaled: Array, degrees: tuple[int, ...], durations: Array) -> Trajectory:
    """Trajectory over scipy's ``PPoly`` from coefficients in s, shape (segments, power, joints)."""
    top = max(degrees)
    powers = np.arange(top + 1)
    in_time = scaled[:, : top + 1] / (durations[:, None] ** powers)[:, :, None]
    breaks = np.concatenate([[0.0], np.cumsum(durations)])
    polynomial = PPoly(np.ascontiguousarray(in_time[:, ::-1].transpose(1, 0, 2)), breaks)
    return Trajectory(polynomial, durations, scaled, degrees)


def motion_values(
    interpolant: Interpolant,
    waypoints: Array,
    nodal: Array | None = None,
) -> Array:
    """`right_hand_sides` with positions counted from the first way-point, for `batch_peaks`.

    Derivatives do not depend on that shift; a joint that stands still gets exact zeros by it.
    """
    plan = layout(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    values[(plan.orders == 0) & (plan.kinds != ConditionKind.MATCH)] -= waypoints[0]
    return values


def batch_peaks(
    interpolant: Interpolant,
    values: Array,
    durations: Array,
    wanted: NDArray[np.bool_],
) -> Array:
    """True peaks of |v|, |a|, |j| for a batch of duration vectors.

    Parameters
    ----------
    interpolant : Interpolant
    values : ndarray, shape (rows, joints)
        From `motion_values`.
    durations : ndarray, shape (batch, segments)
        Durations, s; vectors that are not positive and finite give infinite peaks.
    wanted : ndarray of bool, shape (joints, 3)
        Which peaks are needed; the others are returned as 0.

    Returns
    -------
    ndarray, shape (batch, joints, 3)
        rad/s, rad/s², rad/s³; the same bits whatever the order, the size or the threads.
    """
    plan = layout(interpolant)
    h = np.ascontiguousarray(durations, dtype=np.float64)
    if h.ndim != 2 or h.shape[1] != interpolant.segments:
        raise TrajgapError(
            f"durations: a batch has shape (vectors, {interpolant.segments}), got {h.shape}"
        )
    peaks = np.empty((h.shape[0], values.shape[1], 3))

    def run(part: slice) -> None:
        kernel.batch_peaks(
            h[part],
            values,
            plan.kinds,
            plan.breaks,
            plan.orders,
            plan.degrees,
            plan.column,
            plan.lower,
            plan.upper,
            PERM,
            wanted,
            peaks[part],
        )

    work = h.shape[0] * values.shape[1]
    if work < _THREAD_WORK:
        run(slice(None))
        return peaks
    workers = os.cpu_count() or 1
    cuts = np.linspace(0, h.shape[0], min(2 * workers, work // 1000) + 1).astype(int)
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, map(slice, cuts[:-1], cuts[1:])))
    return peaks


def dense_system(
    interpolant: Interpolant, durations: NDArray[np.floating]
) -> tuple[NDArray[np.floating], NDArray[np.floating], NDArray[np.int64]]:
    """Matrix over all coefficients, the factor hʳ of each right-hand side, and first columns.

    Computed in the precision of ``durations``.
    """
    plan = layout(interpolant)
    first = np.concatenate([[0], np.cumsum(plan.degrees + 1)])
    size = plan.kinds.size
    matrix = np.zeros((size, first[-1]), dtype=durations.dtype)
    factor = np.ones(size, dtype=durations.dtype)
    for i in range(size):
        kind, b, r = plan.kinds[i], plan.breaks[i], plan.orders[i]
        if kind == ConditionKind.RIGHT_VALUE:
            matrix[i, first[b] + r] = PERM[r, r]
            factor[i] = durations[b] ** r
            continue
        k = b - 1
        powers = np.arange(r, plan.degrees[k] + 1)
        matrix[i, first[k] + powers] = PERM[powers, r]
        if kind == ConditionKind.LEFT_VALUE:
            factor[i] = durations[k] ** r
        elif r <= plan.degrees[b]:
            matrix[i, first[b] + r] = -PERM[r, r] * (durations[k] / durations[b]) ** r
    scale = np.abs(matrix).max(axis=1)
    return matrix / scale[:, None], factor / scale, first


def _flat(interpolant: Interpolant, scaled: Array) -> Array:
    plan = layout(interpolant)
    return np.concatenate([scaled[k, : d + 1] for k, d in enumerate(plan.degrees)])


def _unflat(interpolant: Interpolant, flat: Array) -> Array:
    """Coefficients of axis 0 put back into (segments, powers)."""
    plan = layout(interpolant)
    first = np.concatenate([[0], np.cumsum(plan.degrees + 1)])
    out = np.zeros((interpolant.segments, kernel.MAX_COEFFICIENTS, *flat.shape[1:]))
    for k, d in enumerate(plan.degrees):
        out[k, : d + 1] = flat[first[k] : first[k + 1]]
    return out


def refined_coefficients(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> tuple[Array, Array]:
    """Coefficients after iterative refinement in extended precision, with an error bound.

    The residual is taken in ``longdouble``; its rounding is bounded by that type's own epsilon,
    so the bound holds (only wider) where ``longdouble`` is float64. The approximate inverse B of
    the matrix A bounds the error by (I − |BA − I|)⁻¹ |B| |residual|, entry by entry; an ``error``
    that contains its own image is above that.

    Returns
    -------
    coefficients, error : ndarray, shape (segments, 10, joints)
        Scaled coefficients and a bound on their absolute error.
    """
    wide = np.longdouble
    values = right_hand_sides(interpolant, waypoints, nodal).astype(wide)
    flat = _flat(interpolant, coefficients(interpolant, waypoints, durations, nodal)).astype(wide)
    matrix, factor, _ = dense_system(interpolant, durations.astype(wide))
    right = factor[:, None] * values
    narrow = matrix.astype(np.float64)
    inverse = _inverse(interpolant, narrow, durations)
    for _ in range(2):
        residual = (right - matrix @ flat).astype(np.float64)
        flat = flat + inverse @ residual
    residual = np.abs(right - matrix @ flat)
    rounding = np.finfo(wide).eps * (matrix.shape[0] + 24)
    rounding = rounding * (np.abs(matrix) @ np.abs(flat) + np.abs(right))
    first = np.abs(inverse) @ (residual + rounding).astype(np.float64)
    epsilon = np.finfo(np.float64).eps
    defect = np.abs(inverse @ narrow - np.eye(len(narrow)))
    defect += epsilon * (len(narrow) + 2) * (np.abs(inverse) @ np.abs(narrow))
    error = first
    for _ in range(3):
        error = first + 1.1 * (defect @ error)
    if not (first + defect @ error <= error).all():
        raise _singular(interpolant, durations)
    rounded = flat.astype(np.float64)
    error = error + epsilon * np.abs(rounded)
    return _unflat(interpolant, rounded), _unflat(interpolant, error)


def _inverse(interpolant: Interpolant, matrix: NDArray[np.floating], durations: Array) -> Array:
    try:
        return np.asarray(np.linalg.inv(matrix), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise _singular(interpolant, durations) from None


@dataclass(frozen=True, eq=False)
class CoefficientGradient:
    """Derivatives of the scaled coefficients, one joint-independent matrix per variable.

    Attributes
    ----------
    durations : ndarray, shape (segments, segments, 10, joints)
        d coefficients / d durations; first axis the duration.
    waypoints : ndarray, shape (way-points, segments, 10)
        d coefficients of a joint / d that joint's way-point.
    nodal : ndarray, shape (free, segments, 10)
        d coefficients of a joint / d that joint's free derivative.
    """

    durations: Array
    waypoints: Array
    nodal: Array


def coefficient_gradient(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> CoefficientGradient:
    """Derivatives of the coefficients by implicit differentiation of the linear system."""
    plan = layout(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    matrix, factor, first = dense_system(interpolant, durations)
    n, joints = interpolant.segments, waypoints.shape[1]
    flat = _flat(interpolant, coefficients(interpolant, waypoints, durations, nodal))
    inverse = _inverse(interpolant, matrix, durations)
    by_duration = np.zeros((n, matrix.shape[0], joints))
    for i in range(matrix.shape[0]):
        kind, b, r = plan.kinds[i], plan.breaks[i], plan.orders[i]
        if r == 0:
            continue
        if kind == ConditionKind.MATCH:
            if r <= plan.degrees[b]:
                entry = matrix[i, first[b] + r] * flat[first[b] + r]
                by_duration[b - 1, i] -= r * entry / durations[b - 1]
                by_duration[b, i] += r * entry / durations[b]
        else:
            k = b if kind == ConditionKind.RIGHT_VALUE else b - 1
            by_duration[k, i] += r * factor[i] / durations[k] * values[i]
    one_hot_w = (plan.waypoint[None, :] == np.arange(waypoints.shape[0])[:, None]) * factor
    one_hot_n = (plan.nodal[None, :] == np.arange(interpolant.free)[:, None]) * factor
    return CoefficientGradient(
        durations=np.stack([_unflat(interpolant, inverse @ row) for row in by_duration]),
        waypoints=np.array([_unflat(interpolant, inverse @ row) for row in one_hot_w]),
        nodal=np.array([_unflat(interpolant, inverse @ row) for row in one_hot_n]).reshape(
            interpolant.free, n, kernel.MAX_COEFFICIENTS
        ),
    )
