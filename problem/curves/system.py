"""A declaration's linear system at given durations, in any precision, and its solution."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import SingularError
from .condition import Layout

DENSE_UNKNOWNS = 300
"""Up to this many coefficients one dense inverse takes ten milliseconds; nothing is compiled."""
POSITIVE = 1e-290
"""Added to every bound, so that none is 0: far below any angle, far above the least float even
after division by hʳ."""


@dataclass(frozen=True, eq=False)
class Factors:
    """LU factors of a square band matrix with partial pivoting, as LAPACK's dgbtrf stores them.

    Attributes
    ----------
    lower, upper : int
        Bandwidths of the matrix; the factor U has ``lower + upper`` diagonals above its own.
    packed : ndarray, shape (size, 2 lower + upper + 1)
        The factors by columns: entry (i, c) of U, or the multiplier, at ``[c, lower + upper +
        i − c]``.
    swapped : ndarray of int, shape (size,)
        Row that was swapped with row c when column c was eliminated.
    """

    lower: int
    upper: int
    packed: Array
    swapped: NDArray[np.int32]

    @property
    def diagonal(self) -> Array:
        """The pivots."""
        return np.asarray(self.packed[:, self.lower + self.upper])

    def solve(self, right: NDArray[np.floating], transposed: bool = False) -> Array:
        """Solution of Ax = b, or of Aᵀx = b, for right-hand sides of shape (size, vectors)."""
        from scipy.linalg.lapack import dgbtrs  # a quarter of a second, and few need it

        found, _ = dgbtrs(
            self.packed.T, self.lower, self.upper, right, self.swapped, trans=int(transposed)
        )
        return np.asarray(found)


def factorise(
    row: NDArray[np.int64], column: NDArray[np.int64], entries: NDArray[np.floating]
) -> Factors:
    """Factors of the matrix with these entries, each at its row and column."""
    from scipy.linalg.lapack import dgbtrf  # a quarter of a second, and few need it

    away = row - column
    lower, upper = int(away.max()), int(-away.min())
    packed = np.zeros((int(column.max()) + 1, 2 * lower + upper + 1))
    packed[column, lower + upper + away] = entries
    factors, swapped, _ = dgbtrf(packed.T, lower, upper, overwrite_ab=True)
    return Factors(lower, upper, np.ascontiguousarray(factors.T), swapped)


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
    """

    columns: NDArray[np.int64]
    values: NDArray[np.floating]
    factor: NDArray[np.floating]

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
        return np.asarray(self.factor[:, None] * values.astype(self.factor.dtype, copy=False))

    def begun(self, layout: Layout, values: Array) -> NDArray[np.floating]:
        """Coefficients that a row of one entry gives at once; 0 for the others.

        What is solved for from here is exactly 0 for a joint that stands still.
        """
        flat = np.zeros((len(self.values), values.shape[1]), dtype=self.factor.dtype)
        rows, columns = layout.alone
        given = self.factor[rows, None] * values[rows].astype(self.factor.dtype, copy=False)
        flat[columns] = given / self.values[rows, :1]
        return flat

    @cached_property
    def factors(self) -> Factors:
        """Factors of the band matrix: as many rows as coefficients are needed."""
        row, slot = np.nonzero(self.values)
        return factorise(row, self.columns[row, slot], self.values[row, slot])

    @property
    def narrow(self) -> System:
        """The same rows in float64."""
        if self.values.dtype == np.float64:
            return self
        values, factor = (a.astype(np.float64) for a in (self.values, self.factor))
        return System(self.columns, values, factor)

    @property
    def in_band(self) -> bool:
        """Whether the band's factors serve, and not a dense inverse."""
        return len(self.values) > DENSE_UNKNOWNS


def system(layout: Layout, durations: NDArray[np.floating]) -> System:
    """The rows for given durations, in the precision of ``durations``."""
    values = layout.matrix(durations)
    scale = np.abs(values).max(axis=1)
    rates = layout.rates(durations) / scale
    return System(layout.entries[0], values / scale[:, None], rates)


def inverse(rows: System, layout: Layout, durations: Array) -> Array:
    """The dense inverse.

    Raises
    ------
    SingularError
    """
    try:
        return np.asarray(np.linalg.inv(layout.dense(rows.narrow.values)), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise singular(layout, durations) from None


def coefficients(layout: Layout, values: Array, durations: Array) -> Array:
    """Coefficients in the segments' own parameter s in [0, 1], shape (segments, 10, joints).

    Parameters
    ----------
    layout : Layout
    values : ndarray, shape (rows, joints)
        What the conditions give.
    durations : ndarray, shape (segments,)
        s.

    Raises
    ------
    SingularError
    """
    rows = system(layout, durations)
    flat = rows.begun(layout, values)
    residual = rows.right(values) - rows.times(flat)
    with np.errstate(all="ignore"):
        if rows.in_band:
            flat = flat + rows.factors.solve(residual)
        else:
            try:
                flat = flat + np.linalg.solve(layout.dense(rows.values), residual)
            except np.linalg.LinAlgError:
                raise singular(layout, durations) from None
    if not np.isfinite(flat).all():
        raise singular(layout, durations)
    return layout.unflat(np.asarray(flat, dtype=np.float64))


def singular(layout: Layout, durations: Array) -> SingularError:
    """The error of a system that these durations make singular."""
    why = f"interpolant {layout.name}: singular for durations {durations} s"
    return SingularError(why, int(np.argmin(durations)))
