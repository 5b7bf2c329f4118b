"""C2 cubic splines as a certificate states them: equations, conditions, and what limits imply.

Symbols are those of docs/explanation/certificates-cubic.md.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from math import ceil, floor, isqrt
from typing import Any

from ..problem import Declaration, StatedProblem, in_own_units
from ..ranges import MOST_CUBIC_SEGMENTS, MOST_INTEGER, SPOTS, TICKS
from ..reading import listed, need, required, sign_of, whole

Number = int | Fraction
Vector = dict[Any, Number]
"""Factors by unknown, or by (coordinate, unknown) for a product."""
Condition = tuple[int, Vector, Vector, Number]
"""Joint, terms in the unknowns, terms in the coordinates, constant: their sum is ≤ 0."""
Sides = list[tuple[Fraction, Fraction]]
"""Least and largest value of every coordinate."""
FINE = 2**44
"""Ranges and roots are multiples of 1/FINE: fine enough for gaps of 1e-9, and no number grows in a
tree."""


class Cubic:
    """The problem in its own units: equations, conditions, and what the limits imply."""

    def __init__(self, problem: StatedProblem, proof: dict[str, Any]) -> None:
        declared = required(problem.declaration, "the curve is not a declared piecewise polynomial")
        self.ends, self.virtual = kind_of_ends(declared)
        self.n, self.m, self.joints = problem.segments, len(problem.waypoints) - 1, problem.joints
        need(self.n <= MOST_CUBIC_SEGMENTS, f"more than {MOST_CUBIC_SEGMENTS} segments")
        self.second, self.steps, self.limits = in_own_units(problem, proof)
        self.shortest = [x / self.second for x in problem.shortest]
        self.longest = [None if x is None else x / self.second for x in problem.longest]
        self.cap = Fraction(whole(proof["cap"], 1, MOST_INTEGER), TICKS)
        self.free, self.coordinates = (self.m + (x if self.virtual else 0) for x in (2, 4))
        n, m = self.n, self.m
        self.breaks, self.lengths = list(range(n + 1)), [{k: 1} for k in range(m)]
        self.rough: dict[int, tuple[int, int, int]] = {}
        """Of spans with a virtual way-point: breaks there and at its inner end, coordinate h."""
        if self.virtual:
            self.rough = {0: (1, 2, m), m - 1: (n - 1, n - 2, m + 1)}
            self.breaks = [0, *range(2, n - 1), n]
            first, last = [{m: 1}, {0: 1, m: -1}], [{m - 1: 1, m + 1: -1}, {m + 1: 1}]
            self.lengths = [*first, *self.lengths[1:-1], *last]
        self.rho = [(h, t, h + 2) for t, (_, _, h) in self.rough.items()]
        """Coordinates (h, T, h²/T) of the two ends with a virtual way-point."""
        self.size = self.n + 1 + self.m + 1
        self.equations, self.moved = self._equations()
        self.moving = {i: (t, sign) for i, (t, sign) in self.moved.items() if any(self.steps[t])}

    def _equations(self) -> tuple[list[dict[Any, int]], dict[int, tuple[int, int]]]:
        """Left-hand sides, keyed by unknown or (coordinate, unknown); right: ±6Δq/T of a span.

        Acceleration from a to b in a line: 2(v₁ − v₀) = T(a + b), 6v₀ + T(2a + b) = 6Δq/T. From
        rest, with a at the virtual way-point, at h, and b at T: 2v = T(a + b) − h b and
        6Δq/T = (2T − h)a + (T − 2h + h²/T)b.
        """
        n, m, v = self.n, self.m, self.n + 1
        rows: list[dict[Any, int]] = []
        moved = {}
        for node, speed, order in ((0, v, self.ends[0]), (n, v + m, self.ends[1])):
            rows += [{speed: 1}] if order != 2 else []
            rows += [{node: 1}] if order != 1 else []
        for t, (i, k) in enumerate(pairwise(self.breaks)):
            rough = self.rough.get(t)
            if rough is not None:
                a, b, h = rough
                sign, speed = (1, v + 1) if t == 0 else (-1, v + m - 1)
                rows.append({speed: 2 * sign, (t, a): -1, (t, b): -1, (h, b): 1})
                moved[len(rows)] = (t, sign)
                rows.append({(t, a): 2, (h, a): -1, (t, b): 1, (h, b): -2, (h + 2, b): 1})
            else:
                rows.append({v + t + 1: 2, v + t: -2, (t, i): -1, (t, k): -1})
                moved[len(rows)] = (t, 1)
                rows.append({v + t: 6, (t, i): 2, (t, k): 1})
        return rows, moved

    def condition(self, entry: Any) -> Condition:
        """What a row of the file stands for."""
        kind, joint, k, sign, place = listed(entry, "a row", 5, 5)
        sign_of(sign)
        if kind == "total":
            return -1, {}, dict.fromkeys(range(self.m), 1), -self.cap
        if kind in ("lower", "upper"):
            whole(k, 0, self.n - 1)
            bound = required(
                self.shortest[k] if kind == "lower" else self.longest[k],
                "a bound of a duration that is not there",
            )
            side = -1 if kind == "lower" else 1
            return -1, {}, {c: side * x for c, x in self.lengths[k].items()}, -side * bound
        limits = self.limits[whole(joint, 0, self.joints - 1)]
        need(kind in ("jerk", "velocity"), "a row of an unknown kind")
        limit = required(
            limits[2 if kind == "jerk" else 0], "a condition leans on a limit that is not there"
        )
        if kind == "jerk":
            whole(k, 0, self.n - 1)
            along = {c: -limit * x for c, x in self.lengths[k].items()}
            return joint, {k + 1: sign, k: -sign}, along, 0
        whole(k, 0, self.m - 1)
        s = Fraction(whole(place, 0, SPOTS), SPOTS)
        # v(s) = v(0) + length·(a(0)(s − s²/2) + a(1)s²/2)
        one, two = sign * (s - s * s / 2), sign * s * s / 2
        rough = self.rough.get(k)
        terms: Vector
        if rough is not None:
            a, b, h = rough
            # Length T − h, and v(0) = h·a/2 at the virtual way-point.
            terms = {(k, a): one, (h, a): Fraction(sign, 2) - one, (k, b): two, (h, b): -two}
        else:
            i, j = self.breaks[k], self.breaks[k + 1]
            terms = {self.n + 1 + k: sign, (k, i): one, (k, j): two}
        return joint, terms, {}, -limit

    def fastest(self, joint: int) -> tuple[Fraction | None, Fraction | None]:
        """Bounds of |v| and |a| that the cap L implies.

        The acceleration is 0 somewhere: |a| ≤ J·L. Around an |a| of α it takes α/J to vanish, in
        which the velocity changes by α²/2J: at most 2V over both sides, V over one side of a rest,
        so α² ≤ 2VJ. From a rest the velocity is at most A·L, half of that between two.
        """
        velocity, acceleration, jerk = self.limits[joint]
        known = [acceleration, None if jerk is None else jerk * self.cap]
        if jerk is not None and velocity is not None:
            known.append(root_below(2 * velocity * jerk) + Fraction(1, FINE))
        a = least_of(known)
        still = sum(order != 2 for order in self.ends)
        other = a * self.cap / still if still and a is not None else None
        return least_of([velocity, other]), a

    def side(self, c: int) -> tuple[Fraction, Fraction]:
        """Least and largest value of a coordinate: bounds, mean velocities, and the cap."""
        held = [k for k, x in enumerate(self.lengths) if x.get(c, 0) > 0]
        if self.virtual and c in (0, self.m - 1):
            held.append(0 if c == 0 else self.n - 1)
        least = sum((self.shortest[k] for k in held), Fraction(0))
        for j in range(self.joints if c < self.m else 0):
            v, _ = self.fastest(j)
            least = max(least, abs(self.steps[c][j]) / v) if v else least
        longest = [x for x in (self.longest[k] for k in held) if x is not None]
        return least, sum(longest, Fraction(0)) if len(longest) == len(held) else self.cap

    def root(self, stated: Any) -> tuple[list[int], list[int]]:
        """Lower sides, which are proved here, and upper sides of the outermost box."""
        stated = listed(stated, "root", self.free, self.free)
        low, high = [whole(x, 0, MOST_INTEGER) for x in stated], []
        for c in range(self.free):
            least, top = self.side(c)
            need(Fraction(low[c], TICKS) <= least, "root: a side is not proved")
            high.append(ceil(min(top, self.cap) * TICKS))
        return low, high


def kind_of_ends(declared: Declaration) -> tuple[tuple[int, int], bool]:
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


def root_below(x: Fraction) -> Fraction:
    """A square root, rounded down to a multiple of 1/FINE."""
    return Fraction(isqrt(floor(x * FINE**2)), FINE)


def least_of(bounds: Iterable[Fraction | None]) -> Fraction | None:
    """The least of some bounds; None is not a bound."""
    return min((x for x in bounds if x is not None), default=None)
