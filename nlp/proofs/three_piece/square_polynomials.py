"""Exact polynomials in the two numbers a, b of the unit square of directions.

With a = h₁/(h₁ + h₂) and b = h₃/(h₂ + h₃) every direction of three durations is one point of the
square: h_g = T·m_g/S for m = `SHARES`, S = `SUM` and T = h₁ + h₂ + h₃. A polynomial of degree 2 in
each of x = h₂/h₁ = (1 − a)/a and y = h₂/h₃ = (1 − b)/b is one in a and b when multiplied by a²b².
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Poly = NDArray[np.object_]
"""Coefficients of aⁱbʲ, exact."""


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


def minus(p: Poly, q: Poly) -> Poly:
    """Difference of two polynomials, in a square array."""
    size = max(*p.shape, *q.shape)
    out: Poly = padded(p, size) - padded(q, size)
    return out


_A, _B = _poly({(1, 0): 1}), _poly({(0, 1): 1})
"""a and b."""
_A1, _B1 = _poly({(0, 0): 1, (1, 0): -1}), _poly({(0, 0): 1, (0, 1): -1})
"""1 − a and 1 − b."""
SUM = _poly({(0, 0): 1, (1, 1): -1})
"""S = 1 − ab: what the shares add up to."""
SHARES = (times(_A, _B1), times(_A1, _B1), times(_B, _A1))
"""m = (a(1 − b), (1 − a)(1 − b), b(1 − a)): durations are T·m/S."""
MONOMIALS = {
    (i, j): times(
        times(power(_A, 2 - i), power(_A1, i)),
        times(power(_B, 2 - j), power(_B1, j)),
    )
    for i in range(3)
    for j in range(3)
}
"""a²b²·xⁱyʲ by (i, j)."""


@lru_cache(maxsize=5_000)
def _bernstein(level: int, index: int, size: int) -> Poly:
    """Integer matrix from power to Bernstein coefficients on [index, index + 1]/2^level, scaled.

    ((index + t)/2^level)ʲ = Σ_k C(j, k) index^(j − k) t^k/2^(level·j), and t^k has the Bernstein
    coefficients C(i, k)/C(n, k); all times 2^(level·n) and the lcm of the C(n, k).
    """
    n = size - 1
    out = np.zeros((size, size), dtype=object)
    unit = math.lcm(*(math.comb(n, k) for k in range(size)))
    for j in range(size):
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
