"""Long splines: a linear system by blocks of segments, with a bound on the error of any solution.

The conditions at a break are divided between the segments at its two sides, so that the system is
block tridiagonal, B_k x_{k−1} + D_k x_k + C_k x_{k+1} = r_k. With T_k near the inverse of
S_k = D_k − B_k T_{k−1} C_{k−1},

    w_k = T_k (r_k − B_k w_{k−1}),    x_k = w_k − T_k C_k x_{k+1}

solves it but for G_k = T_k S_k − I, which is as small as rounding: exactly, w_k has a term −G_k x_k
more. Sizes in place of all numbers make a bound of the same recursion, and as a derivative at a
break fades with the distance (by 0.27 a segment for C2 cubics, 0.43 for C4 quintics), so do the
products of |T_k B_k| and |T_k C_k|: the bound stays near the error. Nothing is assumed of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .condition import Layout
from .kernel import compiled
from .system import System

_EPS = float(np.finfo(np.float64).eps)
"""Spacing of float64 at 1."""
_SUMS = 1.0 + 1e-9
"""Covers the rounding of sums of up to four million terms of one sign."""
_IMAGES = 3
"""Images of a bound that are taken: the first one is contained in what it is made from nearly
always."""
ENTRY = 24 * _EPS
"""Relative rounding of an entry: of a ninth power of a ratio, a whole factor and a scale."""
POSITIVE = 1e-290
"""Added to every bound, so that none is 0: far below any angle, far above the least float even
after division by hʳ."""


@compiled
def _inverted(s, n, t):  # type: ignore[no-untyped-def]
    """Write the inverse of ``s[:n, :n]``, which is destroyed, by Gauss and Jordan with pivots."""
    t[:n, :n] = 0.0
    for i in range(n):
        t[i, i] = 1.0
    for c in range(n):
        p = c
        for i in range(c + 1, n):
            p = i if abs(s[i, c]) > abs(s[p, c]) else p
        for m in range(n):
            s[c, m], s[p, m] = s[p, m], s[c, m]
            t[c, m], t[p, m] = t[p, m], t[c, m]
        pivot = s[c, c]
        for m in range(n):
            s[c, m] /= pivot
            t[c, m] /= pivot
        for i in range(n):
            share = s[i, c]
            if i == c or share == 0.0:
                continue
            for m in range(n):
                s[i, m] -= share * s[c, m]
                t[i, m] -= share * t[c, m]


@compiled
def _factor(  # type: ignore[no-untyped-def]
    values, columns, order, cuts, lower, upper, entry, inverse, defect, carry, after, doubt
):
    """Write T_k, a bound on |G_k|, B_{k+1} T_k and T_k C_k of every block.

    B_k meets the last ``lower`` unknowns before a block, C_k the first ``upper`` after it. The first
    page of ``doubt`` is of the carry, the second of what comes after; that of G_k carried, |B_{k+1}|
    |G_k|, stands below |G_k| in ``defect``.
    """
    most, width = inverse.shape[1], lower + upper + 1
    band, blur = np.empty((most, width)), np.empty((most, most))
    s, t = np.empty((most, most)), np.empty((most, most))
    for k in range(cuts.size - 1):
        start, n = cuts[k], cuts[k + 1] - cuts[k]
        rounding = entry + 2.3e-16 * (n + lower + upper)
        band[:n] = 0.0
        for i in range(n):
            row = order[start + i]
            for m in range(columns.shape[1]):
                if values[row, m] != 0.0:
                    band[i, columns[row, m] - (start + i) + lower] = values[row, m]
        s[:n, :n] = 0.0
        for i in range(n):
            for c in range(max(0, i - lower), min(n, i + upper + 1)):
                s[i, c] = band[i, c - i + lower]
        for i in range(n):
            for c in range(n):
                blur[i, c] = rounding * abs(s[i, c])
        last = start - cuts[k - 1] if k > 0 else 0
        for i in range(min(n, lower) if k > 0 else 0):
            for m in range(i, lower):
                b, p = band[i, m - i], last - lower + m
                size = abs(b)
                if b == 0.0:
                    continue
                for c in range(upper):
                    s[i, c] -= b * after[k - 1, p, c]
                    blur[i, c] += size * (
                        doubt[k - 1, 1, p, c] + rounding * abs(after[k - 1, p, c])
                    )
                for c in range(last):
                    carry[k - 1, i, c] += b * inverse[k - 1, p, c]
                    doubt[k - 1, 0, c, i] += rounding * size * abs(inverse[k - 1, p, c])
                    defect[k - 1, most + i, c] += (1.0 + rounding) * size * defect[k - 1, p, c]
        for i in range(n):
            for c in range(n):
                blur[i, c] += rounding * abs(s[i, c])
                defect[k, i, c] = s[i, c]
        _inverted(s, n, t)
        s[:n, :n] = defect[k, :n, :n]
        for i in range(n):
            for c in range(n):
                inverse[k, i, c] = t[i, c]
                found, size = -1.0 if c == i else 0.0, 0.0
                for m in range(n):
                    found += t[i, m] * s[m, c]
                    size += abs(t[i, m]) * blur[m, c]
                defect[k, i, c] = abs(found) + size
            for c in range(upper):
                found, size = 0.0, 0.0
                for m in range(max(0, n + c - upper), n):
                    found += t[i, m] * band[m, n + c - m + lower]
                    size += abs(t[i, m] * band[m, n + c - m + lower])
                after[k, i, c], doubt[k, 1, i, c] = found, rounding * size


@compiled
def _sweep(  # type: ignore[no-untyped-def]
    order, cuts, inverse, carry, after, right, defect, guess, sign, out
):
    """Write x for a right-hand side by rows, with ``sign`` −1.

    With sizes for all numbers and ``sign`` 1 it is the bound; what G_k times ``guess`` adds to it
    is then taken in, unless the guess is empty.
    """
    lower, upper, joints = carry.shape[1], after.shape[2], right.shape[1]
    most = inverse.shape[1]
    t, carried = np.empty((most, joints)), np.zeros((lower, joints))
    for k in range(cuts.size - 1):
        start, n = cuts[k], cuts[k + 1] - cuts[k]
        for i in range(n):
            for j in range(joints):
                t[i, j] = right[order[start + i], j]
                out[start + i, j] = 0.0
        for i in range(min(n, lower)):
            for j in range(joints):
                t[i, j] += sign * carried[i, j]
        carried[:] = 0.0
        for m in range(n):
            for i in range(n):
                if inverse[k, i, m] != 0.0:
                    for j in range(joints):
                        out[start + i, j] += inverse[k, i, m] * t[m, j]
            for i in range(lower):
                if carry[k, i, m] != 0.0:
                    for j in range(joints):
                        carried[i, j] += carry[k, i, m] * t[m, j]
        for m in range(n if guess.shape[0] > 0 else 0):
            for i in range(n):
                for j in range(joints):
                    out[start + i, j] += defect[k, i, m] * guess[start + m, j]
            for i in range(lower):
                for j in range(joints):
                    carried[i, j] += defect[k, most + i, m] * guess[start + m, j]
    for k in range(cuts.size - 3, -1, -1):
        for x in range(cuts[k], cuts[k + 1]):
            for m in range(upper):
                share = sign * after[k, x - cuts[k], m]
                if share != 0.0:
                    for j in range(joints):
                        out[x, j] += share * out[cuts[k + 1] + m, j]


@compiled
def _residual(  # type: ignore[no-untyped-def]
    values, columns, factor, orders, given, flat, entry, out, doubt
):
    """Write b − Ax by rows, and a bound on its rounding, summed up as each operation rounds.

    Entries of order 0 are 1: what is subtracted first, a position from its neighbour, is exact but
    for one rounding of the difference.
    """
    joints = given.shape[1]
    for i in range(values.shape[0]):
        rounding = entry if orders[i] > 0 else 0.0
        for j in range(joints):
            out[i, j] = factor[i] * given[i, j]
            doubt[i, j] = rounding * abs(out[i, j])
        for m in range(columns.shape[1]):
            a, c = values[i, m], columns[i, m]
            if a == 0.0:
                continue
            for j in range(joints):
                term = a * flat[c, j]
                out[i, j] -= term
                doubt[i, j] += rounding * abs(term) + 1.2e-16 * abs(out[i, j])


@dataclass(frozen=True, eq=False)
class Blocks:
    """A system's factors by blocks.

    Attributes
    ----------
    rows : System
        In float64.
    order : ndarray of int, shape (rows,)
        Row that stands at the place of each coefficient: its own where one gives it at once.
    cuts : ndarray of int, shape (blocks + 1,)
        First coefficient of each block.
    inverse, defect : ndarray, shape (blocks, largest, largest)
        T_k, and a bound on \\|G_k\\|.
    before, after, doubts : ndarray, shape (blocks, largest, bandwidth)
        T_k B_k, T_k C_k, and bounds on the errors of both.
    """

    rows: System
    order: NDArray[np.int64]
    cuts: NDArray[np.int64]
    inverse: Array
    defect: Array
    carry: Array
    after: Array
    doubt: Array

    def solve(self, right: NDArray[np.floating]) -> Array:
        """Solution for right-hand sides of shape (rows, joints), to rounding."""
        out, narrow = np.empty(right.shape), np.ascontiguousarray(right, dtype=np.float64)
        none = np.empty((0, right.shape[1]))
        _sweep(
            self.order, self.cuts, self.inverse, self.carry, self.after, narrow, self.defect, none,
            -1.0, out,
        )  # fmt: skip
        return out

    def bound(self, excess: Array) -> Array | None:
        """Bound on the error of what leaves residuals of these sizes, entry by entry, or None.

        The true error e keeps |e| ≤ F + N|e|, where F comes of the residual and N of G. Where an
        u contains its own image, F + Nu ≤ u, and F is positive, N shrinks a positive vector, so
        that its spectral radius is below 1 and |e| ≤ u; no system with such a bound is singular.
        """
        lower, upper = self.carry.shape[1], self.after.shape[2]
        sizes = (
            np.abs(self.inverse),
            np.abs(self.carry) + self.doubt[:, 0, :, :lower].transpose(0, 2, 1),
            np.abs(self.after) + self.doubt[:, 1, :, :upper],
        )
        found, guess = np.empty(excess.shape), np.empty((0, excess.shape[1]))
        for _ in range(_IMAGES):
            _sweep(self.order, self.cuts, *sizes, excess, self.defect, guess, 1.0, found)
            found *= _SUMS
            found += POSITIVE
            if len(guess) and (found <= guess).all():
                return found
            guess = 2.0 * found
        return None

    def residual(self, layout: Layout, values: Array, flat: Array) -> tuple[Array, Array]:
        """Right-hand sides less the rows times ``flat``, and a bound on the rounding of that."""
        out, doubt = np.empty(values.shape), np.empty(values.shape)
        rows = self.rows
        _residual(
            rows.values, rows.columns, rows.factor, layout.orders, values, flat, ENTRY, out, doubt
        )
        return out, doubt


def blocks_of(layout: Layout, rows: System, segments: int) -> Blocks:
    """Factors by blocks of so many segments, and more where bands are wider than a block."""
    order, lower, upper = layout.order
    cuts = [0]
    least = max(lower, upper)
    for c in layout.first[segments::segments].tolist():
        if c - cuts[-1] >= least:
            cuts.append(c)
    if int(layout.first[-1]) - cuts[-1] < least and len(cuts) > 1:
        cuts.pop()
    if cuts[-1] != layout.first[-1]:
        cuts.append(int(layout.first[-1]))
    at = np.array(cuts)
    count, most = at.size - 1, int(np.diff(at).max())
    inverse, defect = np.zeros((count, most, most)), np.zeros((count, most + lower, most))
    carry, after = np.zeros((count, lower, most)), np.zeros((count, most, upper))
    doubt = np.zeros((count, 2, most, max(lower, upper)))
    _factor(
        rows.values, rows.columns, order, at, lower, upper, ENTRY, inverse, defect, carry, after,
        doubt,
    )  # fmt: skip
    return Blocks(rows, order, at, inverse, defect, carry, after, doubt)
