"""Linear programs that propose weights: McCormick bounds of the products over a box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import coo_array, csr_array, hstack, vstack

from ....problem import Array
from ....verify import MIX
from ....verify.cubic import FINE, Box
from .system import CubicRow, CubicSystem

_TANGENTS = 5
"""Of 1/T and of ρ over a side: what they miss falls with the square of the box; rows cost time."""
_LARGEST = 2**22
"""Of the integer weights."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """Optimum of a linear program, and what it proves.

    Attributes
    ----------
    target : dict
        Weights of the coordinates in what is bounded from below; empty for a box that is empty.
    value : float
        Bound of the target; positive without one if the box is empty.
    rows : list of CubicRow
    weights : list
        [row, w, …] by their numbers in ``rows``, and [equation, μ, …].
    mix : ndarray of int, shape (joints, coordinates, unknowns)
        Share, in 1/MIX, of the bound of a product that is exact where the unknown is lowest.
    point : ndarray, shape (coordinates,)
    unknowns : ndarray, shape (joints used, unknowns)
    products : ndarray, shape (joints used, pairs)
    """

    target: dict[int, int]
    value: float
    rows: list[CubicRow]
    weights: tuple[list[int], list[int]]
    mix: NDArray[np.int64]
    point: Array
    unknowns: Array
    products: Array


class Relaxation:
    """The relaxation of one system under some conditions, to be written down for boxes.

    Each condition is divided by its own constant: ``by``. Its entries stand in columns of its own
    joint alone: coordinates, unknowns, products.
    """

    def __init__(self, system: CubicSystem, rows: list[CubicRow]) -> None:
        self.system, self.rows = system, [*rows, CubicRow("total")]
        terms = [system.terms(row)[1] for row in self.rows]
        used = np.abs(system.linear).sum(axis=1) > 0
        for t in terms:
            used |= t.product != 0
        k, i = np.nonzero(used)
        self.pairs = list(zip(k.tolist(), i.tolist(), strict=True))
        self.equations = np.hstack([system.fixed, system.linear[k, :, i].T])
        self.by = np.array([abs(t.constant) or np.abs(t.along).max() for t in terms])
        self.right = -np.array([t.constant for t in terms]) / self.by
        self.joint = np.array([row.joint for row in self.rows])
        dense = [np.concatenate([t.along, t.alone, t.product[k, i]]) for t in terms]
        self.entries = coo_array(np.array(dense) / self.by[:, None])


def _sparse(rows: list[dict[int, float]], columns: int) -> csr_array:
    """A matrix from its rows."""
    row = [i for i, entries in enumerate(rows) for _ in entries]
    column = [c for entries in rows for c in entries]
    value = [x for entries in rows for x in entries.values()]
    return csr_array((value, (row, column)), shape=(len(rows), columns))


class BoxProgram:
    """The linear program of a relaxation over one box."""

    def __init__(self, relaxation: Relaxation, box: Box) -> None:
        self.relaxation, self.box = relaxation, box
        exact = relaxation.system.exact
        self.low, self.high = np.array(box.sides(exact), dtype=np.float64).T
        self.joints = np.array([j for j, row in enumerate(box.x) if None not in row], np.int64)
        self.size, self.count = exact.size, len(relaxation.pairs)
        self.first = exact.coordinates + exact.m
        self.columns = self.first + len(self.joints) * (self.size + self.count)
        ranges = np.array([box.x[j] for j in self.joints], dtype=np.float64) / FINE
        low, high = np.moveaxis(ranges.reshape(-1, self.size, 2), 2, 0)
        blocks = (self._conditions(), self._simple(), self._products(low, high))
        self.matrix = vstack([matrix for matrix, _ in blocks], format="csr")
        self.right = np.concatenate([right for _, right in blocks])
        self.equations, self.equal = self._equations()
        bounds = np.full((self.columns, 2), [-np.inf, np.inf])
        bounds[: exact.coordinates] = np.column_stack([self.low, self.high])
        for j in range(len(self.joints)):
            at = self.first + j * (self.size + self.count)
            bounds[at : at + self.size] = np.column_stack([low[j], high[j]])
        self.bounds = bounds

    def _conditions(self) -> tuple[csr_array, Array]:
        """Those of joints that take part."""
        relaxation, coordinates = self.relaxation, self.relaxation.system.exact.coordinates
        place = np.full(relaxation.system.exact.joints, -1)
        place[self.joints] = np.arange(len(self.joints))
        own = place[relaxation.joint]
        held = (relaxation.joint < 0) | (own >= 0)
        self.held = np.flatnonzero(held)
        entries = relaxation.entries
        some = held[entries.row]
        row, column, value = entries.row[some], entries.col[some], entries.data[some]
        at = self.first + own[row] * (self.size + self.count) - coordinates
        column = np.where(column < coordinates, column, column + at)
        shape = (len(self.held), self.columns)
        matrix = csr_array((value, ((np.cumsum(held) - 1)[row], column)), shape=shape)
        return matrix, relaxation.right[held]

    def _simple(self) -> tuple[csr_array, Array]:
        """Bounds of 1/T and of ρ = h²/T.

        1/T ≥ 2/τ − T/τ² and 1/T ≤ 1/l + 1/u − T/lu for l ≤ T ≤ u; ρ ≥ 2θh − θ²T for any θ, and
        ρ ≤ h²/l ≤ ((h_l + h_u)h − h_l h_u)/l, or ρ ≤ h where l is 0.
        """
        system, low, high = self.relaxation.system, self.low, self.high
        rows: list[dict[int, float]] = []
        right: list[float] = []
        for t in np.flatnonzero(system.moving & (low[: system.exact.m] > 0)).tolist():
            z = system.exact.coordinates + t
            for place in np.geomspace(low[t], high[t], _TANGENTS):
                rows.append({z: -1.0, t: -1.0 / place**2})
                right.append(-2.0 / place)
            rows.append({z: 1.0, t: 1.0 / (low[t] * high[t])})
            right.append(1.0 / low[t] + 1.0 / high[t])
        for h, t, rho in system.exact.rho:
            top = min(1.0, high[h] / low[t]) if low[t] > 0 else 1.0
            for slope in np.linspace(low[h] / high[t], top, _TANGENTS - 1):
                rows.append({h: 2 * slope, t: -(slope**2), rho: -1.0})
                right.append(0.0)
            chord = -(low[h] + high[h]) / low[t] if low[t] > 0 else -1.0
            rows.append({rho: 1.0, h: chord})
            right.append(-low[h] * high[h] / low[t] if low[t] > 0 else 0.0)
        return _sparse(rows, self.columns), np.array(right)

    def _products(self, low: Array, high: Array) -> tuple[csr_array, Array]:
        """Four bounds of every product: below and above, exact where the unknown is low or high.

        McCormick's: y·x ≥ corner·x + edge·y − corner·edge at the two equal corners (low, low) and
        (high, high) of the box, ≤ at the two others.
        """
        pairs = self.relaxation.pairs
        k = np.array([p[0] for p in pairs])
        i = np.array([p[1] for p in pairs])
        begin = self.first + np.arange(len(self.joints)) * (self.size + self.count)
        product = begin[:, None] + self.size + np.arange(self.count)
        unknown = begin[:, None] + i
        least = np.broadcast_to(self.low[k], product.shape)
        most = np.broadcast_to(self.high[k], product.shape)
        one = np.ones(product.shape)
        blocks, right = [], []
        for corner, edge, sign in (
            (least, low[:, i], -1.0),
            (most, high[:, i], -1.0),
            (most, low[:, i], 1.0),
            (least, high[:, i], 1.0),
        ):
            values = np.stack([sign * one, -sign * corner, -sign * edge], axis=-1).ravel()
            columns = np.stack(
                [product, unknown, np.broadcast_to(k, product.shape)], axis=-1
            ).ravel()
            row = np.repeat(np.arange(product.size), 3)
            blocks.append(csr_array((values, (row, columns)), shape=(product.size, self.columns)))
            right.append((-sign * corner * edge).ravel())
        return vstack(blocks), np.concatenate(right)

    def _equations(self) -> tuple[csr_array, Array]:
        system, width = self.relaxation.system, self.size + self.count
        block, parts = csr_array(self.relaxation.equations), []
        spans = np.flatnonzero(system.moving)
        for j, joint in enumerate(self.joints):
            front = np.zeros((self.size, self.first))
            front[system.which[spans], system.exact.coordinates + spans] = -system.steps[
                spans, joint
            ]
            before = csr_array((self.size, j * width))
            after = csr_array((self.size, (len(self.joints) - j - 1) * width))
            parts.append(hstack([csr_array(front), before, block, after]))
        if not parts:
            return csr_array((0, self.columns)), np.zeros(0)
        return vstack(parts, format="csr"), np.zeros(self.size * len(self.joints))

    def bound(self, target: dict[int, int], capped: bool = True) -> Proposal | None:
        """Propose weights for a bound of a target; None if the program has no solution."""
        cost = np.zeros(self.columns)
        cost[list(target)] = list(target.values())
        right = self.right.copy()
        if not capped:
            right[len(self.held) - 1] = 1e6  # stands for "not limited"
        found = linprog(
            cost,
            A_ub=self.matrix,
            b_ub=right,
            A_eq=self.equations,
            b_eq=self.equal,
            bounds=self.bounds,
            method="highs-ds",
        )
        if found.status != 0:
            return None
        return self._proposal(
            target, found.x, found.fun, -found.ineqlin.marginals, -found.eqlin.marginals
        )

    def emptiness(self) -> Proposal | None:
        """Propose weights that show the box to be empty: least violation of all conditions."""
        limits, equations = len(self.held), self.equations.shape[0]
        loose = np.zeros((self.matrix.shape[0], 1))
        loose[:limits] = -1.0
        ones = np.ones((equations, 1))
        matrix = vstack(
            [
                hstack([self.matrix, csr_array(loose)]),
                hstack([self.equations, csr_array(-ones)]),
                hstack([-self.equations, csr_array(-ones)]),
            ]
        )
        cost = np.append(np.zeros(self.columns), 1.0)
        found = linprog(
            cost,
            A_ub=matrix,
            b_ub=np.concatenate([self.right, self.equal, -self.equal]),
            bounds=np.vstack([self.bounds, [0.0, np.inf]]),
            method="highs-ds",
        )
        if found.status != 0 or found.fun <= 1e-9:
            return None
        dual = -found.ineqlin.marginals
        count = self.matrix.shape[0]
        equal = dual[count : count + equations] - dual[count + equations :]
        return self._proposal({}, found.x[:-1], found.fun, dual[:count], equal)

    def _proposal(
        self, target: dict[int, int], x: Array, value: float, dual: Array, equal: Array
    ) -> Proposal:
        exact, relaxation, size = self.relaxation.system.exact, self.relaxation, self.size
        limits = np.maximum(dual[: len(self.held)], 0.0) / relaxation.by[self.held]
        top = max(float(bool(target)), float(limits.max(initial=0.0)))
        unit = _LARGEST / max(top, float(np.abs(equal).max(initial=0.0)))
        # Those without weight take no part.
        held = np.rint(limits * unit).astype(np.int64)
        pulled = np.rint(equal * unit).astype(np.int64)
        some, others = np.flatnonzero(held), np.flatnonzero(pulled)
        equations = self.joints[others // size] * size + others % size
        # A product's four bounds as in `_products`: the first and the third are exact where the
        # unknown is lowest.
        parts = np.maximum(dual[dual.size - 4 * len(self.joints) * self.count :], 0.0)
        parts = parts.reshape(4, len(self.joints), self.count)
        lowest, highest = parts[0] + parts[2], parts[1] + parts[3]
        with np.errstate(invalid="ignore"):
            share = np.where(lowest + highest > 0, lowest / (lowest + highest), 0.5)
        mix = np.full((exact.joints, exact.coordinates, size), MIX // 2)
        for p, (k, i) in enumerate(relaxation.pairs):
            mix[self.joints, k, i] = np.rint(share[:, p] * MIX)
        blocks = x[self.first :].reshape(len(self.joints), size + self.count)
        return Proposal(
            {k: round(w * unit) for k, w in target.items()},
            float(value),
            relaxation.rows,
            (
                np.stack([self.held[some], held[some]], axis=1).ravel().tolist(),
                np.stack([equations, pulled[others]], axis=1).ravel().tolist(),
            ),
            mix,
            x[: exact.coordinates],
            blocks[:, :size],
            blocks[:, size:],
        )
