"""Spline fits in exact rational numbers and their peaks to 50 digits: no code of the package.

Everything is written in each segment's own time, unscaled, as the papers write it. The floats that
go in are taken at their exact value, so what comes out is the truth that float64 has to meet.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise

import numpy as np
from trajgap.problem import Interpolant

Polynomial = list[Fraction]
Number = float | Fraction


def solved(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """The solution of a linear system, by elimination."""
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    n = len(rows)
    for c in range(n):
        pivot = next(i for i in range(c, n) if rows[i][c])
        rows[c], rows[pivot] = rows[pivot], rows[c]
        rows[c] = [x / rows[c][c] for x in rows[c]]
        for i in range(n):
            if i != c and rows[i][c]:
                factor = rows[i][c]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[c], strict=True)]
    return [row[-1] for row in rows]


def fitted(
    interpolant: Interpolant,
    positions: Sequence[Number],
    durations: Sequence[Number],
    extra: dict[tuple[int, int], float] | None = None,
) -> list[Polynomial]:
    """Ascending coefficients in time of every segment of one joint.

    ``extra`` prescribes further derivatives, (break, order) -> value, on both sides of a break.
    """
    degrees, n = interpolant.degrees, len(interpolant.degrees)
    first = [sum(d + 1 for d in degrees[:k]) for k in range(n + 1)]
    h = [Fraction(x) for x in durations]
    waypoints = iter(positions)
    matrix: list[list[Fraction]] = []
    right: list[Fraction] = []

    def derivative(k: int, order: int, time: Fraction, sign: int = 1) -> dict[int, Fraction]:
        return {
            first[k] + p: sign * math.perm(p, order) * time ** (p - order)
            for p in range(order, degrees[k] + 1)
        }

    def state(entries: dict[int, Fraction], value: Fraction) -> None:
        matrix.append([entries.get(i, Fraction(0)) for i in range(first[-1])])
        right.append(value)

    for b in range(n + 1):
        given = {order: Fraction(value) for order, value in interpolant.prescribed[b]}
        given |= {
            order: Fraction(float(value)) for (at, order), value in (extra or {}).items() if at == b
        }
        if b not in interpolant.virtual:
            given[0] = Fraction(next(waypoints))
        for order, value in given.items():
            if b > 0:
                state(derivative(b - 1, order, h[b - 1]), value)
            if b < n:
                state(derivative(b, order, Fraction(0)), value)
        if 0 < b < n:
            for order in range(interpolant.continuity[b - 1] + 1):
                if order not in given:
                    left = derivative(b - 1, order, h[b - 1])
                    state(left | derivative(b, order, Fraction(0), -1), Fraction(0))
    solution = solved(matrix, right)
    return [solution[first[k] : first[k + 1]] for k in range(n)]


def derived(polynomial: Polynomial, order: int) -> Polynomial:
    """Derivative of a polynomial."""
    for _ in range(order):
        polynomial = [i * c for i, c in enumerate(polynomial)][1:] or [Fraction(0)]
    return polynomial


def _decimal(number: Number) -> Decimal:
    exact = Fraction(number)
    return Decimal(exact.numerator) / Decimal(exact.denominator)


def value(polynomial: Polynomial, time: Decimal) -> Decimal:
    """Value in the surrounding decimal precision."""
    total = Decimal(0)
    for c in reversed(polynomial):
        total = total * time + _decimal(c)
    return total


def _turns(polynomial: Polynomial, end: Decimal) -> list[Decimal]:
    """Roots inside (0, ``end``): companion-matrix roots, polished by Newton to 50 digits."""
    slope = derived(polynomial, 1)
    scaled = np.array([float(c * Fraction(end) ** i) for i, c in enumerate(polynomial)])
    found: list[Decimal] = []
    if not scaled.any():
        return found
    scaled = scaled / np.abs(scaled).max()
    roots = np.roots(np.trim_zeros(scaled[::-1], "f"))
    near = roots.real[(np.abs(roots.imag) < 1e-4) & (np.abs(roots.real - 0.5) < 0.51)]
    for start in near:
        t = Decimal(float(start)) * end
        for _ in range(60):
            steep = value(slope, t)
            step = value(polynomial, t) / steep if steep else Decimal(0)
            t -= step
            if abs(step) < Decimal(10) ** -50:
                break
        if 0 < t < end:
            found.append(t)
    return found


def extremes(
    pieces: list[Polynomial], durations: Sequence[Number], order: int
) -> tuple[Decimal, Decimal]:
    """Least and largest value of a derivative over all pieces, both ends of each included."""
    with localcontext() as context:
        context.prec = 60
        values = []
        for polynomial, h in zip(pieces, durations, strict=True):
            p, end = derived(polynomial, order), _decimal(h)
            values += [value(p, t) for t in (Decimal(0), end, *_turns(derived(p, 1), end))]
        return +min(values), +max(values)


def peak(pieces: list[Polynomial], durations: Sequence[Number], order: int) -> Decimal:
    """Largest absolute derivative."""
    least, most = extremes(pieces, durations, order)
    return max(-least, most)


def braking(
    pieces: list[Polynomial], durations: Sequence[Number], still: Number = 0
) -> tuple[Decimal, Decimal]:
    """Largest |acceleration| while the speed grows, and while it falls.

    Stretches on which the speed stays below ``still`` are left out.

    Between the roots of velocity, acceleration and jerk all three keep their sign, so that the
    middle tells which of both it is, and |acceleration| is largest at an end.
    """
    with localcontext() as context:
        context.prec = 60
        most = [Decimal(0), Decimal(0)]
        for polynomial, h in zip(pieces, durations, strict=True):
            end = _decimal(h)
            v, a = derived(polynomial, 1), derived(polynomial, 2)
            inner = [t for p in (v, a, derived(a, 1)) for t in _turns(p, end)]
            for left, right in pairwise(sorted([Decimal(0), end, *inner])):
                middle = (left + right) / 2
                speed = value(v, middle)
                if abs(speed) > _decimal(still):
                    falls = speed * value(a, middle) < 0
                    sizes = [abs(value(a, t)) for t in (left, right)]
                    most[falls] = max(most[falls], *sizes)
        return +most[0], +most[1]
