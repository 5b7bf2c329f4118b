"""Proof of a lower bound for 3-5-3 or 4-3-4 polynomials.

Why the proof holds is in docs/explanation/certificates.md; the symbols are the same here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from math import comb, factorial, inf, lcm, perm
from operator import mul
from typing import Any, ClassVar

from .curve import pieces
from .problem import Bounds, Declaration, StatedProblem
from .ranges import MOST_ROWS, MOST_WEIGHTS, PLACES
from .reading import Clock, listed, need, number, required, sign_of, text, whole
from .tree import ProofKind

STRICT = Fraction(1, 2**40)
"""δ of the docs: makes rows without the total strict, at a cost below that of rounding."""
SIZE = 6
"""Coefficients per variable: no row has a higher degree, and raising it only tightens the test."""
BINOMIALS = lcm(*(comb(SIZE - 1, p) for p in range(SIZE)))
"""Makes every weight of a Bernstein coefficient an integer."""
_FINEST = 2**256
"""Of a place where the square is cut: each halving adds a digit, and a long tree many."""

Poly = dict[tuple[int, int], int]
"""Coefficients of aⁱbʲ."""
Quotient = tuple[Poly, int]
"""A polynomial divided by a positive integer: so all sums and products are of integers."""
Square = tuple[Fraction, Fraction, Fraction, Fraction]
"""A box: a from, to, b from, to."""

ONE: Poly = {(0, 0): 1}
"""The polynomial 1: products begin with it."""
M: tuple[Poly, ...] = (
    {(1, 0): 1, (1, 1): -1},
    {(0, 0): 1, (1, 0): -1, (0, 1): -1, (1, 1): 1},
    {(0, 1): 1, (1, 1): -1},
)
"""m = (a(1 − b), (1 − a)(1 − b), b(1 − a)): a segment's share of the total, times S."""
S: Poly = {(0, 0): 1, (1, 1): -1}
"""S = 1 − ab: what the shares add up to."""

POWERS = tuple((i, j) for i in range(3) for j in range(3))
"""Of x and y in a piece."""
Ratios = dict[tuple[int, int], list[Fraction]]
"""Coefficients in s of each xⁱyʲ."""
Curves = dict[str, list[Ratios]]
"""By kind of row and joint: a piece times its divisor."""
Whole = tuple[dict[tuple[int, int], list[int]], int]
"""Such a piece as integers, divided by one positive integer."""


class _ThreePieces(ProofKind[Square]):
    """Boxes of directions, each excluded by weighted rows."""

    keys = ("rows",)

    degrees: ClassVar[list[int]]
    divisors: ClassVar[dict[str, tuple[int, dict[tuple[int, int], int]]]]
    """By kind of row at a place: its segment, and the coefficients of xⁱyʲ that the piece is
    multiplied by, none negative."""
    cubic_ends: ClassVar[bool]
    """Whether the end pieces are d·s³; if not, only their being at rest is used."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        self._declared()
        need(total > 0, "the total is not positive")
        stated = listed(proof["rows"], "rows", MOST_ROWS)
        rows = [_Row.read(row, self) for row in clock.each(stated)]
        # Without the total in any row, what is excluded is excluded for every total.
        self._timeless = all(r.cap >= 0 or (r.kind in self.divisors and r.order == 0) for r in rows)
        curves = self._curves()
        self._rows = [self._polynomial(curves, row) for row in rows]

    def root(self) -> Square:
        """All directions."""
        return Fraction(0), Fraction(1), Fraction(0), Fraction(1)

    def cut(self, box: Square, coordinate: int, place: Any) -> tuple[Square, Square]:
        """Halves of a side; coordinate 0 is a, 1 is b."""
        need(place is None, "a square is halved, at no other place")
        whole(coordinate, 0, 1)
        a0, a1, b0, b1 = box
        low, high = (a0, a1) if coordinate == 0 else (b0, b1)
        half = (low + high) / 2
        need(half.denominator < _FINEST, "the tree is too deep")
        if coordinate == 0:
            return (a0, half, b0, b1), (half, a1, b0, b1)
        return (a0, a1, b0, half), (a0, a1, half, b1)

    def leaf(self, box: Square, data: list[Any]) -> None:
        """[row, weight, row, weight, …]: their weighted sum is nowhere negative in the box."""
        listed(data, "weights", 2 * MOST_WEIGHTS, 2)
        need(len(data) % 2 == 0, "malformed: weights come in pairs")
        which = [whole(k, 0, len(self._rows) - 1) for k in data[::2]]
        weights = [number(x) for x in data[1::2]]
        need(min(weights) >= 0 and any(weights), "a weight is negative, or all are 0")
        rows = [self._rows[k] for k in which]
        parts = [(w / unit, row) for w, (row, unit) in zip(weights, rows, strict=True)]
        mixed, _ = _sum(parts, self.clock)
        need(_covers(mixed, box, self.clock), "it is not proved")

    @property
    def infeasible(self) -> bool:
        """Whether the total occurs in no row."""
        return self._timeless

    def _declared(self) -> None:
        need(
            self.problem.declaration == _at_rest(self.degrees, self.problem.joints),
            "declaration not covered: not the polynomials of this kind of proof, at rest at the "
            "ends",
        )

    def _curves(self) -> dict[str, list[Whole]]:
        """Each piece times its divisor, as a polynomial of degree 2 in x and in y, for s in [0, 1].

        The curve is linear in the way-points: it is the sum of the curves through the unit ones,
        each times a way-point.
        """
        joints = list(zip(*self.problem.waypoints, strict=True))
        return {
            kind: [
                _whole({key: _mixed(q, [unit[key] for unit in units]) for key in POWERS})
                for q in joints
            ]
            for kind, units in _unit_curves(type(self)).items()
        }

    def _polynomial(self, curves: dict[str, list[Whole]], row: _Row) -> Quotient:
        """Polynomial in a, b that is < 0 wherever a trajectory below the total is feasible.

        With h_g < c·M_g/hold, a piece N/E and |q⁽ʳ⁾(s)| ≤ limit·h_gʳ in its own time: the row is
        sign·N⁽ʳ⁾(s)·holdʳ/(limit·cʳ) − E·M_gʳ, for a position sign·N − limit·E.
        """
        self.clock.check()
        problem, cap = self.problem, row.cap
        longest = required(
            self.total if cap < 0 else problem.longest[cap],
            "a row leans on an upper bound that is not there",
        )
        c = longest if cap < 0 else longest * (1 + STRICT)
        hold = S if cap < 0 else M[cap]  # every duration is below c·M[g]/hold
        if row.kind == "lower":
            share = problem.shortest[row.joint] / c
            return _sum([(share, hold), (Fraction(-1), M[row.joint])], self.clock)
        q, order, sign = [w[row.joint] for w in problem.waypoints], row.order, row.sign
        if order == 0:
            ends = required(
                problem.position[(1 + sign) // 2][row.joint],
                "a row leans on a position limit that is not there",
            )
            limit = max(sign * x for x in ends) + STRICT
        else:
            side = problem.sides[(1 + row.side(q)) // 2]
            bound = required(side[row.joint][order - 1], "a row leans on a limit that is not there")
            limit = bound[1]
            need(limit > 0, "a row leans on a limit that is not there")
        if row.kind in self.divisors:
            segment, divisor = self.divisors[row.kind]
            ratios, unit = curves[row.kind][row.joint]
            unit *= PLACES ** (self.degrees[segment] - order)
            values = {key: sign * _value(x, order, row.place) for key, x in ratios.items()}
            left, below = _on_square(values), _on_square(divisor)
        else:
            segment = _WHOLE[row.kind]
            least = perm(3, order) if self.cubic_ends else factorial(order)
            way = abs(q[segment + 1] - q[segment]) * (1 if row.kind == "mean" else least)
            left, unit, below = {(0, 0): way.numerator}, way.denominator, ONE
        if order == 0:
            return _sum([(Fraction(1, unit), left), (-limit, below)], self.clock)
        left = _times(left, *([hold] * order))
        right = _times(below, *([M[segment]] * order))
        return _sum([(1 / (limit * c**order * unit), left), (Fraction(-1), right)], self.clock)


class ThreeFiveThree(_ThreePieces):
    """3-5-3 polynomials."""

    degrees = [3, 5, 3]  # noqa: RUF012
    divisors = {"place": (1, {(0, 0): 1})}  # noqa: RUF012
    cubic_ends = True


class FourThreeFour(_ThreePieces):
    """4-3-4 polynomials."""

    degrees = [4, 3, 4]  # noqa: RUF012
    divisors = {  # noqa: RUF012
        "place": (1, {(0, 0): 1, (1, 0): 2, (0, 1): 2, (1, 1): 3}),
        "place-first": (0, {(1, 0): 1, (2, 0): 2, (1, 1): 2, (2, 1): 3}),
        "place-last": (2, {(0, 1): 1, (1, 1): 2, (0, 2): 2, (1, 2): 3}),
    }
    cubic_ends = False


_WHOLE = {"first": 0, "mean": 1, "last": 2}
"""Segments of the rows that speak about a segment as a whole."""


@dataclass(frozen=True)
class _Row:
    """One limit, at one place; ``cap`` −1 stands for the total, else for a segment's bound."""

    kind: str
    joint: int
    order: int
    sign: int
    place: int
    cap: int

    def side(self, q: list[Fraction]) -> int:
        """Side of the limit that a row on a derivative leans on, ±1.

        The mean speed of a piece has the sign of its way. From rest a derivative of that sign is
        reached; to rest, seen backwards, every second one has the other sign.
        """
        if self.kind not in _WHOLE:
            return self.sign
        segment = _WHOLE[self.kind]
        turned = self.kind == "last" and self.order == 2
        return (1 if q[segment + 1] >= q[segment] else -1) * (-1 if turned else 1)

    @classmethod
    def read(cls, entry: Any, of: _ThreePieces) -> _Row:
        """Read [kind, joint, order, sign, place, cap]; "lower" has a segment for the joint."""
        kind, joint, order, sign, place, cap = listed(entry, "a row", 6, 6)
        kind = text(kind, "a row")
        need(kind in (*of.divisors, *_WHOLE, "lower"), "a row of an unknown kind")
        at_place = kind in of.divisors
        row = cls(
            kind,
            whole(joint, 0, (3 if kind == "lower" else of.problem.joints) - 1),
            whole(order, 0 if at_place or kind == "lower" else 1, 3),
            sign_of(sign),
            whole(place, 0, PLACES),
            whole(cap, -1, 2),
        )
        need(kind != "mean" or order == 1, "a mean speed has order 1")
        return row


def _at_rest(degrees: list[int], joints: int) -> Declaration:
    """C2 pieces through four way-points, at rest without acceleration at both ends."""
    rest = {order: [Fraction(0)] * joints for order in (1, 2)}
    return Declaration(degrees, [2, 2], [rest, {}, {}, rest], [])


@cache
def _unit_curves(proof: type[_ThreePieces]) -> Curves:
    """`_curves` where one way-point is 1 and the others are 0, a joint for each of the four.

    They are read off from exact splines on nine pairs of ratios, and checked on two more.
    """
    unit = [[Fraction(int(i == j)) for j in range(4)] for i in range(4)]
    none: list[Bounds] = [None] * 4
    problem = StatedProblem(
        unit, [none[:3]] * 4, [[none[:3]] * 4] * 2, [none, none], [Fraction(0)] * 3, [None] * 3,
        _at_rest(proof.degrees, 4), None, [[None] * 4] * 2,
    )  # fmt: skip
    nodes = [Fraction(x) for x in (1, 2, 3)]
    grid = [(x, y) for x in nodes for y in nodes]
    further = [(Fraction(2), Fraction(5)), (Fraction(7, 2), Fraction(1, 3))]
    splines = {
        (x, y): pieces(problem, [1 / x, Fraction(1), 1 / y], Clock(inf)) for x, y in grid + further
    }
    out: Curves = {}
    for kind, (segment, divisor) in proof.divisors.items():
        out[kind] = []
        for joint in range(4):
            values = {}
            for (x, y), spline in splines.items():
                h = (1 / x, Fraction(1), 1 / y)[segment]
                by = sum((c * x**i * y**j for (i, j), c in divisor.items()), Fraction(0))
                values[x, y] = [by * c * h**p for p, c in enumerate(spline[joint][segment])]
            rows = [_parabola([values[x, y] for y in nodes]) for x in nodes]
            found: Ratios = {}
            for j in range(3):
                for i, coefficients in enumerate(_parabola([row[j] for row in rows])):
                    found[i, j] = coefficients
            for x, y in further:
                expected = _mixed([x**i * y**j for i, j in POWERS], [found[k] for k in POWERS])
                need(values[x, y] == expected, "a piece is not of this form")
            out[kind].append(found)
    return out


def _mixed(factors: Sequence[Fraction], lists: Sequence[list[Fraction]]) -> list[Fraction]:
    """The sum of lists, each times a factor."""
    return [sum(map(mul, factors, column), Fraction(0)) for column in zip(*lists, strict=True)]


def _times(*factors: Poly) -> Poly:
    out = ONE
    for p in factors:
        product: Poly = {}
        for (i, j), x in out.items():
            for (k, m), y in p.items():
                product[i + k, j + m] = product.get((i + k, j + m), 0) + x * y
        out = product
    return out


def _sum(terms: Sequence[tuple[Fraction, Poly]], clock: Clock) -> Quotient:
    """Polynomials times numbers, added up over one denominator of all numbers."""
    unit = 1
    for factor, _ in terms:
        clock.check()
        unit = lcm(unit, factor.denominator)
    out: Poly = {}
    for factor, p in terms:
        clock.check()
        whole = factor.numerator * (unit // factor.denominator)
        for key, x in p.items():
            out[key] = out.get(key, 0) + whole * x
    return out, unit


def _whole(ratios: Ratios) -> Whole:
    unit = lcm(*(c.denominator for x in ratios.values() for c in x))
    return {key: [int(c * unit) for c in x] for key, x in ratios.items()}, unit


def _value(poly: Sequence[int], order: int, place: int) -> int:
    """A derivative of a polynomial at place/PLACES, times PLACES to the power of its degree."""
    total = 0
    for p in range(len(poly) - 1, order - 1, -1):
        total = total * place + perm(p, order) * poly[p] * PLACES ** (len(poly) - 1 - p)
    return total


def _parabola(nodes: list[list[Fraction]]) -> list[list[Fraction]]:
    """Coefficients of the parabolas with these values at 1, 2, 3: ascending."""
    out: list[list[Fraction]] = [[], [], []]
    for v1, v2, v3 in zip(*nodes, strict=True):
        c = (v3 - 2 * v2 + v1) / 2
        b = v2 - v1 - 3 * c
        for values, x in zip(out, (v1 - b - c, b, c), strict=True):
            values.append(x)
    return out


def _on_square(ratios: dict[tuple[int, int], int]) -> Poly:
    """a²b²·Σ c·xⁱyʲ in a and b."""
    out: Poly = {}
    for (i, j), c in ratios.items():
        for key, x in _monomial(i, j).items():
            out[key] = out.get(key, 0) + c * x
    return out


@cache
def _monomial(i: int, j: int) -> Poly:
    """a²b²·xⁱyʲ in a and b."""
    a: Poly = {(1, 0): 1}
    a1: Poly = {(0, 0): 1, (1, 0): -1}
    b: Poly = {(0, 1): 1}
    b1: Poly = {(0, 0): 1, (0, 1): -1}
    return _times(*[a] * (2 - i), *[a1] * i, *[b] * (2 - j), *[b1] * j)


def _covers(poly: Poly, box: Square, clock: Clock) -> bool:
    """Whether all Bernstein coefficients on a box are ≥ 0."""
    table = [[0] * SIZE for _ in range(SIZE)]
    for (i, j), x in poly.items():
        table[i][j] = x
    for low, high in (box[2:], box[:2]):
        blossom = _blossom(low, high)
        table = [[sum(map(mul, line, row)) for row in blossom] for line in clock.each(table)]
        table = [list(line) for line in zip(*table, strict=True)]
    return all(x >= 0 for line in table for x in line)


@lru_cache(maxsize=256)  # of the sides of boxes, which come again and again
def _blossom(low: Fraction, high: Fraction) -> Sequence[list[int]]:
    """Weights of the powers in each Bernstein coefficient, times a positive number.

    Coefficient i is the blossom of the polynomial at i arguments ``high``, the others ``low``: that
    of tᵖ is e_p(arguments)/C(n, p), e_p the elementary symmetric polynomial.
    """
    n, scale = SIZE - 1, lcm(low.denominator, high.denominator)
    first, last = int(low * scale), int(high * scale)
    out = []
    for i in range(n + 1):
        # Elementary symmetric sums of the arguments, by the product of (1 + argument·z).
        sums = [1] + [0] * n
        for argument in [last] * i + [first] * (n - i):
            for p in range(n, 0, -1):
                sums[p] += argument * sums[p - 1]
        units = (scale ** (n - p) * BINOMIALS // comb(n, p) for p in range(n + 1))
        out.append([e * unit for e, unit in zip(sums, units, strict=True)])
    return out
