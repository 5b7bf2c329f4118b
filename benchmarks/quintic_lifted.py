"""The lifted linear program of C4 quintic problems over a box of durations, for a benchmark.

Columns: h, h², h³, h⁴; velocity, acceleration, jerk and snap at the inner way-points; scaled end
values P = h v, Q = h² a of every segment. Scaled jerk and snap are linear in those and the step.
McCormick envelopes link scaled and nodal values to the powers of h, secants and tangents the
powers to h; limits hold at nine places of a segment. Floating point, without proof.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_array, vstack
from trajgap.verify.quintic_bound import HERMITE

SPOTS = np.arange(1, 8) / 8.0
"""Inner places of a segment; at its ends the boxes of the nodal values say the same."""


def derivative(order, s):
    """Shape of the derivative at s, in (step, P0, P1, Q0, Q1): scaled end values."""
    out = np.zeros(5)
    for power in range(order, 6):
        out += (
            np.prod(np.arange(power, power - order, -1.0))
            * s ** (power - order)
            * HERMITE[1:, power]
        )
    return out


@dataclass(frozen=True, eq=False)
class Box:
    """Durations (low, high) and nodal values (least, most), shape (joints, inner nodes, 4)."""

    low: np.ndarray
    high: np.ndarray
    least: np.ndarray
    most: np.ndarray


class Relaxation:
    """The linear program of some joints; columns: h, h², h³, h⁴, nodal values, scaled values."""

    def __init__(self, problem, joints, upper):
        n, inner = problem.segments, problem.segments - 1
        self.n, self.joints, self.upper = n, joints, upper
        step = np.diff(problem.waypoints, axis=0)
        limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
        first = 4 * n
        self.columns = first + len(joints) * (4 * inner + 4 * n)
        links, limit_rows, ends = [], [], []
        for place, j in enumerate(joints):
            nodal = first + place * 4 * inner
            scaled = first + len(joints) * 4 * inner + place * 4 * n
            for k in range(n):
                at = scaled + 4 * k + np.arange(4)
                for end in (0, 1):
                    node = k - 1 + end
                    if not 0 <= node < inner:
                        ends += [at[end], at[2 + end]]
                        continue
                    for p in range(1, 5):
                        links.append(
                            (p, k, place, node, nodal + 4 * node + p - 1, at,
                             derivative(p, float(end)), step[k, j])
                        )  # fmt: skip
                for order in (1, 2):
                    for s in SPOTS:
                        shape = derivative(order, s)
                        column = (order - 1) * n + k
                        limit_rows.append((shape, at, column, limits[j, order - 1], step[k, j]))
        self.ends = np.array(ends)
        self._set_links(links)
        self._set_limits(limit_rows)

    def _set_links(self, links):
        self.power, self.segment, self.place, self.node, self.nodal = (
            np.array([link[i] for link in links]) for i in range(5)
        )
        self.at = np.array([link[5] for link in links])
        self.shape = np.array([link[6][1:] for link in links])
        self.constant = np.array([link[6][0] * link[7] for link in links])

    def _set_limits(self, rows):
        data, row, column, right = [], [], [], []
        for i, (shape, at, y, limit, step) in enumerate(rows):
            for sign, r in ((1.0, 2 * i), (-1.0, 2 * i + 1)):
                data += [*(sign * shape[1:]), -limit]
                row += [r] * 5
                column += [*at, y]
                right.append(-sign * shape[0] * step)
        n = self.n
        data += [1.0] * n
        row += [len(right)] * n
        column += range(n)
        right.append(self.upper)
        self.fixed = csr_array((data, (row, column)), shape=(len(right), self.columns))
        self.fixed_right = np.array(right)

    def program(self, box):
        """Constraint matrix, right-hand side and bounds over a box."""
        p, k = self.power, self.segment
        yl, yu = box.low[k] ** p, box.high[k] ** p
        xl = box.least[self.place, self.node, p - 1]
        xu = box.most[self.place, self.node, p - 1]
        y = (p - 1) * self.n + k
        corners = ((1.0, yl, xu), (1.0, yu, xl), (-1.0, yl, xl), (-1.0, yu, xu))
        parts, rights = [self.fixed], [self.fixed_right]
        for sign, a, b in corners:  # sign·(E − a x − b y + a b) ≤ 0
            data = sign * np.column_stack([self.shape, -a, -b])
            column = np.column_stack([self.at, self.nodal, y])
            parts.append(self._rows(data, column))
            rights.append(-sign * (a * b + self.constant))
        for power in range(2, 5):
            column = np.column_stack([(power - 1) * self.n + np.arange(self.n), np.arange(self.n)])
            width = np.maximum(box.high - box.low, 1e-12)
            slope = (box.high**power - box.low**power) / width
            parts.append(self._rows(np.column_stack([np.ones(self.n), -slope]), column))
            rights.append(box.low**power - slope * box.low)
            for share in (0.0, 0.5, 1.0):
                at = box.low + share * (box.high - box.low)
                slope = power * at ** (power - 1)
                parts.append(self._rows(np.column_stack([-np.ones(self.n), slope]), column))
                rights.append(slope * at - at**power)
        bounds = np.full((self.columns, 2), [-np.inf, np.inf])
        for power in range(1, 5):
            rows = slice((power - 1) * self.n, power * self.n)
            bounds[rows] = np.column_stack([box.low**power, box.high**power])
        count = len(self.joints) * (self.n - 1) * 4
        bounds[4 * self.n : 4 * self.n + count] = np.column_stack(
            [box.least.reshape(-1), box.most.reshape(-1)]
        )
        bounds[self.ends] = 0.0
        return vstack(parts, format="csr"), np.concatenate(rights), bounds

    def _rows(self, data, column):
        rows = np.repeat(np.arange(len(data)), data.shape[1])
        shape = (len(data), self.columns)
        return csr_array((data.reshape(-1), (rows, column.reshape(-1))), shape=shape)

    def violation(self, x):
        """Per segment, how far the scaled values are from the products they stand for."""
        found = (self.shape * x[self.at]).sum(axis=1) + self.constant
        meant = x[self.segment] ** self.power * x[self.nodal]
        size = np.abs(found) + np.abs(meant) + 1e-3
        return np.bincount(self.segment, np.abs(found - meant) / size, self.n)


def least(program, cost):
    """Least value and point; (inf, None) if infeasible, (−inf, None) if the solver gave up."""
    matrix, right, bounds = program
    found = linprog(cost, A_ub=matrix, b_ub=right, bounds=bounds, method="highs")
    if found.status == 2:
        return np.inf, None
    if found.status != 0:
        return -np.inf, None
    return float(found.fun), found.x
