"""A declared curve as a linear function of few unknowns, solved exactly once for all durations.

In s = (t − t_k)/h_k every condition is free of the durations but the continuity of derivatives, and
derivatives prescribed other than 0: way-points, derivatives that are 0, and positions that agree at
a virtual way-point. They are solved in rationals: c = c₀ + N x with as many unknowns x as there are
derivatives that are to agree. A derivative p ≠ 0 of order r agrees with that of a neighbour beyond
the end of the piece, which takes 1 in the proof's unit of time and whose scaled derivative is p.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from .curve import at_end, conditions, eliminated, first_columns
from .problem import Declaration
from .reading import Clock, need

Array = NDArray[np.float64]


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
    n, joints, first = len(declared.degrees), len(waypoints[0]), first_columns(declared)
    one, none = Fraction(1), [Fraction(0)] * joints
    agreeing: list[tuple[int, int, int, list[Fraction]]] = []
    still: list[dict[int, list[Fraction]]] = []
    for b, held in enumerate(declared.prescribed):
        still.append({order: values for order, values in held.items() if not any(values)})
        moving = sorted(set(held) - set(still[b]))
        if b > 0:
            agreeing += [(b - 1, n, order, held[order]) for order in moving]
        if 0 < b < n:
            free = set(range(1, declared.continuity[b - 1] + 1)) - set(held)
            agreeing += [(b - 1, b, order, none) for order in sorted(free)]
        if b < n:
            agreeing += [(n, b, order, held[order]) for order in moving]
    fixed_part = replace(declared, prescribed=still, continuity=[0] * (n - 1))
    pivots = eliminated(conditions(fixed_part, waypoints, [one] * n), clock)
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

    def scaled(
        segment: int, t: Fraction, order: int, values: list[Fraction]
    ) -> tuple[list[Fraction], list[Fraction]]:
        row, value = [Fraction(0)] * len(unknowns), list(none)
        if segment == n:
            return row, values
        for power, x in at_end(declared, segment, t, order).items():
            own = coefficients[first[segment] + power]
            row = [a + x * c for a, c in zip(row, own[0], strict=True)]
            value = [a + x * c for a, c in zip(value, own[1], strict=True)]
        return row, value

    ends = [scaled(k, one, order, x) for k, _, order, x in clock.each(agreeing)]
    starts = [scaled(k, 0 * one, order, x) for _, k, order, x in clock.each(agreeing)]
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
