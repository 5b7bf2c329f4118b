"""Limits of 3-5-3 motions as polynomials in two numbers, exactly and as arrays of floats.

With a = h₁/(h₁ + h₂) and b = h₃/(h₂ + h₃) every direction of durations is one point of the unit
square: h_g = T·m_g/S for m = (a(1−b), (1−a)(1−b), b(1−a)), S = 1 − ab and T = h₁ + h₂ + h₃. The
cubics are q₀ + d₁s³ and q₃ − d₃(1−s)³, so that with x = h₂/h₁ and y = h₂/h₃ the quintic's scaled
derivative h₂ʳq⁽ʳ⁾(s) is α + β₁x + γ₁x² + β₂y + γ₂y² (Hermite form).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .exact import ExactProblem

Array = NDArray[np.float64]
Poly = NDArray[np.object_]
"""Coefficients of aⁱbʲ, exact."""

PLACES = 2**20
"""Places on the quintic are multiples of 1/PLACES."""
STRICT = Fraction(1, 2**40)
"""Relaxation that makes a limit without the total time strict."""
TOTAL = -1
"""Cap on the durations: the total; 0, 1, 2 mean the upper bound of that segment."""

# Hermite basis on [0, 1], ascending: blend of the positions, velocities and accelerations.
_HALF = Fraction(1, 2)
HERMITE: tuple[tuple[Fraction | int, ...], ...] = (
    (0, 0, 0, 10, -15, 6),
    (0, 1, 0, -6, 8, -3),
    (0, 0, _HALF, -3 * _HALF, 3 * _HALF, -_HALF),
    (0, 0, 0, -4, 7, -3),
    (0, 0, 0, _HALF, -1, _HALF),
)


@dataclass(frozen=True)
class Row:
    """One necessary condition on the durations.

    Attributes
    ----------
    kind : str
        "place" (a derivative of the quintic at s), "first", "last" (the cubic's largest
        derivative), "mean" (mean speed of the quintic), "lower" (lower bound of a duration).
    joint : int
        Joint, or the segment for "lower".
    order : int
        Derivative order; 1 for "mean" and "lower".
    sign : int
        Side of the limit, ±1.
    place : int
        s·PLACES.
    cap : int
        What holds the durations down: `TOTAL`, or the segment whose upper bound does.
    """

    kind: str
    joint: int
    order: int
    sign: int = 1
    place: int = 0
    cap: int = TOTAL


def _poly(terms: dict[tuple[int, int], int]) -> Poly:
    size = 1 + max((max(k) for k in terms), default=0)
    array = np.zeros((size, size), dtype=object)
    for (i, j), value in terms.items():
        array[i, j] += value
    return array


def times(p: Poly, q: Poly) -> Poly:
    """Product of two polynomials in a and b."""
    out = np.zeros((p.shape[0] + q.shape[0] - 1, p.shape[1] + q.shape[1] - 1), dtype=object)
    for (i, j), value in np.ndenumerate(p):
        if value != 0:
            out[i : i + q.shape[0], j : j + q.shape[1]] += value * q
    used = np.argwhere(out != 0)
    rows, columns = used.max(axis=0) + 1 if used.size else (1, 1)
    return out[:rows, :columns]


def power(p: Poly, exponent: int) -> Poly:
    """Power of a polynomial."""
    out = np.ones((1, 1), dtype=object)
    for _ in range(exponent):
        out = times(out, p)
    return out


def padded(p: Poly, size: int) -> Poly:
    """The same polynomial in an array of ``size`` × ``size``."""
    out = np.zeros((size, size), dtype=object)
    out[: p.shape[0], : p.shape[1]] = p
    return out


A, B = _poly({(1, 0): 1}), _poly({(0, 1): 1})
A1, B1 = _poly({(0, 0): 1, (1, 0): -1}), _poly({(0, 0): 1, (0, 1): -1})
SUM = _poly({(0, 0): 1, (1, 1): -1})
SHARES = (times(A, B1), times(A1, B1), times(B, A1))
SQUARE = times(power(A, 2), power(B, 2))
# a²b²·(1, x, x², y, y²)
MONOMIALS = (
    SQUARE,
    times(times(A, A1), power(B, 2)),
    times(power(A1, 2), power(B, 2)),
    times(power(A, 2), times(B, B1)),
    times(power(A, 2), power(B1, 2)),
)
_SEGMENT = {"place": 1, "first": 0, "last": 2, "mean": 1}


def size_for(problem: ExactProblem) -> int:
    """Number of coefficients per variable that holds every row."""
    order = max(
        (r for row in problem.limits for r, x in enumerate(row, start=1) if x is not None),
        default=1,
    )
    return 3 + order


def hermite(order: int, s: Fraction) -> tuple[Fraction, ...]:
    """The derivative of each Hermite function, order 0 to 3, at s."""
    values = []
    for coefficients in HERMITE:
        total = Fraction(0)
        for p in range(5, order - 1, -1):
            factor = 1
            for i in range(order):
                factor *= p - i
            total = total * s + coefficients[p] * factor
        values.append(total)
    return tuple(values)


def _steps(problem: ExactProblem, joint: int) -> tuple[Fraction, Fraction, Fraction]:
    q = [row[joint] for row in problem.waypoints]
    return q[1] - q[0], q[2] - q[1], q[3] - q[2]


def exact_row(problem: ExactProblem, row: Row, total: Fraction) -> Poly:
    """Row as a polynomial that is negative at every feasible direction with a total < ``total``.

    Normalised: a feasible trajectory has (left side)/(limit·capʳ) − (shares) < 0.
    """
    cap = total
    if row.cap != TOTAL:
        upper = problem.duration_upper[row.cap]
        assert upper is not None
        cap = upper * (1 + STRICT)
    hold = SUM if row.cap == TOTAL else SHARES[row.cap]
    if row.kind == "lower":
        left = hold * (problem.duration_lower[row.joint] / cap)
        return _minus(left, SHARES[row.joint])
    d1, d2, d3 = _steps(problem, row.joint)
    if row.order == 0:
        end = (problem.position_upper if row.sign > 0 else problem.position_lower)[row.joint]
        assert end is not None
        limit = end.high + STRICT if row.sign > 0 else STRICT - end.low
    else:
        bound = problem.limits[row.joint][row.order - 1]
        assert bound is not None
        limit = bound.high
    if row.kind == "place":
        basis = hermite(row.order, Fraction(row.place, PLACES))
        start = problem.waypoints[1][row.joint] if row.order == 0 else Fraction(0)
        weights = (
            d2 * basis[0] + start,
            3 * d1 * basis[1],
            6 * d1 * basis[2],
            3 * d3 * basis[3],
            -6 * d3 * basis[4],
        )
        left = sum(padded(m, 3) * (row.sign * w) for m, w in zip(MONOMIALS, weights, strict=True))
        right = SQUARE
    else:
        if row.kind == "mean":
            way = abs(d2)
        else:
            way = (3 if row.order == 1 else 6) * abs(d1 if row.kind == "first" else d3)
        left, right = np.full((1, 1), way, dtype=object), np.ones((1, 1), dtype=object)
    if row.order == 0:
        return _minus(left, right * limit)
    left = times(left, power(hold, row.order)) * (1 / (limit * cap**row.order))
    return _minus(left, times(right, power(SHARES[_SEGMENT[row.kind]], row.order)))


def _minus(p: Poly, q: Poly) -> Poly:
    size = max(*p.shape, *q.shape)
    out: Poly = padded(p, size) - padded(q, size)
    return out


@lru_cache(maxsize=5_000)
def _bernstein(level: int, index: int, size: int) -> Poly:
    """Integer matrix from power to Bernstein coefficients on [index, index + 1]/2^level, scaled."""
    n = size - 1
    out = np.zeros((size, size), dtype=object)
    unit = math.lcm(*(math.comb(n, k) for k in range(size)))
    for j in range(size):
        # t^j ↦ ((index + t)/2^level)^j, times 2^(level·n).
        for k in range(j + 1):
            value = math.comb(j, k) * index ** (j - k) * 2 ** (level * (n - j))
            for i in range(k, size):
                out[i, j] += value * math.comb(i, k) * unit // math.comb(n, k)
    return out


def never_negative(poly: Poly, a: tuple[int, int], b: tuple[int, int]) -> bool:
    """Whether the Bernstein coefficients on a dyadic box, given as (level, index), are all ≥ 0."""
    size = poly.shape[0]
    entries = [Fraction(value) for row in poly.tolist() for value in row]
    unit = math.lcm(*(value.denominator for value in entries))
    integers = [int(value * unit) for value in entries]
    whole = np.array(integers, dtype=np.object_).reshape(size, size)
    local = _bernstein(*a, size) @ whole @ _bernstein(*b, size).T
    return bool(min(local.flat) >= 0)


class Prover:
    """Exact tests of weighted rows on boxes, for one problem and one total.

    Parameters
    ----------
    problem : ExactProblem
    total : Fraction
        No feasible total below it is what a proof says, in the problem's seconds.
    """

    def __init__(self, problem: ExactProblem, total: Fraction) -> None:
        self.problem, self.total = problem, total
        self.size = size_for(problem)
        self._rows: dict[Row, Poly] = {}

    def row(self, row: Row) -> Poly:
        """`exact_row`, remembered."""
        if row not in self._rows:
            self._rows[row] = padded(exact_row(self.problem, row, self.total), self.size)
        return self._rows[row]

    def proves(
        self,
        rows: tuple[Row, ...],
        weights: tuple[Fraction, ...],
        a: tuple[int, int],
        b: tuple[int, int],
    ) -> bool:
        """Whether Σ weight·row ≥ 0 all over a box: then nothing feasible in it is shorter."""
        if not rows or min(weights) < 0 or not any(weights):
            return False
        out = np.zeros((self.size, self.size), dtype=object)
        for row, weight in zip(rows, weights, strict=True):
            out = out + weight * self.row(row)
        return never_negative(out, a, b)


def static_rows(problem: ExactProblem) -> list[Row]:
    """Rows that hold at every point alike: the heaviest joint for each kind and order."""
    caps = [TOTAL] + [g for g, u in enumerate(problem.duration_upper) if u is not None]
    rows = []
    for cap in caps:
        for kind, step in (("first", 0), ("last", 2), ("mean", 1)):
            for order in (1, 2, 3) if kind != "mean" else (1,):
                best: tuple[Fraction, int] | None = None
                for joint in range(len(problem.joints)):
                    limit = problem.limits[joint][order - 1]
                    if limit is None or limit.high <= 0:
                        continue
                    ratio = abs(_steps(problem, joint)[step]) / limit.high
                    if ratio > 0 and (best is None or ratio > best[0]):
                        best = ratio, joint
                if best is not None:
                    rows.append(Row(kind, best[1], order, cap=cap))
        for g, lower in enumerate(problem.duration_lower):
            if lower > 0 and g != cap:
                rows.append(Row("lower", g, 1, cap=cap))
    return rows
