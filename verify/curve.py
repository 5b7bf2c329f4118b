"""The curves of a problem for given durations, from their conditions, in rationals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import accumulate, pairwise
from math import comb, lcm, perm

from .problem import Declaration, StatedProblem
from .reading import Clock, need, required

Pieces = list[list[list[Fraction]]]
"""Coefficients [joint][segment][power] in s, the time since the start of the segment divided by its
duration: from 0 to 1."""

Sparse = dict[int, Fraction]
Condition = tuple[Sparse, list[Fraction]]
"""Factors by coefficient, and a right-hand side for each joint."""

UNIFORM = "uniform cubic B-spline, segments stretched in time"
"""Name of the curve whose pieces, in s, do not change with the durations."""

_HALVINGS = 60
"""Of a piece, to see that a polynomial is nowhere negative on it: beyond any float."""


def pieces(problem: StatedProblem, h: Sequence[Fraction], clock: Clock) -> Pieces:
    """A declared piecewise polynomial or `UNIFORM`, from its conditions by elimination.

    `UNIFORM` is a C2 cubic spline for durations of 1 whose first two and last two control vertices
    are equal: q′ = q″/2 at the start and q′ = −q″/2 at the end.

    Parameters
    ----------
    h : sequence of Fraction
        Durations, s, positive.

    Raises
    ------
    Refused
        If the conditions do not determine the curve, or contradict each other.
    """
    declared, n = problem.declaration, problem.segments
    if problem.curve == UNIFORM:
        declared = Declaration([3] * n, [2] * (n - 1), [{}] * (n + 1), [])
        one, none = Fraction(1), [Fraction(0)] * problem.joints
        rows = [
            ({1: one, 2: -one}, none),
            *conditions(declared, problem.waypoints, [one] * n),
            ({4 * n - 3: one, 4 * n - 2: 3 * one, 4 * n - 1: 6 * one}, none),
        ]
    else:
        declared = required(declared, "the curve is not a declared piecewise polynomial")
        rows = conditions(declared, problem.waypoints, h)
    first = first_columns(declared)
    need(len(rows) == first[-1], "the conditions do not determine the curve")
    solved = eliminated(rows, clock)
    need(len(solved) == first[-1], "the conditions do not determine the curve")
    return [
        [[solved[c][1][j] for c in range(a, b)] for a, b in pairwise(first)]
        for j in range(problem.joints)
    ]


def first_columns(declared: Declaration) -> list[int]:
    """Number of the first coefficient of each piece, and of all of them."""
    return list(accumulate((d + 1 for d in declared.degrees), initial=0))


def at_end(declared: Declaration, segment: int, end: int, order: int) -> dict[int, int]:
    """A derivative by s at an end of a piece, 0 or 1, by its coefficients, counted from 0."""
    powers = range(order, declared.degrees[segment] + 1 if end else order + 1)
    return {p: perm(p, order) for p in powers}


def conditions(
    declared: Declaration, waypoints: Sequence[Sequence[Fraction]], h: Sequence[Fraction]
) -> list[Condition]:
    """Equations of the coefficients of all pieces, for given durations."""
    n, first = len(declared.degrees), first_columns(declared)
    rows: list[Condition] = []

    def side(segment: int, end: int, order: int, sign: int = 1) -> Sparse:
        unit = sign / h[segment] ** order
        own = at_end(declared, segment, end, order)
        return {first[segment] + p: x * unit for p, x in own.items()}

    angles, none = iter(waypoints), [Fraction(0)] * len(waypoints[0])
    for b in range(n + 1):
        held = dict(declared.prescribed[b])
        if b not in declared.virtual:
            held[0] = list(next(angles))
        for order, values in held.items():
            if b > 0:
                rows.append((side(b - 1, 1, order), list(values)))
            if b < n:
                rows.append((side(b, 0, order), list(values)))
        if 0 < b < n:
            for order in set(range(declared.continuity[b - 1] + 1)) - set(held):
                both = side(b - 1, 1, order) | side(b, 0, order, -1)
                rows.append((both, list(none)))
    return rows


def eliminated(rows: Sequence[Condition], clock: Clock) -> dict[int, Condition]:
    """Solve for one column of each row: by column that row, without other such columns, and values.

    Raises
    ------
    Refused
        If rows contradict each other.
    """
    order: list[int] = []
    pivots: dict[int, Condition] = {}

    def without(row: Sparse, values: list[Fraction], columns: Iterable[int]) -> None:
        for column in columns:
            factor = row.get(column)
            if not factor:
                continue
            clock.check()
            terms, right = pivots[column]
            for key, x in terms.items():
                rest = row.get(key, Fraction(0)) - factor * x
                if rest:
                    row[key] = rest
                else:
                    row.pop(key, None)
            values[:] = [a - factor * b for a, b in zip(values, right, strict=True)]

    for row, values in clock.each(rows):
        without(row, values, order)
        if not row:
            need(not any(values), "the conditions contradict each other")
            continue
        column = min(row)
        scale = row[column]
        pivots[column] = ({key: x / scale for key, x in row.items()}, [x / scale for x in values])
        order.append(column)
    for at in range(len(order) - 1, -1, -1):
        clock.check()
        row, values = pivots[order[at]]
        without(row, values, order[at + 1 :])
    return pivots


# --- polynomials ----------------------------------------------------------------------------------


def derivative(poly: Sequence[Fraction], order: int) -> list[Fraction]:
    """Ascending coefficients of a derivative."""
    return [perm(p, order) * c for p, c in enumerate(poly)][order:] or [Fraction(0)]


def value_at(poly: Sequence[Fraction], t: Fraction) -> Fraction:
    """Value of a polynomial with ascending coefficients."""
    return sum((c * t**p for p, c in enumerate(poly)), Fraction(0))


def nonnegative(poly: Sequence[Fraction], clock: Clock) -> bool:
    """Whether a polynomial is ≥ 0 on [0, 1]: Bernstein coefficients, by bisection.

    One that touches 0 between the dyadic places of [0, 1] is not seen to be.
    """
    n = len(poly) - 1
    unit = lcm(*(c.denominator for c in poly)) * lcm(*(comb(n, k) for k in range(n + 1)))
    whole = [int(c * unit) for c in poly]
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
