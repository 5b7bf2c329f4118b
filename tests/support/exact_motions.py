"""Motions as rational numbers: their samples, what interpolates them, and every peak, exactly.

Nothing here is the code under attack: splines are solved, and polynomials evaluated, in `Fraction`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from support.exact_route import (
    braking,
    derived as derived,
    extremes,
    fitted,
    solved,
    value as value,
)
from trajgap.problem import Interpolant

Exact = list[Fraction]
"""Numbers, or ascending coefficients of a polynomial in the time since the start of its piece."""


@dataclass(frozen=True)
class Row:
    """Rational samples of one joint at one time: position, velocity, acceleration."""

    time: Fraction
    values: tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Curve:
    """One joint: times at which pieces meet, and each piece's coefficients."""

    breaks: Exact
    pieces: list[Exact]

    def at(self, time: Fraction, order: int) -> Fraction:
        for k, (begin, end) in enumerate(pairwise(self.breaks)):
            if time <= end or k == len(self.pieces) - 1:
                return value(derived(self.pieces[k], order), time - begin)
        raise AssertionError

    @cached_property
    def ranges(self) -> list[tuple[Fraction, Fraction]]:
        """Least and largest value of derivatives 0 to 3."""
        return [extremes(self.pieces, steps(self.breaks), order) for order in range(4)]

    def jumps(self, order: int) -> Fraction:
        """The largest jump of a derivative at an inner break."""
        most = Fraction(0)
        for (first, second), h in zip(pairwise(self.pieces), steps(self.breaks), strict=False):
            end = value(derived(first, order), h)
            most = max(most, abs(value(derived(second, order), Fraction(0)) - end))
        return most

    def one_sided(self, still: Fraction) -> tuple[Fraction, Fraction]:
        """Largest |acceleration| while the speed grows, and while it falls.

        Stretches on which the speed stays below ``still`` are left out.
        """
        return braking(self.pieces, steps(self.breaks), still)


def steps(times: Sequence[Fraction]) -> Exact:
    return [b - a for a, b in pairwise(times)]


def hermite(rows: Sequence[Row], degree: int) -> Curve:
    """Straight lines, cubic or quintic polynomials between rows."""
    orders = range(1, (degree + 1) // 2)
    one_piece = Interpolant((degree,), (), (tuple((r, 0.0) for r in orders),) * 2)
    pieces = []
    for ends in pairwise(rows):
        given = {(b, r): one.values[r] for b, one in enumerate(ends) for r in orders}
        first, last = ends
        step = [last.time - first.time]
        pieces += fitted(one_piece, [first.values[0], last.values[0]], step, given)
    return Curve([one.time for one in rows], pieces)


def spline(times: Exact, values: Exact) -> Curve:
    """The C2 cubic spline with not-a-knot ends, from its slopes."""
    h = steps(times)
    d = [(b - a) / one for (a, b), one in zip(pairwise(values), h, strict=True)]
    n = len(times)
    matrix = [[Fraction(0)] * n for _ in range(n)]
    right = [Fraction(0)] * n
    for k in range(1, n - 1):
        # Equal second derivatives at an inner sample.
        matrix[k][k - 1], matrix[k][k + 1] = 1 / h[k - 1], 1 / h[k]
        matrix[k][k] = 2 / h[k - 1] + 2 / h[k]
        right[k] = 3 * d[k - 1] / h[k - 1] + 3 * d[k] / h[k]
    for row, k in ((0, 0), (n - 1, n - 3)):
        # Equal third derivatives at the first inner sample, and at the last.
        first, second = h[k] ** 2, h[k + 1] ** 2
        matrix[row][k] += 1 / first
        matrix[row][k + 1] += 1 / first - 1 / second
        matrix[row][k + 2] -= 1 / second
        right[row] = 2 * d[k] / first - 2 * d[k + 1] / second
    slopes = solved(matrix, right)
    rows = [Row(t, (q, v, Fraction(0))) for t, q, v in zip(times, values, slopes, strict=True)]
    return hermite(rows, 3)
