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
"""Added to every bound, so none is 0: far below any angle, far above the least float even
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
    layout : Layout
    durations : ndarray, shape (segments,)
        s.
    values : ndarray, shape (rows, widest row)
        In the columns of `Conditions.entries`; padded entries are 0.
    factor : ndarray, shape (rows,)
        What multiplies each right-hand side: hʳ over the row's scale.
    """

    layout: Layout
    durations: NDArray[np.floating]
    values: NDArray[np.floating]
    factor: NDArray[np.floating]

    def times(self, flat: NDArray[np.floating]) -> NDArray[np.floating]:
        """The rows times coefficients of shape (coefficients, joints)."""
        columns = self.layout.entries[0]
        if not self.in_band:
            # The same sums in the same order, column after column, without a call for each.
            terms = np.multiply(self.values.T[:, :, None], flat[columns.T], order="C")
            return np.asarray(np.add.reduce(terms, axis=0))
        out = self.values[:, 0, None] * flat[columns[:, 0]]
        for m in range(1, columns.shape[1]):
            out += self.values[:, m, None] * flat[columns[:, m]]
        return out

    def right(self, values: Array) -> NDArray[np.floating]:
        """Right-hand sides from the rows' values."""
        return np.asarray(self.factor[:, None] * values.astype(self.factor.dtype, copy=False))

    def begun(self, values: Array) -> NDArray[np.floating]:
        """Coefficients that a row of one entry gives at once; 0 for the others.

        What is solved for from here is exactly 0 for a joint that stands still.
        """
        flat = np.zeros((len(self.values), values.shape[1]), dtype=self.factor.dtype)
        rows, columns = self.layout.alone
        given = self.factor[rows, None] * values[rows].astype(self.factor.dtype, copy=False)
        flat[columns] = given / self.values[rows, :1]
        return flat

    @property
    def narrow(self) -> System:
        """The same rows in float64."""
        if self.values.dtype == np.float64:
            return self
        values, factor = (a.astype(np.float64) for a in (self.values, self.factor))
        return System(self.layout, self.durations, values, factor)

    @property
    def in_band(self) -> bool:
        """Whether the band's factors serve, and not a dense inverse."""
        return len(self.values) > DENSE_UNKNOWNS

    @cached_property
    def factors(self) -> Factors:
        """Factors of the band matrix: as many rows as coefficients are needed."""
        row, slot = np.nonzero(self.values)
        return factorise(row, self.layout.entries[0][row, slot], self.values[row, slot])

    @cached_property
    def inverse(self) -> Array:
        """The dense inverse in float64.

        Raises
        ------
        SingularError
        """
        try:
            return np.asarray(np.linalg.inv(self.layout.dense(self.narrow.values)))
        except np.linalg.LinAlgError:
            raise self.singular() from None

    def solve(self, right: NDArray[np.floating], transposed: bool = False) -> Array:
        """Solution in float64, or that with the transposed rows, for right-hand sides by rows."""
        if self.in_band:
            return self.factors.solve(right, transposed)
        if transposed:  # gradients ask for many
            return np.asarray(self.inverse.T @ right)
        try:
            return np.linalg.solve(self.layout.dense(self.values), right)
        except np.linalg.LinAlgError:
            raise self.singular() from None

    def fitted(self, values: Array) -> Array:
        """Coefficients in the segments' own parameter s in [0, 1], shape (segments, 10, joints).

        Parameters
        ----------
        values : ndarray, shape (rows, joints)
            What the conditions give.

        Raises
        ------
        SingularError
        """
        flat = self.begun(values)
        with np.errstate(all="ignore"):
            flat = flat + self.solve(self.right(values) - self.times(flat))
        if not np.isfinite(flat).all():
            raise self.singular()
        return self.layout.unflat(np.asarray(flat, dtype=np.float64))

    def singular(self) -> SingularError:
        """The error of a system that its durations make singular."""
        h = self.durations.astype(np.float64)
        why = f"interpolant {self.layout.name}: singular for durations {h} s"
        return SingularError(why, int(np.argmin(h)))


def system(layout: Layout, durations: NDArray[np.floating]) -> System:
    """The rows for given durations, in the precision of ``durations``."""
    values = layout.matrix(durations)
    scale = np.abs(values).max(axis=1)
    rates = layout.rates(durations) / scale
    return System(layout, durations, values / scale[:, None], rates)
