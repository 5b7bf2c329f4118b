"""Linear programs that propose weights: McCormick bounds of the products over a box."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array, hstack, vstack

from ....problem import Array
from .proof import MIX, Target, Weights
from .ranges import Side, matrices
from .system import CubicRow, CubicSystem

_TANGENTS = 5
"""Of 1/T over a side: what they miss falls with the square of the box, and rows cost time."""
_SLOPES = 4
"""Tangents of ρ over a box: what they miss falls with its square, too."""
_LARGEST = 2**22
"""Of the integer weights."""
_SMALLEST = 0.6
"""Weights below it, in units of the rounding, are left out: those kept round to 1 or more."""
_BARRED = 1e6
"""Total that stands for "not limited"."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """Optimum of a linear program.

    Attributes
    ----------
    weights : Weights
    value : float
        Bound of the target; positive for `nothing` if the box is empty.
    point : ndarray, shape (coordinates,)
    unknowns : ndarray, shape (joints used, unknowns)
    products : ndarray, shape (joints used, pairs)
    """

    weights: Weights
    value: float
    point: Array
    unknowns: Array
    products: Array


class Relaxation:
    """The relaxation of one system under some conditions, to be written down for boxes."""

    def __init__(self, system: CubicSystem, rows: list[CubicRow], cap: Fraction) -> None:
        self.system, self.cap = system, cap
        self.rows = [*rows, CubicRow("total")]
        fixed, linear, _, _ = matrices(system)
        used = np.abs(linear).sum(axis=1) > 0
        terms = [system.row(row, cap) for row in self.rows]
        for t in terms:
            for pair in t.product:
                used[pair] = True
        self.pairs = [(int(k), int(i)) for k, i in np.argwhere(used)]
        self._number = {pair: p for p, pair in enumerate(self.pairs)}
        self._terms = terms
        self._linear = np.array([linear[k, :, i] for k, i in self.pairs])
        self._fixed = fixed

    def over(self, side: Side, ranges: tuple[Array, Array]) -> BoxProgram:
        """Its program over a box."""
        joints = np.flatnonzero(np.isfinite(ranges[1]).all(axis=0))
        return BoxProgram(self, side, ranges, joints)


class _Entries:
    """Entries of a sparse matrix, row after row."""

    def __init__(self) -> None:
        self.row: list[int] = []
        self.column: list[int] = []
        self.value: list[float] = []
        self.right: list[float] = []

    def add(self, entries: list[tuple[int, float]], right: float) -> None:
        for column, value in entries:
            self.row.append(len(self.right))
            self.column.append(column)
            self.value.append(value)
        self.right.append(right)

    def matrix(self, columns: int) -> csr_array:
        shape = (len(self.right), columns)
        return csr_array((self.value, (self.row, self.column)), shape=shape)


class BoxProgram:
    """The linear program of a relaxation over one box."""

    def __init__(
        self,
        relaxation: Relaxation,
        side: Side,
        ranges: tuple[Array, Array],
        joints: NDArray[np.int64],
    ) -> None:
        self.relaxation, self.joints, self.side = relaxation, joints, side
        system = relaxation.system
        self.size, self.count = system.unknowns, len(relaxation.pairs)
        self.first = system.coordinates + system.spans
        self.columns = self.first + len(joints) * (self.size + self.count)
        low, high = (r[:, joints].T for r in ranges)
        self._conditions()
        simple = self._simple()
        products = self._products(low, high)
        self.equations, self.equal = self._equations()
        self.matrix = vstack([self.limits.matrix(self.columns), simple, products], format="csr")
        self.right = np.concatenate([self.limits.right, self._simple_right, self._product_right])
        bounds = np.full((self.columns, 2), [-np.inf, np.inf])
        bounds[: system.coordinates] = np.column_stack([side.low, side.high])
        for j in range(len(joints)):
            bounds[self._at(j, 0) : self._at(j, self.size)] = np.column_stack([low[j], high[j]])
        self.bounds = bounds

    def _at(self, joint: int, unknown: int) -> int:
        return self.first + joint * (self.size + self.count) + unknown

    def _conditions(self) -> None:
        """Conditions, each divided by its own constant."""
        number = self.relaxation._number
        self.limits, self.held, self.divisor = _Entries(), [], []
        place = {int(j): i for i, j in enumerate(self.joints)}
        for row, terms in zip(self.relaxation.rows, self.relaxation._terms, strict=True):
            if row.joint >= 0 and row.joint not in place:
                continue
            j = place.get(row.joint, 0)
            by = float(abs(terms.constant)) or float(max(map(abs, terms.along.values())))
            entries = [(self._at(j, v), x / by) for v, x in terms.by.items()]
            entries += [
                (self._at(j, self.size + number[pair]), x / by) for pair, x in terms.product.items()
            ]
            entries += [(c, float(x) / by) for c, x in terms.along.items()]
            self.limits.add(entries, -float(terms.constant) / by)
            self.held.append(row)
            self.divisor.append(by)

    def _simple(self) -> csr_array:
        """Bounds of 1/T and of ρ = h²/T.

        1/T ≥ 2/τ − T/τ² and 1/T ≤ 1/l + 1/u − T/lu for l ≤ T ≤ u; ρ ≥ 2θh − θ²T for any θ, and
        ρ ≤ h²/l ≤ ((h_l + h_u)h − h_l h_u)/l, or ρ ≤ h where l is 0.
        """
        system, side = self.relaxation.system, self.side
        _, _, _, which = matrices(system)
        out, low, high = _Entries(), side.low, side.high
        for t in np.flatnonzero(which >= 0).tolist():
            if low[t] <= 0:
                continue
            z = system.coordinates + t
            for place in np.geomspace(low[t], high[t], _TANGENTS):
                out.add([(z, -1.0), (t, -1.0 / place**2)], -2.0 / place)
            out.add([(z, 1.0), (t, 1.0 / (low[t] * high[t]))], 1.0 / low[t] + 1.0 / high[t])
        for h, t, rho in system.curved:
            top = min(1.0, high[h] / low[t]) if low[t] > 0 else 1.0
            for slope in np.linspace(low[h] / high[t], top, _SLOPES):
                out.add([(h, 2 * slope), (t, -(slope**2)), (rho, -1.0)], 0.0)
            if low[t] > 0:
                chord = -(low[h] + high[h]) / low[t]
                out.add([(rho, 1.0), (h, chord)], -low[h] * high[h] / low[t])
            else:
                out.add([(rho, 1.0), (h, -1.0)], 0.0)
        self._simple_right = np.array(out.right)
        return out.matrix(self.columns)

    def _products(self, low: Array, high: Array) -> csr_array:
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
        least = np.broadcast_to(self.side.low[k], product.shape)
        most = np.broadcast_to(self.side.high[k], product.shape)
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
        self._product_right = np.concatenate(right)
        return vstack(blocks)

    def _equations(self) -> tuple[csr_array, Array]:
        relaxation = self.relaxation
        system = relaxation.system
        _, _, steps, which = matrices(system)
        block = csr_array(np.hstack([relaxation._fixed, relaxation._linear.T]))
        parts = []
        for j, joint in enumerate(self.joints):
            front = np.zeros((self.size, self.first))
            for t in np.flatnonzero(which >= 0):
                front[which[t], system.coordinates + t] = -steps.mid[t, joint]
            width = self.size + self.count
            before = csr_array((self.size, j * width))
            after = csr_array((self.size, (len(self.joints) - j - 1) * width))
            parts.append(hstack([csr_array(front), before, block, after]))
        if not parts:
            return csr_array((0, self.columns)), np.zeros(0)
        return vstack(parts, format="csr"), np.zeros(self.size * len(self.joints))

    def bound(self, target: Target, capped: bool = True) -> Proposal | None:
        """Propose weights for a bound of a target; None if the program has no solution."""
        system = self.relaxation.system
        cost = np.zeros(self.columns)
        cost[: system.coordinates] = target.weights(system)
        right = self.right.copy()
        if not capped:
            right[len(self.held) - 1] = _BARRED
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
            1.0, found.x, found.fun, -found.ineqlin.marginals, -found.eqlin.marginals
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
        return self._proposal(0.0, found.x[:-1], found.fun, dual[:count], equal)

    def _proposal(
        self, scale: float, x: Array, value: float, dual: Array, equal: Array
    ) -> Proposal:
        system, relaxation = self.relaxation.system, self.relaxation
        limits = np.maximum(dual[: len(self.held)], 0.0) / np.array(self.divisor)
        top = max(scale, float(limits.max(initial=0.0)), float(np.abs(equal).max(initial=0.0)))
        unit = _LARGEST / top
        rows = {
            row: round(w * unit)
            for row, w in zip(self.held, limits, strict=True)
            if w * unit > _SMALLEST
        }
        size = self.size
        equations = {
            (int(self.joints[i // size]), i % size): round(w * unit)
            for i, w in enumerate(equal.tolist())
            if abs(w * unit) > _SMALLEST
        }
        # A product's four bounds as in `_products`: the first and the third are exact where the
        # unknown is lowest.
        parts = np.maximum(dual[dual.size - 4 * len(self.joints) * self.count :], 0.0)
        parts = parts.reshape(4, len(self.joints), self.count)
        lowest, highest = parts[0] + parts[2], parts[1] + parts[3]
        with np.errstate(invalid="ignore"):
            share = np.where(lowest + highest > 0, lowest / (lowest + highest), 0.5)
        mix = np.full((system.joints, system.coordinates, size), MIX // 2)
        for p, (k, i) in enumerate(relaxation.pairs):
            mix[self.joints, k, i] = np.rint(share[:, p] * MIX)
        blocks = x[self.first :].reshape(len(self.joints), size + self.count)
        return Proposal(
            Weights(round(scale * unit), rows, equations, mix),
            float(value),
            x[: system.coordinates],
            blocks[:, :size],
            blocks[:, size:],
        )
