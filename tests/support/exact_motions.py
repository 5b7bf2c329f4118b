"""Motions as rational numbers: their samples, what interpolates them, and every peak, exactly.

Nothing here is the code under attack: splines are solved, and polynomials evaluated, in `Fraction`;
`exact_route` finds where a derivative turns to 50 digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np
from support import exact_route
from support.exact_route import derived as derived
from support.exact_route import solved

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
        every = (exact_route.extremes(self.pieces, steps(self.breaks), r) for r in range(4))
        return [(Fraction(low), Fraction(high)) for low, high in every]

    def jumps(self, order: int) -> Fraction:
        """The largest jump of a derivative at an inner break."""
        most = Fraction(0)
        for (first, second), h in zip(pairwise(self.pieces), steps(self.breaks), strict=False):
            end = value(derived(first, order), h)
            most = max(most, abs(value(derived(second, order), Fraction(0)) - end))
        return most

    def one_sided(self, still: Fraction) -> tuple[Fraction, Fraction]:
        """Largest |acceleration| while the speed grows, and while it falls; not below ``still``."""
        grows, falls = exact_route.braking(self.pieces, steps(self.breaks), still)
        return Fraction(grows), Fraction(falls)


def steps(times: Sequence[Fraction]) -> Exact:
    return [b - a for a, b in pairwise(times)]


def value(c: Exact, x: Fraction) -> Fraction:
    found = Fraction(0)
    for one in reversed(c):
        found = found * x + one
    return found


def hermite(rows: Sequence[Row], degree: int) -> Curve:
    """Straight lines, cubic or quintic polynomials between rows."""
    pieces = []
    for first, last in pairwise(rows):
        h = last.time - first.time
        c = [first.values[0], *(one / (r + 1) for r, one in enumerate(first.values[1:]))]
        c = c[: (degree + 1) // 2]
        left = [
            last.values[r] - value(derived(c, r), h) if r < len(c) else Fraction(0)
            for r in range((degree + 1) // 2)
        ]
        # What is left at the end is met by the upper half of the coefficients.
        size = len(left)
        matrix = [
            [
                Fraction(np.prod(range(size + p - r + 1, size + p + 1), dtype=object) or 1)
                * h ** (size + p - r)
                for p in range(size)
            ]
            for r in range(size)
        ]
        pieces.append([*c, *solved(matrix, left)])
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
