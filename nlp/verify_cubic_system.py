"""C2 cubic splines as a certificate states them: equations, conditions, and what limits imply.

Standard library only. Symbols are those of docs/certificates-cubic.md.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import ceil, isqrt
from typing import Any

from .verify_problem import Bounds, Declaration, need, read_problem, whole

TICKS = 2**24
PLACES = 64
MOST = 2**28
"""Of the integers in a proof."""

Vector = dict[Any, Fraction]
ZERO = Fraction(0)


class Cubic:
    """The problem in its own units: equations, conditions, and what the limits imply."""

    def __init__(self, document: dict[str, Any]) -> None:
        problem, proof = read_problem(document["problem"]), document["proof"]
        self.problem = problem
        need(problem.declaration is not None, "the curve is no declared piecewise polynomial")
        assert problem.declaration is not None
        self.ends, self.virtual = _kind_of_ends(problem.declaration)
        q = problem.waypoints
        self.n, self.m, self.joints = len(problem.shortest), len(q) - 1, len(problem.limits)
        powers = [whole(p, -60, 60) for p in proof["powers"]]
        need(len(powers) == self.joints, "powers: one for each joint")
        self.second = Fraction(2) ** whole(proof["second"], -60, 60)
        angle = [Fraction(2) ** p for p in powers]
        self.steps = [
            [(y - x) / a for x, y, a in zip(*rows, angle, strict=True)] for rows in pairwise(q)
        ]

        def loose(x: Bounds, order: int, a: Fraction) -> Fraction | None:
            return None if x is None or x[1] <= 0 else x[1] * self.second**order / a

        self.limits = [
            [loose(x, r, a) for r, x in enumerate(row, 1)]
            for row, a in zip(problem.limits, angle, strict=True)
        ]
        self.shortest = [x / self.second for x in problem.shortest]
        self.longest = [None if x is None else x / self.second for x in problem.longest]
        self.cap = Fraction(whole(proof["cap"], 1, MOST), TICKS)
        self.free = self.m + (2 if self.virtual else 0)
        self.breaks = list(range(self.n + 1))
        if self.virtual:
            self.breaks = [0, *range(2, self.n - 1), self.n]
        self.size = self.n + 1 + self.m + 1
        self.lengths = [self._length(k) for k in range(self.n)]
        self.equations, self.moved = self._equations()

    def rho(self) -> list[tuple[int, int, int]]:
        """Coordinates (h, T, h²/T) of the two ends with a virtual way-point."""
        m = self.m
        return [(m, 0, m + 2), (m + 1, m - 1, m + 3)] if self.virtual else []

    def _length(self, k: int) -> dict[int, int]:
        m, n = self.m, self.n
        if not self.virtual:
            return {k: 1}
        if k in (0, n - 1):
            return {m if k == 0 else m + 1: 1}
        if k in (1, n - 2):
            return {0: 1, m: -1} if k == 1 else {m - 1: 1, m + 1: -1}
        return {k - 1: 1}

    def _equations(self) -> tuple[list[Vector], dict[int, tuple[int, int]]]:
        """Left-hand sides, keyed by unknown or (coordinate, unknown); right: ±6Δq/T of a span."""
        n, m, v = self.n, self.m, self.n + 1
        rows: list[dict[Any, int]] = []
        moved = {}
        for node, speed, order in ((0, v, self.ends[0]), (n, v + m, self.ends[1])):
            rows += [{speed: 1}] if order != 2 else []
            rows += [{node: 1}] if order != 1 else []
        for t, (i, k) in enumerate(pairwise(self.breaks)):
            if self.virtual and t in (0, m - 1):
                sign = 1 if t == 0 else -1
                a, b = (1, 2) if t == 0 else (n - 1, n - 2)
                h, _, r = self.rho()[0 if t == 0 else 1]
                speed = v + 1 if t == 0 else v + m - 1
                rows.append({speed: 2 * sign, (t, a): -1, (t, b): -1, (h, b): 1})
                moved[len(rows)] = (t, sign)
                rows.append({(t, a): 2, (h, a): -1, (t, b): 1, (h, b): -2, (r, b): 1})
            else:
                rows.append({v + t + 1: 2, v + t: -2, (t, i): -1, (t, k): -1})
                moved[len(rows)] = (t, 1)
                rows.append({v + t: 6, (t, i): 2, (t, k): 1})
        need(len(rows) == self.size, "the equations do not determine the spline")
        return [{key: Fraction(x) for key, x in row.items()} for row in rows], moved

    def condition(self, entry: Any) -> tuple[int, Vector, Vector, Fraction]:
        """Joint, terms in the unknowns, terms in the coordinates, constant: their sum is ≤ 0."""
        kind, joint, k, sign, place = entry
        need(abs(whole(sign, -1, 1)) == 1, "sign of a condition")
        if kind == "total":
            return -1, {}, {t: Fraction(1) for t in range(self.m)}, -self.cap
        if kind in ("lower", "upper"):
            bound = self.shortest[whole(k, 0, self.n - 1)] if kind == "lower" else self.longest[k]
            need(bound is not None and k >= 0, "a bound of a duration that is not there")
            assert bound is not None
            side = -1 if kind == "lower" else 1
            return (
                -1,
                {},
                {c: Fraction(side * x) for c, x in self.lengths[k].items()},
                -side * bound,
            )
        limits = self.limits[whole(joint, 0, self.joints - 1)]
        limit = limits[2 if kind == "jerk" else 0]
        need(limit is not None, "a condition leans on a limit that is not there")
        assert limit is not None
        if kind == "jerk":
            whole(k, 0, self.n - 1)
            along = {c: -limit * x for c, x in self.lengths[k].items()}
            return joint, {k + 1: Fraction(sign), k: Fraction(-sign)}, along, ZERO
        need(kind == "velocity", "unknown condition")
        whole(k, 0, self.m - 1)
        s = Fraction(whole(place, 0, PLACES), PLACES)
        # v(s) = v(0) + length·(a(0)(s − s²/2) + a(1)s²/2)
        one, two = sign * (s - s * s / 2), sign * s * s / 2
        if self.virtual and k in (0, self.m - 1):
            a, b, h = (1, 2, self.m) if k == 0 else (self.n - 1, self.n - 2, self.m + 1)
            # Length T − h, and v(0) = h·a/2 at the virtual way-point.
            terms = {(k, a): one, (h, a): Fraction(sign, 2) - one, (k, b): two, (h, b): -two}
        else:
            i, j = self.breaks[k], self.breaks[k + 1]
            terms = {self.n + 1 + k: Fraction(sign), (k, i): one, (k, j): two}
        return joint, terms, {}, -limit

    def fastest(self, joint: int) -> tuple[Fraction | None, Fraction | None]:
        """Bounds of |v| and |a| that the cap implies."""
        velocity, acceleration, jerk = self.limits[joint]
        a = smaller(acceleration, None if jerk is None else jerk * self.cap)
        if jerk is not None and velocity is not None:
            a = smaller(a, _root_above(2 * velocity * jerk))
        still = sum(order != 2 for order in self.ends)
        other = a * self.cap / still if still and a is not None else None
        return smaller(velocity, other), a

    def root(self, given: Any) -> tuple[list[int], list[int]]:
        """Lower sides, which are proved here, and upper sides of the outermost box."""
        low, high = [whole(x, 0, MOST) for x in given], []
        need(len(low) == self.free, "root: shape")
        for c in range(self.free):
            held = [k for k, x in enumerate(self.lengths) if x.get(c, 0) > 0]
            if self.virtual and c in (0, self.m - 1):
                held.append(0 if c == 0 else self.n - 1)
            least = sum((self.shortest[k] for k in held), ZERO)
            for j in range(self.joints if c < self.m else 0):
                v, _ = self.fastest(j)
                least = max(least, abs(self.steps[c][j]) / v) if v else least
            need(Fraction(low[c], TICKS) <= least, "root: a side is not proved")
            longest = [x for x in (self.longest[k] for k in held) if x is not None]
            top = sum(longest, ZERO) if len(longest) == len(held) else self.cap
            high.append(ceil(min(top, self.cap) * TICKS))
        return low, high


def _kind_of_ends(declared: Declaration) -> tuple[tuple[int, int], bool]:
    """Order prescribed at each end (0: both), and whether there are virtual way-points."""
    n = len(declared.degrees)
    need(set(declared.degrees) == {3} and set(declared.continuity) <= {2}, "no C2 cubic spline")
    need(declared.at_rest and not any(declared.prescribed[1:-1]), "conditions inside")
    orders = [sorted(declared.prescribed[b]) for b in (0, n)]
    if declared.virtual:
        need(n >= 4 and sorted(declared.virtual) == [1, n - 1], "virtual way-points elsewhere")
        need(orders == [[1, 2], [1, 2]], "virtual way-points, but not at rest at the ends")
        return (0, 0), True
    need(all(x in ([1], [2]) for x in orders), "an end that is neither clamped nor natural")
    return (orders[0][0], orders[1][0]), False


def _root_above(x: Fraction) -> Fraction:
    """An upper bound of a square root."""
    fine = 2**60
    return Fraction(isqrt(ceil(x * fine**2)) + 1, fine)


def smaller(a: Fraction | None, b: Fraction | None) -> Fraction | None:
    """The smaller bound; None is no bound."""
    return a if b is None or (a is not None and a <= b) else b
