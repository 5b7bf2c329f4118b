"""Spline fits and peaks of polynomials in exact rational numbers: no code of the package.

Everything is written in each segment's own time, unscaled, as the papers write it. The floats that
go in are taken at their exact value, so what comes out is the truth that float64 has to meet.
Where a derivative turns is found in float64 and then evaluated exactly, so a peak is off by
the square of the place's error.
"""

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

import numpy as np
from trajgap.problem import Interpolant

Polynomial = list[Fraction]


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
    positions: Sequence[float | Fraction],
    durations: Sequence[float | Fraction],
    extra: Mapping[tuple[int, int], float | Fraction] | None = None,
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
        given |= {order: Fraction(value) for (at, order), value in (extra or {}).items() if at == b}
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


def value(polynomial: Polynomial, time: Fraction) -> Fraction:
    found = Fraction(0)
    for c in reversed(polynomial):
        found = found * time + c
    return found


def roots(polynomial: Polynomial, end: Fraction) -> list[Fraction]:
    """Places in (0, ``end``) that hold every real root, to float64; some hold none."""
    scaled = [one * end**k for k, one in enumerate(polynomial)]
    while len(scaled) > 1 and scaled[-1] == 0:
        scaled.pop()
    if len(scaled) == 2:
        exact = -scaled[0] / scaled[1]
        return [exact * end] if 0 < exact < 1 else []
    top = max(map(abs, scaled))
    if len(scaled) < 2 or top == 0:
        return []
    found = np.roots([float(one / top) for one in reversed(scaled)])
    # A double root may come as a pair that is not real.
    return [Fraction(float(z.real)) * end for z in found if 0 < z.real < 1]


def extremes(
    pieces: Sequence[Polynomial], durations: Sequence[float | Fraction], order: int
) -> tuple[Fraction, Fraction]:
    """Least and largest value of a derivative over all pieces, both ends of each included."""
    seen = [
        value(here, place)
        for c, h in zip(pieces, map(Fraction, durations), strict=True)
        for here in (derived(c, order),)
        for place in (Fraction(0), h, *roots(derived(here, 1), h))
    ]
    return min(seen), max(seen)


def peak(pieces: Sequence[Polynomial], durations: Sequence[float], order: int) -> Fraction:
    """Largest absolute derivative."""
    least, most = extremes(pieces, durations, order)
    return max(-least, most)


def braking(
    pieces: Sequence[Polynomial],
    durations: Sequence[float | Fraction],
    still: Fraction = Fraction(0),
) -> tuple[Fraction, Fraction]:
    """Largest |acceleration| while the speed grows, and while it falls.

    Between the roots of velocity, acceleration and jerk all three keep their sign, so the
    middle tells which of both it is, and |acceleration| is largest at an end. Stretches on which
    the speed stays below ``still`` are left out.
    """
    most = [Fraction(0), Fraction(0)]
    for c, h in zip(pieces, map(Fraction, durations), strict=True):
        v, a, j = (derived(c, order) for order in (1, 2, 3))
        inner = {x for one in (v, a, j) for x in roots(one, h)}
        for low, high in pairwise(sorted({Fraction(0), h, *inner})):
            speed = value(v, (low + high) / 2)
            grows = speed * value(a, (low + high) / 2) > 0
            if abs(speed) > still:
                here = max(abs(value(a, low)), abs(value(a, high)))
                most[not grows] = max(most[not grows], here)
    return most[0], most[1]
