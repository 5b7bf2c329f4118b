"""Many boxes of directions at once: rows in Bernstein form, as floats that only propose."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ..exact import ExactProblem
from .ratios import POWERS
from .rows import (
    PLACES,
    STRICT,
    TOTAL,
    PieceRow,
    Prover,
    on_square,
    shape_for,
    static_rows,
)
from .square_polynomials import MONOMIALS, SHARES, SUM, padded, power, times

MOST_PLACES = 8
"""Rows at places in the program of one box: the heaviest. An optimum in
three durations seldom has more than three active limits."""
_GRID = 65
"""Places where a curve is scanned for its peaks; Newton steps from there find the place."""
_SLACK = 1e-13
"""What floats may be below 0 and the exact test is tried all the same: about their rounding."""
_DIGITS = (4, 9)
"""Digits of the weights: few, or enough for steep rows."""

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Boxes:
    """Dyadic boxes: side i of box n is [index, index + 1]/2^level, arrays of shape (boxes, 2)."""

    level: Ints
    index: Ints

    def __len__(self) -> int:
        return len(self.level)

    def pick(self, which: NDArray[np.bool_] | Ints | slice) -> Boxes:
        """Some of the boxes."""
        return Boxes(self.level[which], self.index[which])

    def sides(self, n: int) -> tuple[tuple[int, int], tuple[int, int]]:
        """(level, index) of both sides of one box."""
        (la, lb), (ia, ib) = self.level[n].tolist(), self.index[n].tolist()
        return (la, ia), (lb, ib)

    def halves(self, axis: Ints) -> Boxes:
        """Both halves of every box across its axis, lower halves first."""
        each = np.arange(len(self))
        level = self.level.copy()
        level[each, axis] += 1
        low, high = self.index.copy(), self.index.copy()
        low[each, axis] *= 2
        high[each, axis] = 2 * high[each, axis] + 1
        return Boxes(np.vstack([level, level]), np.vstack([low, high]))


Proof = tuple[tuple[PieceRow, ...], tuple[Fraction, ...]]


class Proposer:
    """Proposes rows and weights for boxes, and the axis to halve where none is found."""

    def __init__(self, problem: ExactProblem, total: Fraction) -> None:
        self.problem, self.prover = problem, Prover(problem, total)
        self.size = self.prover.size
        self.static = static_rows(problem)
        self._static = np.array(
            [self.prover.row(row).astype(float) for row in self.static]
        ).reshape(-1, self.size, self.size)
        self._shape = shape_for(problem)
        self._segments = np.array([piece.segment for piece in self._shape.pieces])
        monomials = self._shape.monomials
        shape = (len(self._segments), len(problem.joints), len(monomials), POWERS)
        self._above = np.zeros(shape)
        self._below = np.zeros((shape[0], shape[2]))
        for g, piece in enumerate(self._shape.pieces):
            self._below[g] = [piece.below.get(key, 0) for key in monomials]
            for j, angles in enumerate(zip(*problem.waypoints, strict=True)):
                for key, powers in piece.above(angles).items():
                    self._above[g, j, monomials.index(key)] = [float(c) for c in powers]
        caps: list[tuple[int, float]] = [(TOTAL, float(total))]
        for g, upper in enumerate(problem.duration_upper):
            if upper is not None:
                caps.append((g, float(upper * (1 + STRICT))))
        self._limits: list[tuple[int, int, int, int, float]] = []
        self._collect_limits()
        self._caps = [c for c, _ in caps]
        self._cap_values = np.array([v for _, v in caps])
        orders = sorted({r for _, _, r, _, _ in self._limits})
        self._orders = orders
        tensors = []
        each = [MONOMIALS[key] for key in monomials]
        for cap in self._caps:
            hold = SUM if cap == TOTAL else SHARES[cap]
            for piece in self._shape.pieces:
                below = on_square({key: Fraction(c) for key, c in piece.below.items()})
                for r in orders:
                    parts = [times(m, power(hold, r)) for m in each] if r else [*each]
                    parts.append(times(below, power(SHARES[piece.segment], r)))
                    tensors.append([padded(p, self.size).astype(float) for p in parts])
        wide = (len(self._caps), shape[0], len(orders), len(each) + 1, self.size, self.size)
        self._tensors = np.array(tensors, dtype=np.float64).reshape(wide)
        self._grid = np.linspace(0.0, 1.0, _GRID)
        self._on_grid = self._grid[None, :] ** np.arange(POWERS)[:, None]
        n = self.size - 1
        self._comb = np.array(
            [[math.comb(j, k) for j in range(n + 1)] for k in range(n + 1)], float
        )
        self._to_bernstein = np.array(
            [[math.comb(i, k) / math.comb(n, k) for k in range(n + 1)] for i in range(n + 1)]
        )

    def _collect_limits(self) -> None:
        problem = self.problem
        for g in range(len(self._segments)):
            for j in range(len(problem.joints)):
                for r in (1, 2, 3):
                    below, above = problem.sides(j, r)
                    for sign, limit in ((1, above), (-1, below)):
                        if limit is not None and limit.high > 0:
                            self._limits.append((g, j, r, sign, float(limit.high)))
                low, high = problem.position_lower[j], problem.position_upper[j]
                if high is not None:
                    self._limits.append((g, j, 0, 1, float(high.high)))
                if low is not None:
                    self._limits.append((g, j, 0, -1, -float(low.low)))
        # Twice: for the highest and the next highest peak.
        self._limits = [limit for limit in self._limits for _ in range(2)]
        sides = [limit[:4] for limit in self._limits]
        self._sides = np.array(sides, dtype=np.int64).reshape(-1, 4)
        self._bounds = np.array([limit[4] for limit in self._limits], dtype=np.float64)

    def _maps(self, boxes: Boxes) -> Array:
        """Matrices from power to local Bernstein coefficients, (boxes, 2, size, size).

        (start + width·t)ʲ = Σ_k C(j, k) start^(j − k) width^k t^k, and t^k has the Bernstein
        coefficients C(i, k)/C(n, k).
        """
        width = 0.5**boxes.level
        start = boxes.index * width
        k = np.arange(self.size)
        lag = np.maximum(k[None, :] - k[:, None], 0)
        shift = self._comb * start[..., None, None] ** lag * width[..., None, None] ** k[:, None]
        return np.asarray(self._to_bernstein @ shift)

    def _places(self, boxes: Boxes) -> tuple[Array, Ints, Ints]:
        """Coefficients (boxes, caps, K, monomials + 1) of the heaviest places, limits and place.

        A place weighs, at the centre of a box, the least duration that its limit leaves,
        (|q⁽ʳ⁾(s)|/limit)^(1/r), over the longest that the caps leave the segment.
        """
        width = 0.5**boxes.level
        a, b = ((boxes.index + 0.5) * width).T
        x, y = (1 - a) / a, (1 - b) / b
        mono = np.stack([x**i * y**j for i, j in self._shape.monomials], axis=1)
        below = mono @ self._below.T
        heavy = np.empty((len(boxes), len(self._limits)))
        place = np.empty((len(boxes), len(self._limits)), dtype=np.int64)
        shares = np.stack([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)], axis=1)
        longest = shares * (self._cap_values[0] / (1 - a * b))[:, None]
        for cap, value in zip(self._caps[1:], self._cap_values[1:], strict=True):
            longest = np.minimum(longest, value * shares / shares[:, cap, None])
        each = np.arange(len(boxes))
        curves: dict[tuple[int, int], Array] = {}
        grids: dict[tuple[int, int, int], Array] = {}
        for i, (g, j, r, sign, limit) in enumerate(self._limits):
            if (g, j) not in curves:
                curves[g, j] = mono @ self._above[g, j] / below[:, g, None]
            if (g, j, r) not in grids:
                grids[g, j, r] = _derived(curves[g, j], r) @ self._on_grid[: POWERS - r]
            curve = sign * grids[g, j, r]
            top = curve.argmax(axis=1)
            if i % 2:  # the next highest of the local maxima
                edge = np.full((len(boxes), 1), -np.inf)
                before = np.hstack([edge, curve[:, :-1]])
                after = np.hstack([curve[:, 1:], edge])
                peak = np.where((curve >= before) & (curve >= after), curve, -np.inf)
                peak[each, top] = -np.inf
                top = np.where(np.isfinite(peak.max(axis=1)), peak.argmax(axis=1), top)
            s = self._grid[top]
            # Two Newton steps towards the interior extremum, kept near the grid's best.
            for _ in range(2):
                slope = _at(_derived(curves[g, j], r + 1), s)
                bend = _at(_derived(curves[g, j], r + 2), s) if r + 2 < 5 else np.zeros_like(s)
                with np.errstate(divide="ignore", invalid="ignore"):
                    step = np.where(sign * bend < 0, -slope / bend, 0.0)
                s = np.clip(s + np.clip(step, -1 / _GRID, 1 / _GRID), 0.0, 1.0)
            place[:, i] = np.rint(s * PLACES)
            value = sign * _at(_derived(curves[g, j], r), place[:, i] / PLACES)
            if r == 0:
                heavy[:, i] = 1.0 + (value - limit) / max(1.0, abs(limit))
            else:
                heavy[:, i] = (
                    np.maximum(value / limit, 0.0) ** (1 / r) / longest[:, self._segments[g]]
                )
        count = min(MOST_PLACES, len(self._limits))
        chosen = np.argsort(-heavy, axis=1)[:, :count]
        s = place[each[:, None], chosen] / PLACES
        coefficients = np.zeros((len(boxes), len(self._caps), count, mono.shape[1] + 1))
        pieces, joints, orders, signs = self._sides[chosen].transpose(2, 0, 1)
        bounds = self._bounds[chosen]
        for r in self._orders:
            powers = s[..., None] ** np.arange(POWERS - r)
            above = _derived(self._above, r)[pieces, joints]
            weights = np.einsum("nkmp,nkp->nkm", above, powers) * signs[..., None]
            for c, cap in enumerate(self._cap_values):
                scale = np.where(orders > 0, bounds * cap**r, 1.0)
                right = np.where(orders > 0, 1.0, bounds + float(STRICT))
                part = np.concatenate([weights / scale[..., None], -right[..., None]], axis=-1)
                coefficients[:, c] = np.where((orders == r)[..., None], part, coefficients[:, c])
        return coefficients, chosen, place[each[:, None], chosen]

    def propose(self, boxes: Boxes) -> tuple[list[Proof | None], Ints]:
        """Proofs, checked exactly, and for every box the axis to halve."""
        maps = self._maps(boxes)
        left, right = maps[:, 0], np.swapaxes(maps[:, 1], 1, 2)
        static = left[:, None] @ self._static @ right[:, None]
        coefficients, chosen, place = self._places(boxes)
        piece, order = self._sides[chosen][..., 0], self._sides[chosen][..., 2]
        local = left[:, None, None, None, None] @ self._tensors @ right[:, None, None, None, None]
        count = chosen.shape[1]
        each = np.arange(len(boxes))[:, None]
        blocks = [static]
        for c in range(len(self._caps)):
            mine = local[each, c, piece, np.searchsorted(self._orders, order)]
            blocks.append(np.einsum("nkq,nkqij->nkij", coefficients[:, c], mine))
        table = np.concatenate(blocks, axis=1)
        scale = np.abs(table).max(axis=(2, 3), keepdims=True)
        table = table / np.where(scale > 0, scale, 1.0)
        lowest = table.min(axis=(2, 3))
        order_by = np.argsort(-lowest, axis=1)
        hopeful = (table.max(axis=1) >= -_SLACK).all(axis=(1, 2))
        best = np.take_along_axis(table, order_by[:, :1, None, None], axis=1)[:, 0]
        along_a = np.abs(np.diff(best, axis=1)).max(axis=(1, 2))
        along_b = np.abs(np.diff(best, axis=2)).max(axis=(1, 2))
        axis = np.where(along_b > along_a, 1, 0)
        gap = boxes.level[:, 0] - boxes.level[:, 1]
        axis = np.where(gap > 2, 1, np.where(gap < -2, 0, axis))
        proofs: list[Proof | None] = []

        def row_of(n: int, k: int) -> PieceRow:
            if k < len(self.static):
                return self.static[k]
            c, i = divmod(k - len(self.static), count)
            g, j, r, sign, _ = self._limits[chosen[n, i]]
            kind = self._shape.pieces[g].kind
            return PieceRow(kind, j, r, sign, int(place[n, i]), self._caps[c])

        for n in range(len(boxes)):
            proof: Proof | None = None
            sides = boxes.sides(n)
            for k in order_by[n, :2]:
                if lowest[n, k] < -_SLACK:
                    break
                alone = ((row_of(n, int(k)),), (Fraction(1),))
                if self.prover.proves(*alone, *sides):
                    proof = alone
                    break
            if proof is None and hopeful[n]:
                flat = table[n].reshape(table.shape[1], -1)
                found = _game(flat)
                if found is not None:
                    natural = found / np.where(scale[n, :, 0, 0] > 0, scale[n, :, 0, 0], np.inf)
                    for digits in _DIGITS:
                        tried = _rounded(natural, digits, partial(row_of, n))
                        if tried is not None and self.prover.proves(*tried, *sides):
                            proof = tried
                            break
            proofs.append(proof)
        return proofs, axis.astype(np.int64)


def _rounded(weights: Array, digits: int, row_of: Callable[[int], PieceRow]) -> Proof | None:
    top = float(weights.max())
    if not top > 0:
        return None
    kept = [int(k) for k in np.flatnonzero(weights > 10.0 ** (-digits - 3) * top)]
    values = tuple(Fraction(f"{weights[k] / top:.{digits - 1}e}") for k in kept)
    return tuple(row_of(k) for k in kept), values


def _derived(curves: Array, order: int) -> Array:
    """Derivative of polynomials whose ascending coefficients lie along the last axis."""
    scale = [math.perm(p, order) for p in range(order, curves.shape[-1])]
    return np.asarray(curves[..., order:] * np.array(scale, dtype=np.float64))


def _at(coefficients: Array, s: Array) -> Array:
    """Polynomials of shape (boxes, powers), ascending, each at its own s."""
    total = np.zeros_like(s)
    for p in range(coefficients.shape[1] - 1, -1, -1):
        total = total * s + coefficients[:, p]
    return total


def _game(table: Array) -> Array | None:
    """Weights ≥ 0 of the rows of ``table`` whose sum has the largest least entry, if positive."""
    rows, columns = table.shape
    cost = np.append(np.zeros(rows), -1.0)
    matrix = np.hstack([-table.T, np.ones((columns, 1))])
    from scipy.optimize import linprog  # a quarter of a second, and few need it

    result = linprog(
        cost,
        A_ub=matrix,
        b_ub=np.zeros(columns),
        A_eq=np.append(np.ones(rows), 0.0)[None, :],
        b_eq=[1.0],
        bounds=[(0, None)] * rows + [(None, None)],
        method="highs",
    )
    if result.status != 0 or result.x[-1] < -_SLACK:
        return None
    weights: Array = np.maximum(result.x[:-1], 0.0)
    return weights
