"""Many boxes of directions at once: 3-5-3 rows in Bernstein form, as floats that only propose."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from .exact import ExactProblem
from .three_piece import (
    HERMITE,
    MONOMIALS,
    PLACES,
    SHARES,
    SQUARE,
    STRICT,
    SUM,
    TOTAL,
    Array,
    Prover,
    Row,
    padded,
    power,
    static_rows,
    times,
)

MOST_PLACES = 8
_GRID = 65
_SLACK = 1e-13
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


Proof = tuple[tuple[Row, ...], tuple[Fraction, ...]]


class Proposer:
    """Proposes rows and weights for boxes, and the axis to halve where none is found."""

    def __init__(self, problem: ExactProblem, total: Fraction) -> None:
        self.problem, self.prover = problem, Prover(problem, total)
        self.size = self.prover.size
        self.static = static_rows(problem)
        self._static = np.array(
            [self.prover.row(row).astype(float) for row in self.static]
        ).reshape(-1, self.size, self.size)
        q = np.array([[float(x) for x in row] for row in problem.waypoints])
        self._start = q[1]
        d1, d2, d3 = np.diff(q, axis=0)
        self._steps = np.stack([d2, 3 * d1, 6 * d1, 3 * d3, -6 * d3])
        caps: list[tuple[int, float]] = [(TOTAL, float(total))]
        for g, upper in enumerate(problem.duration_upper):
            if upper is not None:
                caps.append((g, float(upper * (1 + STRICT))))
        self._limits: list[tuple[int, int, int, float]] = []
        self._collect_limits()
        self._caps = [c for c, _ in caps]
        self._cap_values = np.array([v for _, v in caps])
        orders = sorted({r for _, r, _, _ in self._limits})
        self._orders = orders
        tensors = []
        for cap in self._caps:
            hold = SUM if cap == TOTAL else SHARES[cap]
            for r in orders:
                parts = [times(m, power(hold, r)) for m in MONOMIALS]
                parts.append(times(SQUARE, power(SHARES[1], r)))
                if r == 0:
                    parts = [*MONOMIALS, SQUARE]
                tensors.append([padded(p, self.size).astype(float) for p in parts])
        shape = (len(self._caps), len(orders), 6, self.size, self.size)
        self._tensors = np.array(tensors, dtype=np.float64).reshape(shape)
        s = np.linspace(0.0, 1.0, _GRID)
        base = np.array([[float(x) for x in row] for row in HERMITE])
        self._hermite = []
        for r in range(5):
            powers = np.arange(r, 6)
            scale = np.array([math.perm(p, r) for p in powers])
            self._hermite.append(base[:, r:] * scale)
        self._grid = s
        self._on_grid = [h @ s[None, :] ** np.arange(h.shape[1])[:, None] for h in self._hermite]
        n = self.size - 1
        self._comb = np.array(
            [[math.comb(j, k) for j in range(n + 1)] for k in range(n + 1)], float
        )
        self._to_bernstein = np.array(
            [[math.comb(i, k) / math.comb(n, k) for k in range(n + 1)] for i in range(n + 1)]
        )

    def _collect_limits(self) -> None:
        problem = self.problem
        for j in range(len(problem.joints)):
            for r, limit in enumerate(problem.limits[j], start=1):
                if limit is not None and limit.high > 0:
                    self._limits += [(j, r, sign, float(limit.high)) for sign in (1, -1)]
            low, high = problem.position_lower[j], problem.position_upper[j]
            if high is not None:
                self._limits.append((j, 0, 1, float(high.high)))
            if low is not None:
                self._limits.append((j, 0, -1, -float(low.low)))
        # Twice: for the highest and the next highest peak.
        self._limits = [limit for limit in self._limits for _ in range(2)]

    def _maps(self, boxes: Boxes) -> Array:
        """Matrices from power to local Bernstein coefficients, (boxes, 2, size, size)."""
        width = 0.5**boxes.level
        start = boxes.index * width
        k = np.arange(self.size)
        lag = np.maximum(k[None, :] - k[:, None], 0)
        shift = self._comb * start[..., None, None] ** lag * width[..., None, None] ** k[:, None]
        return np.asarray(self._to_bernstein @ shift)

    def _places(self, boxes: Boxes) -> tuple[Array, Ints, Ints]:
        """Coefficients (boxes, caps·K, 6) of the heaviest places, their limits and place."""
        width = 0.5**boxes.level
        a, b = ((boxes.index + 0.5) * width).T
        x, y = (1 - a) / a, (1 - b) / b
        mono = np.stack([np.ones_like(x), x, x * x, y, y * y], axis=1)
        heavy = np.empty((len(boxes), len(self._limits)))
        place = np.empty((len(boxes), len(self._limits)), dtype=np.int64)
        shares = np.stack([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)], axis=1)
        shortest = shares[:, 1] * self._cap_values[0] / (1 - a * b)
        for i, cap in enumerate(self._caps[1:], start=1):
            shortest = np.minimum(shortest, self._cap_values[i] * shares[:, 1] / shares[:, cap])
        each = np.arange(len(boxes))
        curves: dict[tuple[int, int], Array] = {}
        for i, (j, r, sign, limit) in enumerate(self._limits):
            weights = mono * self._steps[:, j]
            if (j, r) not in curves:
                curves[j, r] = weights @ self._on_grid[r]
            curve = sign * curves[j, r]
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
                slope = _at(weights @ self._hermite[r + 1], s)
                bend = _at(weights @ self._hermite[r + 2], s) if r + 2 < 5 else np.zeros_like(s)
                with np.errstate(divide="ignore", invalid="ignore"):
                    step = np.where(sign * bend < 0, -slope / bend, 0.0)
                s = np.clip(s + np.clip(step, -1 / _GRID, 1 / _GRID), 0.0, 1.0)
            place[:, i] = np.rint(s * PLACES)
            value = sign * _at(weights @ self._hermite[r], place[:, i] / PLACES)
            if r == 0:
                value = value + sign * self._start[j]
                heavy[:, i] = 1.0 + (value - limit) / max(1.0, abs(limit))
            else:
                heavy[:, i] = np.maximum(value / limit, 0.0) ** (1 / r) / shortest
        count = min(MOST_PLACES, len(self._limits))
        chosen = np.argsort(-heavy, axis=1)[:, :count]
        s = place[each[:, None], chosen] / PLACES
        coefficients = np.zeros((len(boxes), len(self._caps), count, 6))
        orders = np.array([r for _, r, _, _ in self._limits])[chosen]
        joints = np.array([j for j, _, _, _ in self._limits])[chosen]
        signs = np.array([g for _, _, g, _ in self._limits], dtype=float)[chosen]
        bounds = np.array([v for _, _, _, v in self._limits])[chosen]
        for r in self._orders:
            powers = s[..., None] ** np.arange(self._hermite[r].shape[1])
            weights = (powers @ self._hermite[r].T) * self._steps.T[joints] * signs[..., None]
            if r == 0:
                weights[..., 0] += signs * self._start[joints]
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
        order = np.array([r for _, r, _, _ in self._limits], dtype=np.int64)[chosen]
        local = left[:, None, None, None] @ self._tensors @ right[:, None, None, None]
        count = chosen.shape[1]
        each = np.arange(len(boxes))[:, None]
        blocks = [static]
        for c in range(len(self._caps)):
            mine = local[each, c, np.searchsorted(self._orders, order)]
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

        def row_of(n: int, k: int) -> Row:
            if k < len(self.static):
                return self.static[k]
            c, i = divmod(k - len(self.static), count)
            j, r, sign, _ = self._limits[chosen[n, i]]
            return Row("place", j, r, sign, int(place[n, i]), self._caps[c])

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


def _rounded(weights: Array, digits: int, row_of: Callable[[int], Row]) -> Proof | None:
    top = float(weights.max())
    if not top > 0:
        return None
    kept = [int(k) for k in np.flatnonzero(weights > 10.0 ** (-digits - 3) * top)]
    values = tuple(Fraction(f"{weights[k] / top:.{digits - 1}e}") for k in kept)
    return tuple(row_of(k) for k in kept), values


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
