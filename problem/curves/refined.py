"""A declaration's linear system: coefficients with an error bound, and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from . import kernel
from .banded import Factors, factorise, image
from .condition import ConditionKind
from .spline import PERM, coefficients, layout, right_hand_sides, singular

if TYPE_CHECKING:
    from .interpolant import Interpolant

DENSE_UNKNOWNS = 400
"""Up to this many coefficients one dense inverse takes a few milliseconds; a band gains nothing."""
SHARES = (1e-5, 1e-9, 1e-14)
"""Of the largest entry in a row of the inverse, below which entries are left out, tried in turn:
the first nearly always does (at 1e-3 a second image is needed, at 1e-8 rows are a third longer),
the last leaves out what rounding would lose."""
GUESSED = 1e-2
"""The same for the guess that an image has to stay below: shorter rows, and twice the sum of what
is left mostly covers the rest; where it does not, a further image does."""
DENSE_AFTER_ALL = 6000
"""Up to this many coefficients, 300 MB, a dense inverse is tried where no banded one settles."""
IMAGES = 3
"""Images of a bound that are taken: the first one contains its own nearly always."""
_PART = 32768
"""Rows that are handled together in extended precision: some ten megabytes for seven joints."""

_POSITIVE = 1e-290
"""Added to every bound, so that none is 0: far below any angle, far above the least float even
after division by hʳ."""


@dataclass(frozen=True, eq=False)
class Pattern:
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
def pattern_of(interpolant: Interpolant) -> Pattern:
    """The places of all entries, from the declaration alone."""
    plan = layout(interpolant)
    first = np.concatenate([[0], np.cumsum(plan.degrees + 1)])
    right, match = (plan.kinds == kind for kind in (ConditionKind.RIGHT_VALUE, ConditionKind.MATCH))
    segment = np.where(right, plan.breaks, plan.breaks - 1)
    r, degree = plan.orders, plan.degrees[segment]
    columns = np.zeros((r.size, int(plan.degrees.max()) + 2), dtype=np.int64)
    constant = np.zeros(columns.shape)
    columns[right, 0], constant[right, 0] = (first[segment] + r)[right], PERM[r, r][right]
    for m in range(columns.shape[1] - 1):
        power = np.minimum(r + m, PERM.shape[0] - 1)
        there = ~right & (r + m <= degree)
        columns[there, m] = (first[segment] + power)[there]
        constant[there, m] = PERM[power, r][there]
    jumps = np.flatnonzero(match)
    jumps = jumps[r[jumps] <= plan.degrees[plan.breaks[jumps]]]
    slots = np.maximum(degree - r + 1, 0)[jumps]
    columns[jumps, slots] = first[plan.breaks[jumps]] + r[jumps]
    return Pattern(first, columns, constant, segment, jumps, slots)


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
        if len(self.values) <= DENSE_UNKNOWNS:
            # The same sums in the same order, column after column, without a call for each.
            terms = np.multiply(self.values.T[:, :, None], flat[self.columns.T], order="C")
            return np.asarray(np.add.reduce(terms, axis=0))
        out = self.values[:, 0, None] * flat[self.columns[:, 0]]
        for m in range(1, self.columns.shape[1]):
            out += self.values[:, m, None] * flat[self.columns[:, m]]
        return out

    def right(self, values: Array) -> NDArray[np.floating]:
        """Right-hand sides from the rows' values."""
        return np.asarray(self.factor[:, None] * values.astype(self.factor.dtype))

    def parts(self) -> Iterator[tuple[slice, System]]:
        """The rows in parts, so that extended precision takes little memory."""
        for start in range(0, len(self.values), _PART):
            at = slice(start, start + _PART)
            yield at, System(self.columns[at], self.values[at], self.factor[at], self.first)

    def dense(self) -> Array:
        """The rows as a full matrix."""
        size = len(self.values)
        out = np.zeros((size, size))
        values = self.values.astype(np.float64)
        at = np.where(values != 0.0, self.columns, 0)
        np.add.at(out, (np.arange(size)[:, None], at), values)
        return out

    def factorised(self) -> Factors:
        """The rows as a band matrix, with its factors: as many rows as coefficients are needed."""
        real = self.values != 0.0
        away = np.where(real, self.columns - np.arange(len(self.values))[:, None], 0)
        lower, upper = int(-away.min()), int(away.max())
        band = np.zeros((len(self.values), lower + upper + 1))
        for m in range(self.columns.shape[1]):
            i = np.flatnonzero(real[:, m])
            band[i, away[i, m] + lower] = self.values[i, m]
        return factorise(band, lower, upper)


def system(interpolant: Interpolant, durations: NDArray[np.floating]) -> System:
    """The rows for given durations, in the precision of ``durations``."""
    plan, pattern = layout(interpolant), pattern_of(interpolant)
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


@lru_cache(maxsize=256)
def places(interpolant: Interpolant) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Segment and power of each coefficient."""
    first = pattern_of(interpolant).first
    segment = np.repeat(np.arange(interpolant.segments), np.diff(first))
    return segment, np.arange(first[-1]) - first[segment]


def _flat(interpolant: Interpolant, scaled: Array) -> Array:
    return np.asarray(scaled[places(interpolant)])


def _unflat(interpolant: Interpolant, flat: Array) -> Array:
    """Coefficients of the last axis but one put back into (segments, powers)."""
    shape = (interpolant.segments, kernel.MAX_COEFFICIENTS)
    out = np.zeros((*flat.shape[:-2], *shape, flat.shape[-1]))
    segment, power = places(interpolant)
    out[..., segment, power, :] = flat
    return out


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
    one with the far entries left out, as `banded.image` makes it for long splines. An image of a
    bound is a bound itself, and the closer one.

    Returns
    -------
    coefficients, error : ndarray, shape (segments, 10, joints)
        Scaled coefficients and a bound on their absolute error.
    """
    rows = system(interpolant, durations.astype(np.longdouble))
    values = right_hand_sides(interpolant, waypoints, nodal)
    first = _flat(interpolant, coefficients(interpolant, waypoints, durations, nodal))
    size = len(rows.values)
    if size > DENSE_UNKNOWNS:
        flat, error = _refined_in_band(rows, values, first)
        if error is None and size > DENSE_AFTER_ALL:
            raise singular(interpolant, durations)
    else:
        flat, error = first, None
    if error is None:
        matrix = rows.dense()
        inverse = _inverse(interpolant, matrix, durations)
        flat = _refined(rows, values, first, lambda residual: inverse @ residual)
        error = _bounded(rows, matrix, inverse, values, flat)
    if error is None:
        raise singular(interpolant, durations)
    rounded = flat.astype(np.float64)
    error = error + np.finfo(np.float64).eps * np.abs(rounded)
    return _unflat(interpolant, rounded), _unflat(interpolant, error)


def _refined(
    rows: System, values: Array, first: Array, solve: Callable[[Array], Array]
) -> NDArray[np.floating]:
    """Coefficients after two steps of refinement, in extended precision."""
    flat = first.astype(np.longdouble)
    for _ in range(2):
        residual = np.concatenate(
            [(part.right(values[at]) - part.times(flat)) for at, part in rows.parts()]
        )
        flat = flat + solve(residual.astype(np.float64))
    return flat


def _excess(rows: System, values: Array, flat: NDArray[np.floating], terms: int) -> Array:
    """Bound on the residual, its rounding in sums of so many terms included."""
    tiny = np.finfo(np.longdouble).eps * (terms + 24)
    found = []
    for at, part in rows.parts():
        right = part.right(values[at])
        sizes = replace(part, values=np.abs(part.values)).times(np.abs(flat))
        excess = np.abs(right - part.times(flat)) + tiny * (sizes + np.abs(right))
        found.append(excess.astype(np.float64))
    return np.concatenate(found)


def _refined_in_band(
    rows: System, values: Array, first: Array
) -> tuple[NDArray[np.floating], Array | None]:
    """Coefficients, refined by a band's factors, and an error that contains its own image."""
    factors = rows.factorised()
    if not (np.abs(factors.diagonal) > 0.0).all():
        return first, None
    flat = _refined(rows, values, first, factors.solve)
    excess = _excess(rows, values, flat, rows.columns.shape[1])
    for share in SHARES:
        guess = 2.0 * (_POSITIVE + image(factors, max(share, GUESSED), excess, None))
        for _ in range(IMAGES):
            error = _POSITIVE + image(factors, share, excess, guess)
            if (error <= guess).all():
                return flat, error
            guess = 2.0 * error
    return flat, None


def _bounded(
    rows: System, matrix: Array, inverse: Array, values: Array, flat: NDArray[np.floating]
) -> Array | None:
    """An error that contains its own image, or None."""
    excess = _excess(rows, values, flat, len(matrix))
    size = np.finfo(np.float64).eps * (len(matrix) + 2)
    # The rounding of the product, and of A's entries, is part of the defect |BA − I|.
    found = np.abs(inverse @ matrix - np.eye(len(matrix)))
    defect = found + size * (np.abs(inverse) @ np.abs(matrix))
    first = _POSITIVE + np.abs(inverse) @ excess
    error = first
    for _ in range(3):
        error = first + 1.1 * (defect @ error)
    return error if (first + defect @ error <= error).all() else None


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
    plan, pattern = layout(interpolant), pattern_of(interpolant)
    values = right_hand_sides(interpolant, waypoints, nodal)
    rows = system(interpolant, durations)
    size, joints = len(rows.factor), waypoints.shape[1]
    flat = _flat(interpolant, coefficients(interpolant, waypoints, durations, nodal))
    inverse = _inverse(interpolant, rows.dense(), durations)
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
