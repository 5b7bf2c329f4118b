"""A declared curve as a linear function of few unknowns, solved exactly once for all durations.

In s = (t − t_k)/h_k every condition is free of the durations but the continuity of derivatives, and
derivatives prescribed other than 0: way-points, derivatives that are 0, and positions that agree at
a virtual way-point. They are solved in rationals: c = c₀ + N x with as many unknowns x as there are
derivatives that are to agree. A derivative p ≠ 0 of order r agrees with that of a neighbour beyond
the end of the piece, which takes 1 in the proof's unit of time and whose scaled derivative is p.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import perm
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .problem import Declaration
from .reading import Clock, need

Array = NDArray[np.float64]
Sparse = dict[int, Fraction]


@dataclass(frozen=True, eq=False)
class Form:
    """Floats nearest to what was solved exactly; p counts the derivatives that are to agree.

    Attributes
    ----------
    basis : ndarray, shape (segments, degree + 1, unknowns)
        N by segment and power; 0 above a segment's degree.
    fixed : ndarray, shape (segments, degree + 1, joints)
        c₀.
    ends, starts : ndarray, shape (p, unknowns)
        α N and β N: the scaled derivative at the end of the segment before, and at the start of the
        one behind, by unknown; 0 where that is a neighbour beyond an end.
    end, start : ndarray, shape (p, joints)
        What c₀ adds to them, or the derivative that is prescribed.
    breaks, orders : ndarray of int, shape (p,)
    sides : ndarray of int, shape (breaks, 2)
        Segments before and behind each break; as many as there are segments stands for a neighbour
        that takes 1.
    """

    basis: Array
    fixed: Array
    ends: Array
    end: Array
    starts: Array
    start: Array
    breaks: NDArray[np.int64]
    orders: NDArray[np.int64]
    sides: NDArray[np.int64]


def linear_form(
    declared: Declaration, waypoints: Sequence[Sequence[Fraction]], clock: Clock
) -> Form:
    """Solve the conditions that are free of the durations.

    Parameters
    ----------
    declared : Declaration
    waypoints : sequence of sequence of Fraction
        In the unit of the prescribed derivatives.
    clock : Clock

    Returns
    -------
    Form

    Raises
    ------
    Refused
        If the conditions contradict each other, or do not determine the curve.
    """
    n, joints = len(declared.degrees), len(waypoints[0])
    first = [sum(d + 1 for d in declared.degrees[:k]) for k in range(n + 1)]

    def side(segment: int, place: int, order: int) -> Sparse:
        powers = range(order, declared.degrees[segment] + 1)
        return {first[segment] + p: Fraction(perm(p, order)) for p in powers if place or p == order}

    conditions: list[tuple[Sparse, list[Fraction]]] = []
    none = [Fraction(0)] * joints
    agreeing: list[tuple[int, int, int, list[Fraction]]] = []
    angles = iter(waypoints)
    for b in range(n + 1):
        held = {r: x for r, x in declared.prescribed[b].items() if not any(x)}
        moving = sorted(set(declared.prescribed[b]) - set(held))
        if b not in declared.virtual:
            held[0] = list(next(angles))
        for order, values in held.items():
            if b > 0:
                conditions.append((side(b - 1, 1, order), list(values)))
            if b < n:
                conditions.append((side(b, 0, order), list(values)))
        if b > 0:
            agreeing += [(b - 1, n, order, declared.prescribed[b][order]) for order in moving]
        if 0 < b < n:
            if 0 not in held:
                both = {**side(b - 1, 1, 0), first[b]: Fraction(-1)}
                conditions.append((both, list(none)))
            free = set(range(1, declared.continuity[b - 1] + 1)) - set(held) - set(moving)
            agreeing += [(b - 1, b, order, none) for order in sorted(free)]
        if b < n:
            agreeing += [(n, b, order, declared.prescribed[b][order]) for order in moving]
    pivots = _eliminated(conditions, clock)
    unknowns = [column for column in range(first[n]) if column not in pivots]
    need(len(unknowns) == len(agreeing), "the conditions do not determine the curve")
    place = {column: at for at, column in enumerate(unknowns)}
    coefficients: list[tuple[list[Fraction], list[Fraction]]] = []
    for column in clock.each(range(first[n])):
        row = [Fraction(0)] * len(unknowns)
        if column in place:
            row[place[column]] = Fraction(1)
            coefficients.append((row, list(none)))
            continue
        terms, values = pivots[column]
        for other, x in terms.items():
            if other != column:
                row[place[other]] = -x
        coefficients.append((row, values))

    def combined(terms: Sparse) -> tuple[list[Fraction], list[Fraction]]:
        row, value = [Fraction(0)] * len(unknowns), list(none)
        for column, x in terms.items():
            row = [a + x * c for a, c in zip(row, coefficients[column][0], strict=True)]
            value = [a + x * c for a, c in zip(value, coefficients[column][1], strict=True)]
        return row, value

    def scaled(segment: int, place: int, order: int, values: list[Fraction]) -> Any:
        if segment == n:
            return [Fraction(0)] * len(unknowns), values
        return combined(side(segment, place, order))

    ends = [scaled(k, 1, order, x) for k, _, order, x in clock.each(agreeing)]
    starts = [scaled(k, 0, order, x) for _, k, order, x in clock.each(agreeing)]
    between = list(dict.fromkeys((left, right) for left, right, _, _ in agreeing))
    most, p = max(declared.degrees) + 1, len(agreeing)
    basis, fixed = np.zeros((n, most, p)), np.zeros((n, most, joints))
    for k in range(n):
        for power in range(declared.degrees[k] + 1):
            row, value = coefficients[first[k] + power]
            basis[k, power], fixed[k, power] = _floats([row])[0], _floats([value])[0]
    return Form(
        basis,
        fixed,
        _floats([row for row, _ in ends]).reshape(p, p),
        _floats([value for _, value in ends]).reshape(p, joints),
        _floats([row for row, _ in starts]).reshape(p, p),
        _floats([value for _, value in starts]).reshape(p, joints),
        np.array([between.index((left, right)) for left, right, _, _ in agreeing], np.int64),
        np.array([order for _, _, order, _ in agreeing], np.int64),
        np.array(between, np.int64).reshape(-1, 2),
    )


def _floats(rows: Sequence[Sequence[Fraction]]) -> Array:
    return np.array([[float(x) for x in row] for row in rows], np.float64)


def _eliminated(conditions: list[tuple[Sparse, list[Fraction]]], clock: Clock) -> dict[int, Any]:
    """Solve for one column of each condition: its row, without other such columns, and values."""
    order: list[int] = []
    pivots: dict[int, tuple[Sparse, list[Fraction]]] = {}

    def without(row: Sparse, values: list[Fraction], columns: Sequence[int]) -> None:
        for column in columns:
            factor = row.get(column)
            if not factor:
                continue
            terms, right = pivots[column]
            for key, x in terms.items():
                rest = row.get(key, Fraction(0)) - factor * x
                if rest:
                    row[key] = rest
                else:
                    row.pop(key, None)
            values[:] = [a - factor * b for a, b in zip(values, right, strict=True)]

    for row, values in clock.each(conditions):
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
