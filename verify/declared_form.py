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
Solved = NDArray[np.object_]
"""Rationals."""


@dataclass(frozen=True, eq=False)
class Form:
    """Floats nearest to what was solved exactly; p counts the derivatives that are to agree."""

    basis: Array
    """N by segment, power and unknown; 0 above a segment's degree."""
    fixed: Array
    """c₀ by segment, power and joint."""
    ends: Array
    """The scaled derivative p at the end of the segment before: α N by unknown, then what c₀ adds
    for each joint. Of a neighbour beyond an end: 0, then the derivative that is prescribed."""
    starts: Array
    """The same at the start of the segment behind, with β N."""
    breaks: NDArray[np.int64]
    orders: NDArray[np.int64]
    sides: NDArray[np.int64]
    """Segments before and behind each break; as many as there are segments stands for a neighbour
    that takes 1."""


def linear_form(
    declared: Declaration, waypoints: Sequence[Sequence[Fraction]], clock: Clock
) -> Form:
    """Solve the conditions that are free of the durations.

    Parameters
    ----------
    waypoints : sequence of sequence of Fraction
        In the unit of the prescribed derivatives.

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
    p = len(agreeing)
    solved = np.full((first[n], p + joints), Fraction(0))
    solved[unknowns, np.arange(p)] = one
    place = {column: at for at, column in enumerate(unknowns)}
    for column, (terms, values) in clock.each(pivots.items()):
        solved[column, p:] = values
        for other, x in terms.items():
            if other != column:
                solved[column, place[other]] = -x

    def scaled(segment: int, end: int, order: int, values: list[Fraction]) -> Solved:
        """Factors by unknown, and a value for each joint."""
        if segment == n:
            return np.array([Fraction(0)] * p + values)
        own = at_end(declared, segment, end, order).items()
        return np.asarray(sum(x * solved[first[segment] + power] for power, x in own))

    ends = [scaled(k, 1, order, x) for k, _, order, x in clock.each(agreeing)]
    starts = [scaled(k, 0, order, x) for _, k, order, x in clock.each(agreeing)]
    between = list(dict.fromkeys((left, right) for left, right, _, _ in agreeing))
    most = max(declared.degrees) + 1
    basis, fixed = np.zeros((n, most, p)), np.zeros((n, most, joints))
    for k, degree in enumerate(declared.degrees):
        own = solved[first[k] : first[k + 1]]
        basis[k, : degree + 1], fixed[k, : degree + 1] = own[:, :p], own[:, p:]
    return Form(
        basis,
        fixed,
        np.array(ends, np.float64).reshape(p, p + joints),
        np.array(starts, np.float64).reshape(p, p + joints),
        np.array([between.index((left, right)) for left, right, _, _ in agreeing], np.int64),
        np.array([order for _, _, order, _ in agreeing], np.int64),
        np.array(between, np.int64).reshape(-1, 2),
    )
