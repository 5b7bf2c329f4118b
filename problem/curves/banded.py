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


@compiled
def _inverse_row(lower, upper, packed, swapped, i, share, y):  # type: ignore[no-untyped-def]
    """Row ``i`` of the inverse, up to entries that fall below ``share`` of its largest.

    Solves Uᵀz = e_i, then Lᵀy = z; ``y`` is 0 on entry, and outside of the range returned.
    """
    size, wide = packed.shape[0], lower + upper
    top, quiet, high = 0.0, 0, i
    for c in range(i, size):
        value = 1.0 if c == i else 0.0
        for m in range(max(i, c - wide), c):
            value -= packed[c, wide + m - c] * y[m]
        value /= packed[c, wide]
        y[c] = value
        high = c
        top = max(top, abs(value))
        quiet = quiet + 1 if abs(value) <= share * top else 0
        if quiet > wide:
            break
    top, quiet, low = 0.0, 0, high
    for c in range(high, -1, -1):
        value = y[c]
        for m in range(1, min(lower, size - 1 - c) + 1):
            value -= packed[c, wide + m] * y[c + m]
        y[c] = value
        p = swapped[c]
        if p != c:
            y[c], y[p] = y[p], y[c]
        low = c
        top = max(top, abs(value))
        quiet = quiet + 1 if abs(value) <= share * top else 0
        if c < i and quiet > wide + lower:
            break
    return low, min(high + lower, size - 1)


@compiled
def _images(  # type: ignore[no-untyped-def]
    lower, upper, rows, packed, swapped, share, rounding, first, last, excess, error, defects, out
):
    """|B| excess, plus (|BA − I| and its rounding) error, for some rows of B.

    ``excess`` and ``error`` have shape (size, joints); a row's own part stands in ``out``.
    """
    size, joints = excess.shape
    y, worst = np.zeros(size), np.zeros(joints)
    for i in range(first, last):
        low, high = _inverse_row(lower, upper, packed, swapped, i, share, y)
        for j in range(joints):
            worst[j] = 0.0
        for r in range(low, high + 1):
            weight = abs(y[r])
            for j in range(joints):
                worst[j] += weight * excess[r, j]
        for c in range(max(0, low - lower), min(size, high + upper + 1) if defects else 0):
            found = -1.0 if c == i else 0.0
            sizes = 0.0
            for r in range(max(low, c - upper), min(high, c + lower) + 1):
                term = y[r] * rows[r, c - r + lower]
                found += term
                sizes += abs(term)
            defect = abs(found) + rounding * sizes
            for j in range(joints):
                worst[j] += defect * error[c, j]
        for j in range(joints):
            out[i, j] = worst[j]
        for r in range(low, high + 1):
            y[r] = 0.0


def image(factors: Factors, share: float, excess: Array, error: Array | None) -> Array:
    """|B||r| + |I − BA| e with entries of B below ``share`` of their row's largest left out.

    Parameters
    ----------
    factors : Factors
        Of A.
    share : float
    excess : ndarray, shape (size, joints)
        |r|.
    error : ndarray, shape (size, joints), or None
        e; None for 0.

    Returns
    -------
    ndarray, shape (size, joints)
        Rounding errors of BA, of A's entries to float64, and of these sums are included.
    """
    size = len(excess)
    out = np.empty_like(excess)
    rounding = float(np.finfo(np.float64).eps) * (factors.lower + factors.upper + 5)
    given = (factors.lower, factors.upper, factors.rows, factors.packed, factors.swapped)

    def run(first: int) -> None:
        last = min(first + _PART, size)
        _images(*given, share, rounding, first, last, excess, known, error is not None, out)

    known = excess if error is None else error
    _in_threads(run, range(0, size, _PART))
    return np.asarray(_SUMS * out)


def _in_threads(run: Callable[[int], None], parts: range) -> None:
    if len(parts) == 1:
        run(parts[0])
        return
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(run, parts))
