"""From a declaration, way-points and durations to coefficients and batches of peaks."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..errors import SingularError, TrajgapError
from . import kernel, lanes, leading_kernel, range_kernel
from .compilation import Deferred
from .condition import ConditionKind, counts_in_words

if TYPE_CHECKING:
    from .interpolant import Interpolant

PERM = np.array(
    [[float(math.perm(p, r)) for r in range(kernel.MAX_COEFFICIENTS)] for p in range(10)]
)
"""PERM[p, r] = p!/(p − r)!: the factor of sᵖ⁻ʳ in the r-th derivative of sᵖ."""
_fit_one = Deferred(kernel.fit_coefficients, 2.0)
"""The fit of one vector; compiling it takes two to three seconds."""
_fit_many = Deferred(kernel.fit_coefficients, 2.0, lanes.fit_coefficients)
"""The fit of many."""
_peaks_of_many = Deferred(kernel.batch_peaks, 10.0, lanes.batch_peaks)
"""True peaks of a batch; compiling it takes eight to twelve seconds."""
_leading_of_many = Deferred(leading_kernel.leading_peaks, 12.0, lanes.leading_peaks)
"""The peaks that decide a batch; compiling it takes ten to fourteen seconds."""
_ranges_of_many = Deferred(range_kernel.batch_ranges, 8.0)
"""Positions of a batch; compiling it takes six to ten seconds."""
_THREAD_WORK = 4000
"""Polynomials (vectors times joints) below which starting threads costs more than it saves."""
_LONGEST = 1e30
"""Durations, s, beyond which, or below whose reciprocal, ninth powers leave float64's range."""


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

    @property
    def rows(self) -> tuple[Any, ...]:
        """What every kernel takes of it, in their order."""
        shared = (self.kinds, self.breaks, self.orders, self.degrees, self.column)
        return (*shared, self.lower, self.upper, PERM)


@lru_cache(maxsize=256)
def layout(interpolant: Interpolant) -> Layout:
    """Layout of ``interpolant``; its free derivatives, if any, become prescribed rows."""
    full = interpolant.completed() if interpolant.free else interpolant
    table, n = full.table, full.segments
    kinds, breaks, orders = table.kinds, table.breaks, table.orders
    degrees = np.array(full.degrees, dtype=np.int64)
    powers = np.arange(kernel.MAX_COEFFICIENTS)
    unknown = powers <= degrees[:, None]
    right, match = kinds == ConditionKind.RIGHT_VALUE, kinds == ConditionKind.MATCH
    unknown[breaks[right], orders[right]] = False
    column = np.where(unknown, np.cumsum(unknown).reshape(unknown.shape) - 1, -1)
    k, r = breaks[~right] - 1, orders[~right]
    equation = np.arange(k.size)
    lower = upper = 0
    for p in range(int(degrees.max()) + 1):
        touched = np.where(p >= r, column[k, p], -1)
        used = touched >= 0
        lower = max(lower, int((equation - touched)[used].max(initial=0)))
        upper = max(upper, int((touched - equation)[used].max(initial=0)))
    beyond = np.full(k.size, -1)
    at = match[~right] & (r <= degrees[np.minimum(k + 1, n - 1)])
    beyond[at] = column[k[at] + 1, r[at]]
    used = beyond >= 0
    lower = max(lower, int((equation - beyond)[used].max(initial=0)))
    upper = max(upper, int((beyond - equation)[used].max(initial=0)))
    values = np.zeros((n + 1, kernel.MAX_COEFFICIENTS + 1, full.prescribed_joints or 1))
    for b, entries in enumerate(full.prescribed):
        for order, value in entries:
            if order < values.shape[1]:
                values[b, order] = value
    free = np.full(values.shape[:2], -1, dtype=np.int64)
    if full.free == 0:
        for i, (b, order) in enumerate(interpolant.free_derivatives):
            free[b, order] = i
    waypoint = np.full(n + 1, -1, dtype=np.int64)
    waypoint[list(interpolant.waypoint_breaks)] = np.arange(len(interpolant.waypoint_breaks))
    return Layout(
        kinds=kinds,
        breaks=breaks,
        orders=orders,
        degrees=degrees,
        column=column,
        unknowns=int(unknown.sum()),
        lower=lower,
        upper=upper,
        prescribed=np.where(match[:, None], 0.0, values[breaks, orders]),
        waypoint=np.where((orders == 0) & ~match, waypoint[breaks], -1),
        nodal=np.where(match, -1, free[breaks, orders]),
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
            f"interpolant {interpolant.name}: "
            f"{counts_in_words(interpolant.conditions, interpolant.coefficients)}; give nodal "
            f"derivatives of shape ({interpolant.free}, {joints}) or add conditions"
        )
    if interpolant.prescribed_joints not in (None, joints):
        raise TrajgapError(
            f"interpolant {interpolant.name}: prescribes derivatives for "
            f"{interpolant.prescribed_joints} joints, the way-points have {joints}"
        )
    values = np.array(np.broadcast_to(plan.prescribed, (plan.kinds.size, joints)))
    rows = plan.waypoint >= 0
    values[rows] = waypoints[plan.waypoint[rows]]
    if interpolant.free and nodal is not None:
        rows = plan.nodal >= 0
        values[rows] = nodal[plan.nodal[rows]]
    return values


def batch_coefficients(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> Array:
    """`coefficients` of many duration vectors, shape (vectors, segments, 10, joints).

    Not finite where the system is singular.
    """
    plan = layout(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    vectors, joints = len(durations), waypoints.shape[1]
    out = np.zeros((interpolant.segments, kernel.MAX_COEFFICIENTS, joints * vectors))
    fitted = _fit_one if vectors == 1 else _fit_many
    fitted(
        np.array(durations.T, order="C"),  # one that may be written into: compiled for it alone
        vectors,
        values,
        *plan.rows,
        np.empty((plan.unknowns, 2 * plan.lower + plan.upper + 1, vectors)),
        np.empty((plan.unknowns, joints * vectors)),
        out,
    )
    return out.reshape(*out.shape[:2], joints, vectors).transpose(3, 0, 1, 2)


def coefficients(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> Array:
    """Coefficients in the segments' own parameter s in [0, 1], shape (segments, 10, joints)."""
    out: Array = batch_coefficients(interpolant, waypoints, durations[None], nodal)[0]
    if not np.isfinite(out).all():
        raise singular(interpolant, durations)
    return out


def singular(interpolant: Interpolant, durations: Array) -> SingularError:
    """The error of a system that these durations make singular."""
    why = f"interpolant {interpolant.name}: singular for durations {durations} s"
    return SingularError(why, int(np.argmin(durations)))


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
    side: float = 0.0,
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
    side : float
        0 for sizes; 1 for the furthest values above 0, −1 for those below, as sizes.

    Returns
    -------
    ndarray, shape (batch, joints, 3)
        rad/s, rad/s², rad/s³; the same bits whatever the order, the size or the threads.
    """
    rows, h = layout(interpolant).rows, durations
    peaks = np.empty((h.shape[0], values.shape[1], 3))

    def run(part: slice) -> None:
        _peaks_of_many(h[part], values, *rows, wanted, side, peaks[part])

    _in_parts(run, _peaks_of_many, h.shape[0], values.shape[1])
    return peaks


def leading_peaks(
    interpolant: Interpolant,
    values: Array,
    durations: Array,
    wanted: NDArray[np.bool_],
    ceilings: Array,
    floor: float,
) -> Array:
    """`batch_peaks` of which those that cannot decide may come out too small.

    Parameters
    ----------
    interpolant, values, durations, wanted
        As `batch_peaks` takes them.
    ceilings : ndarray, shape (joints, 3)
        What peaks are divided by: rad/s, rad/s², rad/s³.
    floor : float
        Stretch of all durations below which it does not matter how large one is.

    Returns
    -------
    ndarray, shape (batch, joints, 3)
        The least stretch that brings all of them below the ceilings has the bits of that of all
        true peaks, or both are below the floor.
    """
    rows, h = layout(interpolant).rows, durations
    peaks = np.empty((h.shape[0], values.shape[1], 3))

    def run(part: slice) -> None:
        _leading_of_many(h[part], values, *rows, wanted, ceilings, floor, peaks[part])

    _in_parts(run, _leading_of_many, h.shape[0], values.shape[1])
    return peaks


def batch_ranges(interpolant: Interpolant, values: Array, durations: Array) -> Array:
    """Least and largest positions for a batch of duration vectors.

    Parameters
    ----------
    interpolant : Interpolant
    values : ndarray, shape (rows, joints)
        From `motion_values`, of the joints that are asked for.
    durations : ndarray, shape (batch, segments)
        Durations, s.

    Returns
    -------
    ndarray, shape (batch, joints, 2)
        rad from the first way-point; −inf and inf for vectors that define no curve.
    """
    rows, h = layout(interpolant).rows, durations
    ranges = np.empty((h.shape[0], values.shape[1], 2))

    def run(part: slice) -> None:
        _ranges_of_many(h[part], values, *rows, ranges[part])

    _in_parts(run, _ranges_of_many, h.shape[0], values.shape[1])
    return ranges


def _in_parts(run: Callable[[slice], None], kernel: Deferred, vectors: int, joints: int) -> None:
    """Run a kernel on parts of a batch, on several threads where that pays."""
    work = vectors * joints
    if work < _THREAD_WORK or not kernel.ready():
        run(slice(None))
        return
    workers = os.cpu_count() or 1
    cuts = np.linspace(0, vectors, min(2 * workers, work // 1000) + 1).astype(int)
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, map(slice, cuts[:-1], cuts[1:])))
