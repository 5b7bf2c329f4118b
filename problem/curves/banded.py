"""Banded linear systems: factors, solutions, and rows of the inverse with what they leave out.

A derivative at a break depends less and less on way-points further away: by about 0.27 a segment
for C2 cubics, 0.43 for C4 quintics. An entry of the inverse far from the diagonal is tiny, so that
each row of an approximate inverse B needs a few dozen segments only. Nothing is assumed of the
entries left out: they show in BA − I, which is computed.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .kernel import compiled

_PART = 4096
"""Rows that one thread takes at a time: enough to hide the cost of handing them out."""
_SUMS = 1.0 + 1e-9
"""Covers the rounding of sums of up to four million terms of one sign."""


@dataclass(frozen=True, eq=False)
class Factors:
    """LU factors of a square band matrix with partial pivoting, as LAPACK's dgbtrf stores them.

    Attributes
    ----------
    lower, upper : int
        Bandwidths of the matrix; the factor U has ``lower + upper`` diagonals above its own.
    rows : ndarray, shape (size, lower + upper + 1)
        The matrix by rows: entry (i, c) at ``[i, c − i + lower]``.
    packed : ndarray, shape (size, 2 lower + upper + 1)
        The factors by columns: entry (i, c) of U, or the multiplier, at ``[c, lower + upper +
        i − c]``.
    swapped : ndarray of int, shape (size,)
        Row that was swapped with row c when column c was eliminated.
    """

    lower: int
    upper: int
    rows: Array
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


def factorise(rows: Array, lower: int, upper: int) -> Factors:
    """Factors of the band matrix with entry (i, c) at ``rows[i, c − i + lower]``."""
    from scipy.linalg.lapack import dgbtrf  # a quarter of a second, and few need it

    size = len(rows)
    packed = np.zeros((size, 2 * lower + upper + 1))
    for d in range(-lower, upper + 1):  # entry (i, i + d)
        i = np.arange(max(0, -d), min(size, size - d))
        packed[i + d, lower + upper - d] = rows[i, d + lower]
    factors, swapped, _ = dgbtrf(packed.T, lower, upper, overwrite_ab=True)
    return Factors(lower, upper, rows, np.ascontiguousarray(factors.T), swapped)
