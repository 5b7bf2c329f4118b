"""A declaration's linear system: coefficients with an error bound, and their derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from ..arrays import Array
from . import kernel
from .condition import ConditionKind
from .spline import PERM, coefficients, layout, right_hand_sides, singular

if TYPE_CHECKING:
    from .interpolant import Interpolant

DENSE_UNKNOWNS = 400
"""Up to this many coefficients one dense inverse takes a few milliseconds; windows gain nothing."""
CHUNK = 24
"""Segments whose rows of the inverse are found together: the least work for halos of 16 to 32."""
HALOS = (16, 48)
"""Segments added on both sides of a chunk, tried in turn. What a window leaves out falls by about
0.27 a segment for C2 cubics and 0.43 for C4 quintics: below 1e-9 and 1e-5 at 16, 1e-17 at 48."""

_POSITIVE = 1e-290
"""Added to every bound, so that none is 0: far below any angle, far above the least float even
after division by hʳ."""


@dataclass(frozen=True, eq=False)
class _Pattern:
    """Where the entries of each row stand, and what the durations change in them.

    ``columns`` and ``constant`` have shape (rows, widest row), padded with zero entries. Row
    ``jumps[i]`` has in slot ``slots[i]`` the entry −r! (h_{b−1}/h_b)ʳ of the other side.
    """

    first: NDArray[np.int64]
    columns: NDArray[np.int64]
    constant: Array
    segment: NDArray[np.int64]
    jumps: NDArray[np.int64]
    slots: NDArray[np.int64]


@lru_cache(maxsize=256)
def _pattern(interpolant: Interpolant) -> _Pattern:
    plan = layout(interpolant)
    first = np.concatenate([[0], np.cumsum(plan.degrees + 1)])
    size = plan.kinds.size
    columns = np.zeros((size, plan.degrees.max() + 2), dtype=np.int64)
    constant = np.zeros(columns.shape)
    jumps, slots = [], []
    for i in range(size):
        kind, b, r = plan.kinds[i], plan.breaks[i], plan.orders[i]
        if kind == ConditionKind.RIGHT_VALUE:
            columns[i, 0], constant[i, 0] = first[b] + r, PERM[r, r]
            continue
        powers = np.arange(r, plan.degrees[b - 1] + 1)
        columns[i, : powers.size] = first[b - 1] + powers
        constant[i, : powers.size] = PERM[powers, r]
        if kind == ConditionKind.MATCH and r <= plan.degrees[b]:
            columns[i, powers.size] = first[b] + r
            jumps.append(i)
            slots.append(powers.size)
    return _Pattern(
        first=first,
        columns=columns,
        constant=constant,
        segment=np.where(plan.kinds == ConditionKind.RIGHT_VALUE, plan.breaks, plan.breaks - 1),
        jumps=np.array(jumps, dtype=np.int64),
        slots=np.array(slots, dtype=np.int64),
    )


@dataclass(frozen=True, eq=False)
class System:
    """Rows over all coefficients, each divided by its largest entry.

    Attributes
    ----------
    columns : ndarray of int, shape (rows, widest row)
        Of the entries; padded entries are 0.
    values : ndarray, shape (rows, widest row)
    factor : ndarray, shape (rows,)
        What multiplies each right-hand side: hʳ over the row's scale.
    first : ndarray of int, shape (segments + 1,)
        Column of each segment's constant coefficient.
    """

    columns: NDArray[np.int64]
    values: NDArray[np.floating]
    factor: NDArray[np.floating]
    first: NDArray[np.int64]

    def times(self, flat: NDArray[np.floating]) -> NDArray[np.floating]:
        """The rows times coefficients of shape (coefficients, joints)."""
        out = self.values[:, 0, None] * flat[self.columns[:, 0]]
        for m in range(1, self.columns.shape[1]):
            out += self.values[:, m, None] * flat[self.columns[:, m]]
        return out

    def dense(self, rows: NDArray[np.int64], low: int, high: int) -> Array:
        """The given rows over columns low to high − 1, which must hold all their entries."""
        out = np.zeros((rows.size, high - low))
        values = self.values[rows].astype(np.float64)
        at = np.where(values != 0.0, self.columns[rows] - low, 0)
        np.add.at(out, (np.arange(rows.size)[:, None], at), values)
        return out


def system(interpolant: Interpolant, durations: NDArray[np.floating]) -> System:
    """The rows for given durations, in the precision of ``durations``."""
    plan, pattern = layout(interpolant), _pattern(interpolant)
    values = pattern.constant.astype(durations.dtype)
    i, b = pattern.jumps, plan.breaks[pattern.jumps]
    r = plan.orders[i]
    values[i, pattern.slots] = -PERM[r, r] * (durations[b - 1] / durations[b]) ** r
    factor = np.where(
        plan.kinds == ConditionKind.MATCH,
        durations.dtype.type(1),
        durations[pattern.segment] ** plan.orders,
    )
    scale = np.abs(values).max(axis=1)
    return System(pattern.columns, values / scale[:, None], factor / scale, pattern.first)


def _places(interpolant: Interpolant) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Segment and power of each coefficient."""
    first = _pattern(interpolant).first
    segment = np.repeat(np.arange(interpolant.segments), np.diff(first))
    return segment, np.arange(first[-1]) - first[segment]


def _flat(interpolant: Interpolant, scaled: Array) -> Array:
    return np.asarray(scaled[_places(interpolant)])


def _unflat(interpolant: Interpolant, flat: Array) -> Array:
    """Coefficients of the last axis but one put back into (segments, powers)."""
    shape = (interpolant.segments, kernel.MAX_COEFFICIENTS)
    out = np.zeros((*flat.shape[:-2], *shape, flat.shape[-1]))
    segment, power = _places(interpolant)
    out[..., segment, power, :] = flat
    return out


@dataclass(frozen=True, eq=False)
class _Block:
    """Some rows of an approximate inverse B: those of the coefficients ``own``.

    ``inverse`` is not zero in the columns ``rows`` only; ``defect`` bounds |BA − I| in the columns
    ``window`` and is 0 elsewhere.
    """

    own: slice
    window: slice
    rows: NDArray[np.int64]
    inverse: Array
    defect: Array


def _defect(inverse: Array, matrix: Array, at: int) -> Array:
    """Bound on |BA − I| for some rows of B, their rounding and that of A's entries included."""
    size = np.finfo(np.float64).eps * (len(matrix) + 2)
    found = inverse @ matrix
    found[np.arange(len(inverse)), at + np.arange(len(inverse))] -= 1.0
    return np.asarray(np.abs(found) + size * (np.abs(inverse) @ np.abs(matrix)))


def _blocks(
    interpolant: Interpolant, rows: System, durations: Array, halo: int | None
) -> list[_Block]:
    """An approximate inverse: dense, or (with a halo) by windows of neighbouring segments.

    A derivative at a break depends less and less on way-points further away, so an entry of A⁻¹
    far from the diagonal is tiny. A window takes the rows of A whose entries all lie in its
    segments; being rows of a regular matrix they are independent, so the window's matrix W has a
    right inverse, W⁺ = QR⁻ᵀ from Wᵀ = QR. Its rows for the inner segments, with zeros elsewhere,
    stand for those of A⁻¹. Nothing is assumed of what is left out: it shows in BA − I.
    """
    size, first, n = len(rows.values), rows.first, interpolant.segments
    everything = np.arange(size)
    if halo is None:
        matrix = rows.dense(everything, 0, size)
        inverse = _inverse(interpolant, matrix, durations)
        whole = slice(0, size)
        return [_Block(whole, whole, everything, inverse, _defect(inverse, matrix, 0))]
    real = rows.values != 0.0
    lowest = np.where(real, rows.columns, size).min(axis=1)
    highest = np.where(real, rows.columns, -1).max(axis=1)
    found = []
    for s in range(0, n, CHUNK):
        own = slice(int(first[s]), int(first[min(s + CHUNK, n)]))
        window = slice(int(first[max(0, s - halo)]), int(first[min(n, s + CHUNK + halo)]))
        inside = np.flatnonzero((lowest >= window.start) & (highest < window.stop))
        matrix = rows.dense(inside, window.start, window.stop)
        q, r = np.linalg.qr(matrix.T)
        if not np.abs(np.diag(r)).min() > 0.0:
            raise singular(interpolant, durations)
        at = own.start - window.start
        inverse = solve_triangular(r, q[at : at + own.stop - own.start].T).T
        found.append(_Block(own, window, inside, inverse, _defect(inverse, matrix, at)))
    return found


def refined_coefficients(
    interpolant: Interpolant,
    waypoints: Array,
    durations: Array,
    nodal: Array | None = None,
) -> tuple[Array, Array]:
    """Coefficients after iterative refinement in extended precision, with an error bound.

    The residual is taken in ``longdouble``; its rounding is bounded by that type's own epsilon,
    so the bound holds (only wider) where ``longdouble`` is float64. An approximate inverse B of
    the matrix A bounds the error e = x − A⁻¹b entry by entry: with the residual r = b − Ax,

        e = −Br + (I − BA)e,  so  |e| ≤ |B||r| + |I − BA||e|,

    and every ``error`` that contains its own image, |B||r| + |I − BA| error ≤ error, is a bound if
    the first term is positive: |I − BA| then shrinks a positive vector, so its spectral radius is
    below 1 and repeated use of the inequality ends in |e| ≤ error. That holds for any B, also for
    one with the far entries left out; on long splines only windows of it are computed.

    Returns
    -------
    coefficients, error : ndarray, shape (segments, 10, joints)
        Scaled coefficients and a bound on their absolute error.
    """
    rows = system(interpolant, durations.astype(np.longdouble))
    values = right_hand_sides(interpolant, waypoints, nodal)
    right = rows.factor[:, None] * values.astype(np.longdouble)
    first = coefficients(interpolant, waypoints, durations, nodal)
    halos = () if len(rows.values) <= DENSE_UNKNOWNS else HALOS
    for halo in (*halos, None):
        blocks = _blocks(interpolant, rows, durations, halo)
        flat = _flat(interpolant, first).astype(np.longdouble)
        for _ in range(2):
            residual = (right - rows.times(flat)).astype(np.float64)
            flat = flat + np.concatenate([b.inverse @ residual[b.rows] for b in blocks])
        error = _bounded(rows, blocks, right, flat)
        if error is not None:
            rounded = flat.astype(np.float64)
            error = error + np.finfo(np.float64).eps * np.abs(rounded)
            return _unflat(interpolant, rounded), _unflat(interpolant, error)
    raise singular(interpolant, durations)


def _bounded(
    rows: System,
    blocks: list[_Block],
    right: NDArray[np.floating],
    flat: NDArray[np.floating],
) -> Array | None:
    """An error that contains its own image, or None."""
    tiny = np.finfo(np.longdouble).eps * (len(right) + 24)
    sizes = System(rows.columns, np.abs(rows.values), rows.factor, rows.first)
    rounding = tiny * (sizes.times(np.abs(flat)) + np.abs(right))
    excess = (np.abs(right - rows.times(flat)) + rounding).astype(np.float64)
    first = _POSITIVE + np.concatenate([np.abs(b.inverse) @ excess[b.rows] for b in blocks])

    def image(error: Array) -> Array:
        return np.concatenate([b.defect @ error[b.window] for b in blocks])

    error = first
    for _ in range(3):
        error = first + 1.1 * image(error)
    return error if (first + image(error) <= error).all() else None


def _inverse(interpolant: Interpolant, matrix: NDArray[np.floating], durations: Array) -> Array:
    try:
        return np.asarray(np.linalg.inv(matrix), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise singular(interpolant, durations) from None


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
    plan, pattern = layout(interpolant), _pattern(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    rows = system(interpolant, durations)
    size, joints = len(rows.factor), waypoints.shape[1]
    flat = _flat(interpolant, coefficients(interpolant, waypoints, durations, nodal))
    inverse = _inverse(interpolant, rows.dense(np.arange(size), 0, size), durations)
    by_duration = np.zeros((interpolant.segments, size, joints))
    # A row that matches two segments holds (h_{b−1}/h_b)ʳ.
    i, b = pattern.jumps, plan.breaks[pattern.jumps]
    r, column = plan.orders[i], rows.columns[i, pattern.slots]
    slope = (r * rows.values[i, pattern.slots])[:, None] * flat[column]
    by_duration[b - 1, i] -= slope / durations[b - 1, None]
    by_duration[b, i] += slope / durations[b, None]
    # The right-hand side of a given derivative holds hʳ.
    i = np.flatnonzero((plan.kinds != ConditionKind.MATCH) & (plan.orders > 0))
    k = pattern.segment[i]
    by_duration[k, i] += (plan.orders[i] * rows.factor[i] / durations[k])[:, None] * values[i]
    one_hot_w = (plan.waypoint[None, :] == np.arange(waypoints.shape[0])[:, None]) * rows.factor
    one_hot_n = (plan.nodal[None, :] == np.arange(interpolant.free)[:, None]) * rows.factor
    return CoefficientGradient(
        durations=_unflat(interpolant, inverse @ by_duration),
        waypoints=_unflat(interpolant, (inverse @ one_hot_w.T).T[:, :, None])[..., 0],
        nodal=_unflat(interpolant, (inverse @ one_hot_n.T).T[:, :, None])[..., 0],
    )
