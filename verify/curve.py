"""The curves of a problem for given durations, from their conditions, in rationals."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import comb, lcm, perm

from .problem import StatedProblem
from .reading import Clock, need, required

Pieces = list[list[list[Fraction]]]
"""Coefficients [joint][segment][power] in the time since the start of the segment."""

UNIFORM = "uniform cubic B-spline, segments stretched in time"
"""Name of the curve whose pieces have a time of their own."""

_HALVINGS = 60
"""Of a piece, to see that a polynomial is nowhere negative on it: beyond any float."""


def pieces(problem: StatedProblem, h: Sequence[Fraction], clock: Clock) -> Pieces:
    """The curve of a declared piecewise polynomial, from its conditions by Gauss elimination.

    Parameters
    ----------
    problem : StatedProblem
        With a declaration.
    h : sequence of Fraction
        Durations, s, positive.
    clock : Clock

    Returns
    -------
    Pieces

    Raises
    ------
    Refused
        If the conditions do not determine the curve.
    """
    declared = required(problem.declaration, "the curve is no declared piecewise polynomial")
    n, joints = len(declared.degrees), problem.joints
    first = [sum(d + 1 for d in declared.degrees[:k]) for k in range(n + 1)]
    rows: list[tuple[dict[int, Fraction], list[Fraction]]] = []

    def side(segment: int, t: Fraction, order: int, sign: int) -> dict[int, Fraction]:
        powers = range(order, declared.degrees[segment] + 1)
        terms = {first[segment] + p: sign * perm(p, order) * t ** (p - order) for p in powers}
        return {column: x for column, x in terms.items() if x}

    angles = iter(problem.waypoints)
    for b in range(n + 1):
        held = dict(declared.prescribed[b])
        if b not in declared.virtual:
            held[0] = next(angles)
        for order, values in held.items():
            if b > 0:
                rows.append((side(b - 1, h[b - 1], order, 1), list(values)))
            if b < n:
                rows.append((side(b, Fraction(0), order, 1), list(values)))
        if 0 < b < n:
            for order in set(range(declared.continuity[b - 1] + 1)) - set(held):
                left = side(b - 1, h[b - 1], order, 1)
                both = {**left, **side(b, Fraction(0), order, -1)}
                rows.append((both, [Fraction(0)] * joints))
    need(len(rows) == first[n], "the conditions do not determine the curve")
    solved = _solve(rows, clock)
    return [
        [[solved[c][j] for c in range(first[k], first[k + 1])] for k in range(n)]
        for j in range(joints)
    ]


def _solve(
    rows: list[tuple[dict[int, Fraction], list[Fraction]]], clock: Clock
) -> list[list[Fraction]]:
    """Solve a square sparse system; the shortest row with an entry in a column is its pivot."""
    left, done = list(rows), []
    for column in range(len(rows)):
        clock.check()
        holding = [i for i, (row, _) in enumerate(left) if column in row]
        need(bool(holding), "the conditions do not determine the curve")
        row, right = left.pop(min(holding, key=lambda i: len(left[i][0])))
        for other, values in left:
            if column not in other:
                continue
            clock.check()
            factor = other[column] / row[column]
            for key, x in row.items():
                rest = other.get(key, Fraction(0)) - factor * x
                if rest:
                    other[key] = rest
                else:
                    other.pop(key, None)
            both = zip(values, right, strict=True)
            values[:] = [x - factor * y for x, y in clock.each(both)]
        done.append((column, row, right))
    solved: list[list[Fraction]] = [[] for _ in rows]
    for column, row, right in reversed(done):
        clock.check()
        known = list(right)
        for key, x in row.items():
            if key != column:
                both = zip(known, solved[key], strict=True)
                known = [r - x * y for r, y in clock.each(both)]
        solved[column] = [r / row[column] for r in clock.each(known)]
    return solved


def uniform_pieces(problem: StatedProblem, clock: Clock) -> Pieces:
    """The uniform cubic B-spline through the way-points, each segment in a time from 0 to 1.

    A C2 cubic spline on unit steps whose slopes m satisfy m₋ + 4m + m₊ = 3(q₊ − q₋), here with
    both end slopes half the ends' second derivatives (equal control vertices V₀ = V₁): 2m = q″
    at the start, 2m = −q″ at the end.

    Parameters
    ----------
    problem : StatedProblem
    clock : Clock

    Returns
    -------
    Pieces
    """
    return [_uniform(list(column), clock) for column in zip(*problem.waypoints, strict=True)]


def _uniform(q: Sequence[Fraction], clock: Clock) -> list[list[Fraction]]:
    n = len(q)
    # q″ at the start of a piece is 6(q₁ − q₀) − 4m₀ − 2m₁, at its end 2m₀ + 4m₁ − 6(q₁ − q₀).
    diagonal = [Fraction(6), *[Fraction(4)] * (n - 2), Fraction(6)]
    above = [Fraction(2), *[Fraction(1)] * (n - 2)]
    below = [*[Fraction(1)] * (n - 2), Fraction(2)]
    right = [6 * (q[1] - q[0])]
    right += [3 * (q[i + 1] - q[i - 1]) for i in range(1, n - 1)]
    right += [6 * (q[-1] - q[-2])]
    for i in clock.each(range(1, n)):
        factor = below[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * above[i - 1]
        right[i] -= factor * right[i - 1]
    slopes = [right[-1] / diagonal[-1]]
    for i in clock.each(range(n - 2, -1, -1)):
        slopes.append((right[i] - above[i] * slopes[-1]) / diagonal[i])
    slopes.reverse()
    found = []
    both = zip(pairwise(q), pairwise(slopes), strict=True)
    for (a, b), (u, w) in clock.each(both):
        found.append([a, u, 3 * (b - a) - 2 * u - w, u + w - 2 * (b - a)])
    return found


# --- polynomials ----------------------------------------------------------------------------------


def derivative(poly: Sequence[Fraction], order: int) -> list[Fraction]:
    """Ascending coefficients of a derivative."""
    return [perm(p, order) * c for p, c in enumerate(poly)][order:] or [Fraction(0)]


def value_at(poly: Sequence[Fraction], t: Fraction) -> Fraction:
    """Value of a polynomial with ascending coefficients."""
    return sum((c * t**p for p, c in enumerate(poly)), Fraction(0))


def nonnegative(poly: Sequence[Fraction], high: Fraction, clock: Clock) -> bool:
    """Whether a polynomial is ≥ 0 on [0, high]: Bernstein coefficients, by bisection.

    One that touches 0 between the dyadic places of [0, high] is not seen to be.
    """
    n = len(poly) - 1
    scaled = [c * high**p for p, c in enumerate(poly)]
    unit = lcm(*(c.denominator for c in scaled)) * lcm(*(comb(n, k) for k in range(n + 1)))
    whole = [int(c * unit) for c in scaled]
    # Integers from here on: positive multiples of the coefficients.
    control = [sum(comb(i, k) * whole[k] // comb(n, k) for k in range(i + 1)) for i in range(n + 1)]
    left = [(control, _HALVINGS)]
    while left:
        row, more = left.pop()
        if min(row) >= 0:
            continue
        if more == 0 or row[0] < 0 or row[-1] < 0:
            return False
        clock.check()
        low, top = [], []
        for k in range(n, -1, -1):
            low.append(row[0] << k)
            top.append(row[-1] << k)
            row = [x + y for x, y in pairwise(row)]
        left += [(low, more - 1), (top[::-1], more - 1)]
    return True
