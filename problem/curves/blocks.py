"""Long splines: a linear system by blocks of segments, with a bound on the error of any solution.

The conditions at a break are divided between the segments at its two sides, so the system is
block tridiagonal, B_k x_{k−1} + D_k x_k + C_k x_{k+1} = r_k. With T_k near the inverse of
S_k = D_k − B_k T_{k−1} C_{k−1},

    w_k = T_k (r_k − z_k),    z_{k+1} = B_{k+1} w_k,    x_k = w_k − T_k C_k x_{k+1}

solves it but for G_k = T_k S_k − I, which is as small as rounding: exactly, w_k has a term −G_k x_k
more. Sizes instead of all numbers make a bound of the same recursion. Only the few numbers z_k,
and x_{k+1} as far as C_k meets it, pass from block to block, and the products |B_{k+1} T_k| and
|T_k C_k| fade with the distance nearly as a derivative at a break does (by 0.27 a segment for C2
cubics, 0.43 for C4 quintics), so the bound stays near the error. Nothing is assumed of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, over_rows
from .kernel import compiled
from .system import POSITIVE, System

_EPS = float(np.finfo(np.float64).eps)
"""Spacing of float64 at 1."""
_SUMS = 1.0 + 1e-6
"""Covers the rounding of sums of up to nine billion terms of one sign, through all blocks."""
ENTRY = 24 * _EPS
"""Relative rounding of an entry: of a ninth power of a ratio, a whole factor and a scale."""


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
    values, columns, order, cuts, lower, upper, entry, inverse, defect, carry, carry_doubt, after,
    after_doubt,
):  # fmt: skip
    """Write T_k, a bound on |G_k|, B_{k+1} T_k and T_k C_k of every block, and doubts of those two.

    B_k meets the last ``lower`` unknowns before a block, C_k the first ``upper`` after it. Below
    |G_k| stands |B_{k+1}| |G_k|.
    """
    most, width = inverse.shape[1], lower + upper + 1
    band, loose = np.empty((most, width)), np.empty(most)
    s, t, room, blur = np.empty((4, most, most))
    for k in range(cuts.size - 1):
        start, n = cuts[k], cuts[k + 1] - cuts[k]
        rounding = entry + 2.3e-16 * (n + lower + upper)
        band[:n] = 0.0
        for i in range(n):
            row, entries = order[start + i], 0
            for m in range(columns.shape[1]):
                if values[row, m] != 0.0:
                    band[i, columns[row, m] - (start + i) + lower] = values[row, m]
                    entries += 1
            # An entry alone is its row's scale: 1, and exact.
            loose[i] = rounding if entries > 1 else 0.0
        s[:n, :n] = 0.0
        for i in range(n):
            for c in range(max(0, i - lower), min(n, i + upper + 1)):
                s[i, c] = band[i, c - i + lower]
        for i in range(n):
            blur[i, :n] = loose[i] * np.abs(s[i, :n])
        last = start - cuts[k - 1] if k > 0 else 0
        for i in range(min(n, lower) if k > 0 else 0):
            for m in range(i, lower):
                b, p = band[i, m - i], last - lower + m
                if b == 0.0:
                    continue
                for c in range(upper):
                    s[i, c] -= b * after[k - 1, p, c]
                    doubt = after_doubt[k - 1, p, c] + rounding * abs(after[k - 1, p, c])
                    blur[i, c] += abs(b) * doubt
                for c in range(last):
                    carry[k - 1, i, c] += b * inverse[k - 1, p, c]
                    carry_doubt[k - 1, i, c] += rounding * abs(b * inverse[k - 1, p, c])
                    defect[k - 1, most + i, c] += 1.01 * abs(b) * defect[k - 1, p, c]
        room[:n, :n] = s[:n, :n]
        _inverted(room, n, t)
        inverse[k, :n, :n] = t[:n, :n]
        for i in range(n):
            for c in range(n):
                blur[i, c] += loose[i] * abs(s[i, c])
        for i in range(n):
            for c in range(n):
                found, doubt = -1.0 if c == i else 0.0, 0.0
                for m in range(n):
                    doubt += abs(t[i, m]) * blur[m, c]
                    term = t[i, m] * s[m, c]
                    if term != 0.0:  # the sum rounds, of exact entries too, unless it is 0 now
                        found += term
                        doubt += 1.2e-16 * abs(found)
                defect[k, i, c] = abs(found) + doubt
            for c in range(upper):
                for m in range(max(0, n + c - upper), n):
                    term = t[i, m] * band[m, n + c - m + lower]
                    after[k, i, c] += term
                    after_doubt[k, i, c] += rounding * abs(term)


@compiled
def _sweep(  # type: ignore[no-untyped-def]
    order, cuts, inverse, carry, after, sign, right, defect, size, out
):
    """Write x for a right-hand side by rows, with ``sign`` −1; its bound by sizes, with 1.

    ``size`` is that of an x of which w_k has |G_k| x_k more, or empty.
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
        for m in range(n if size.size > 0 else 0):
            for j in range(joints):
                for i in range(n):
                    out[start + i, j] += defect[k, i, m] * size[start + m, j]
                for i in range(lower):
                    carried[i, j] += defect[k, most + i, m] * size[start + m, j]
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
    inverse : ndarray, shape (blocks, largest, largest)
        T_k.
    defect : ndarray, shape (blocks, largest + bandwidth, largest)
        Bound on |G_k|, and on what B_{k+1} makes of it.
    carry, after : ndarray, shape (blocks, bandwidth, largest), (blocks, largest, bandwidth)
        B_{k+1} T_k and T_k C_k.
    carry_doubt, after_doubt : ndarray
        Bounds on the errors of both.
    """

    rows: System
    order: NDArray[np.int64]
    cuts: NDArray[np.int64]
    inverse: Array
    defect: Array
    carry: Array
    carry_doubt: Array
    after: Array
    after_doubt: Array

    def solve(self, right: NDArray[np.floating]) -> Array:
        """Solution for right-hand sides of shape (rows, joints), to rounding."""
        narrow = np.ascontiguousarray(right, dtype=np.float64)
        factors = (self.inverse, self.carry, self.after)
        return self._swept(factors, -1.0, narrow, np.empty((0, narrow.shape[1])))

    def bound(self, excess: Array) -> Array | None:
        """Bound on the error of what leaves residuals of these sizes, entry by entry, or None.

        By the recursion over sizes the error e keeps |e| ≤ F + N|e|, where F > 0 comes of the
        residuals and N of G. Take positive weights v with Nv ≤ θv, θ < 1. The bound
        u = F + Nv max(F/v)/(1 − θ) is at most v max(F/v)/(1 − θ), and so contains its own image,
        F + Nu ≤ u. N then shrinks a positive vector, so its spectral radius is below 1 and
        |e| ≤ u; no system with such a bound is singular. The sum of F over the joints makes good
        weights, as what residuals cause has its sizes.
        """
        sizes = (
            np.abs(self.inverse),
            np.abs(self.carry) + self.carry_doubt,
            np.abs(self.after) + self.after_doubt,
        )
        found = self._swept(sizes, 1.0, excess, np.empty((0, excess.shape[1])))
        found *= _SUMS
        found += POSITIVE
        largest = over_rows(np.maximum, found)
        # Each joint has its share, so F/v is nowhere above the joint's largest F.
        weights = (found @ (1.0 / largest))[:, None]
        more = _SUMS * self._swept(sizes, 1.0, np.zeros(weights.shape), weights)
        theta = float((more / weights).max())
        if not theta < 0.5:
            return None
        found += more * (largest * (_SUMS / (1.0 - theta)))
        return found

    def residual(self, values: Array, flat: NDArray[np.floating]) -> tuple[Array, Array]:
        """Right-hand sides less the rows times ``flat``, and a bound on the rounding of that."""
        out, doubt = np.empty(values.shape), np.empty(values.shape)
        rows, layout = self.rows, self.rows.layout
        columns = layout.entries[0]
        _residual(rows.values, columns, rows.factor, layout.orders, values, flat, ENTRY, out, doubt)
        return out, doubt

    def _swept(
        self, factors: tuple[Array, Array, Array], sign: float, right: Array, size: Array
    ) -> Array:
        out = np.empty(right.shape)
        _sweep(self.order, self.cuts, *factors, sign, right, self.defect, size, out)
        return out


def blocks_of(rows: System, segments: int) -> Blocks:
    """Factors by blocks of so many segments, and more where bands are wider than a block."""
    layout = rows.layout
    order, lower, upper = layout.order
    # No block is narrower than the bands: each meets its neighbours alone.
    step = max(segments, -(-max(lower, upper) // int(layout.degrees.min() + 1)))
    count = max(1, layout.segments // step)
    cuts = np.append(layout.first[: count * step : step], layout.first[-1])
    most = int(np.diff(cuts).max())
    inverse, defect = np.zeros((count, most, most)), np.zeros((count, most + lower, most))
    carry, after = np.zeros((count, lower, most)), np.zeros((count, most, upper))
    carry_doubt, after_doubt = np.zeros(carry.shape), np.zeros(after.shape)
    _factor(
        rows.values, layout.entries[0], order, cuts, lower, upper, ENTRY, inverse, defect, carry,
        carry_doubt, after, after_doubt,
    )  # fmt: skip
    return Blocks(rows, order, cuts, inverse, defect, carry, carry_doubt, after, after_doubt)
