"""Whether the durations of a certificate keep every limit, in rationals: standard library only."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from math import comb, lcm, perm
from typing import Any

from .verify_problem import Stated, need, number

Pieces = list[list[list[Fraction]]]
"""Coefficients [joint][segment][power] in t − t_k."""


def pieces(problem: Stated, h: Sequence[Fraction]) -> Pieces:
    """The curve of a declared piecewise polynomial, from its conditions by Gauss elimination.

    Parameters
    ----------
    problem : Stated
        With a declaration.
    h : sequence of Fraction
        Durations, s, positive.

    Returns
    -------
    Pieces

    Raises
    ------
    Refused
        If the conditions do not determine the curve.
    """
    declared = problem.declaration
    need(declared is not None, "the curve is no declared piecewise polynomial")
    assert declared is not None
    n, joints = len(declared.degrees), len(problem.limits)
    first = [sum(d + 1 for d in declared.degrees[:k]) for k in range(n + 1)]
    rows: list[tuple[dict[int, Fraction], list[Fraction]]] = []

    def side(segment: int, t: Fraction, order: int, sign: int) -> dict[int, Fraction]:
        powers = range(order, declared.degrees[segment] + 1)
        terms = {first[segment] + p: sign * perm(p, order) * t ** (p - order) for p in powers}
        return {column: x for column, x in terms.items() if x}

    angles = iter(problem.waypoints)
    for b in range(n + 1):
        given = {order: [value] * joints for order, value in declared.prescribed[b].items()}
        if b not in declared.virtual:
            given[0] = next(angles)
        for order, values in given.items():
            if b > 0:
                rows.append((side(b - 1, h[b - 1], order, 1), list(values)))
            if b < n:
                rows.append((side(b, Fraction(0), order, 1), list(values)))
        if 0 < b < n:
            for order in set(range(declared.continuity[b - 1] + 1)) - set(given):
                left = side(b - 1, h[b - 1], order, 1)
                both = {**left, **side(b, Fraction(0), order, -1)}
                rows.append((both, [Fraction(0)] * joints))
    need(len(rows) == first[n], "the conditions do not determine the curve")
    solved = _solve(rows, joints)
    return [
        [[solved[c][j] for c in range(first[k], first[k + 1])] for k in range(n)]
        for j in range(joints)
    ]


def _solve(
    rows: list[tuple[dict[int, Fraction], list[Fraction]]], joints: int
) -> list[list[Fraction]]:
    """Solve a square sparse system; the shortest row with an entry in a column is its pivot."""
    left, done = list(rows), []
    for column in range(len(rows)):
        holding = [i for i, (row, _) in enumerate(left) if column in row]
        need(bool(holding), "the conditions do not determine the curve")
        row, right = left.pop(min(holding, key=lambda i: len(left[i][0])))
        for other, values in left:
            if column not in other:
                continue
            factor = other[column] / row[column]
            for key, x in row.items():
                rest = other.get(key, Fraction(0)) - factor * x
                if rest:
                    other[key] = rest
                else:
                    other.pop(key, None)
            values[:] = [x - factor * y for x, y in zip(values, right, strict=True)]
        done.append((column, row, right))
    solved: list[list[Fraction]] = [[] for _ in rows]
    for column, row, right in reversed(done):
        known = list(right)
        for key, x in row.items():
            if key != column:
                known = [r - x * y for r, y in zip(known, solved[key], strict=True)]
        solved[column] = [r / row[column] for r in known]
    return solved


def derivative(poly: Sequence[Fraction], order: int) -> list[Fraction]:
    """Ascending coefficients of a derivative."""
    return [perm(p, order) * c for p, c in enumerate(poly)][order:] or [Fraction(0)]


def at(poly: Sequence[Fraction], t: Fraction) -> Fraction:
    """Value of a polynomial with ascending coefficients."""
    return sum((c * t**p for p, c in enumerate(poly)), Fraction(0))


def nonnegative(poly: Sequence[Fraction], high: Fraction, depth: int = 60) -> bool:
    """Whether a polynomial is ≥ 0 on [0, high]: Bernstein coefficients, by bisection."""
    n = len(poly) - 1
    scaled = [c * high**p for p, c in enumerate(poly)]
    unit = lcm(*(c.denominator for c in scaled)) * lcm(*(comb(n, k) for k in range(n + 1)))
    whole = [int(c * unit) for c in scaled]
    # Integers from here on: positive multiples of the coefficients.
    control = [sum(comb(i, k) * whole[k] // comb(n, k) for k in range(i + 1)) for i in range(n + 1)]
    left = [(control, depth)]
    while left:
        row, more = left.pop()
        if min(row) >= 0:
            continue
        if more == 0 or row[0] < 0 or row[-1] < 0:
            return False
        low, top = [], []
        for k in range(n, -1, -1):
            low.append(row[0] << k)
            top.append(row[-1] << k)
            row = [x + y for x, y in pairwise(row)]
        left += [(low, more - 1), (top[::-1], more - 1)]
    return True


def check_durations(problem: Stated, h: Sequence[Fraction]) -> None:
    """Refuse durations that are outside their bounds."""
    need(len(h) == len(problem.longest), "answer: one duration per segment")
    for k, x in enumerate(h):
        top = problem.longest[k]
        inside = x > 0 and x >= problem.shortest[k] and (top is None or x <= top)
        need(inside, f"answer: duration {k + 1} is outside its bounds")


def check_answer(problem: Stated, h: Sequence[Fraction]) -> None:
    """Refuse durations whose trajectory does not keep every limit at all times.

    A limit on a derivative asks for a continuous derivative one order below.

    Parameters
    ----------
    problem : Stated
        With a declaration.
    h : sequence of Fraction
        Durations, s.

    Raises
    ------
    Refused
        With the joint, the segment and the derivative.
    """
    check_durations(problem, h)
    for j, curve in enumerate(pieces(problem, h)):
        for order in (2, 3):
            if problem.limits[j][order - 1] is None:
                continue
            what = "velocity" if order == 2 else "acceleration"
            below = [derivative(piece, order - 1) for piece in curve]
            for k, (left, right) in enumerate(pairwise(below)):
                need(at(left, h[k]) == right[0], f"answer: the {what} jumps")
        for k, piece in enumerate(curve):
            limits = [
                (r, s, x[0]) for r, x in enumerate(problem.limits[j], 1) if x for s in (1, -1)
            ]
            low, high = problem.position[0][j], problem.position[1][j]
            limits += [(0, 1, high[0])] if high else []
            limits += [(0, -1, -low[1])] if low else []
            for order, sign, limit in limits:
                rest = [-sign * c for c in derivative(piece, order)]
                rest[0] += limit
                need(
                    nonnegative(rest, h[k]),
                    f"answer: joint {j + 1}, segment {k + 1}, derivative {order} exceeds its limit",
                )


def read_answer(claim: dict[str, Any]) -> tuple[list[Fraction], Fraction] | None:
    """Durations and upper bound that a claim states, not yet judged; None if it states none."""
    if claim["durations"] is None:
        need(claim["upper"] is None, "an upper bound without durations")
        return None
    h, upper = [number(x) for x in claim["durations"]], number(claim["upper"])
    need(sum(h) <= upper, "the durations exceed the upper bound")
    return h, upper
