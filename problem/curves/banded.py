"""Factors of long banded systems, for solutions with the matrix and with its transpose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array


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
