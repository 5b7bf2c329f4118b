"""The bound that weights of conditions and equations prove over a box of a C2 cubic spline."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, isqrt
from typing import Any

from ..ranges import MIX, MIX_DIGITS, MOST_INTEGER, MOST_WEIGHTS
from ..reading import listed, need, required, text, whole
from .box import FINE, Box
from .system import ZERO

_SLOPES = 128
"""Tangents of ρ that are tried: the best of them is as good as the bound needs."""

Condition = tuple[int, dict[Any, Fraction], dict[Any, Fraction], Fraction]
"""Joint, terms in the unknowns, terms in the coordinates, constant: their sum is ≤ 0."""


def least(
    box: Box, target: dict[int, int], weights: list[Any], known: Sequence[Condition]
) -> Fraction:
    """Least value of the target plus the weighted conditions and equations over the box.

    Parameters
    ----------
    box : Box
    target : dict
        Weights of the coordinates.
    weights : list
        Three entries: [condition, w, …], [equation, μ, …], and the shares of the products.
    known : sequence of Condition

    Returns
    -------
    Fraction

    Raises
    ------
    Refused
        If the weights are malformed, or an unknown has no bounds.
    """
    cubic, sides = box.cubic, box.sides()
    first, second, third = listed(weights, "weights", 3, 3)
    held = listed(first, "weights of conditions", 2 * MOST_WEIGHTS)
    equations = listed(second, "weights of equations", 2 * MOST_WEIGHTS)
    mix = text(third, "shares of products")
    terms: dict[tuple[int, Any], Fraction] = {}
    along = dict.fromkeys(range(len(sides)), ZERO)
    for k, factor in target.items():
        along[k] += factor
    constant, inverse = ZERO, dict.fromkeys(range(cubic.m), ZERO)
    need(len(held) % 2 == 0 and len(equations) % 2 == 0, "malformed: weights come in pairs")
    for number_, weight in zip(held[::2], held[1::2], strict=True):
        w = whole(weight, 0, MOST_INTEGER)
        joint, own, lengths, rest = known[whole(number_, 0, len(known) - 1)]
        for key, x in own.items():
            terms[joint, key] = terms.get((joint, key), ZERO) + w * x
        for k, x in lengths.items():
            along[k] += w * x
        constant += w * rest
    for number_, weight in zip(equations[::2], equations[1::2], strict=True):
        w = whole(weight, -MOST_INTEGER, MOST_INTEGER)
        joint, i = divmod(whole(number_, 0, cubic.joints * cubic.size - 1), cubic.size)
        for key, x in cubic.equations[i].items():
            terms[joint, key] = terms.get((joint, key), ZERO) + w * x
        if i in cubic.moved:
            t, sign = cubic.moved[i]
            inverse[t] -= w * sign * 6 * cubic.steps[t][joint]
    lines: dict[tuple[int, int], Fraction] = {}
    products = []
    for (joint, key), x in terms.items():
        if isinstance(key, int):
            lines[joint, key] = lines.get((joint, key), ZERO) + x
        elif x:
            products.append((joint, *key, x))
    products.sort()
    need(len(mix) == len(products), "shares and products differ in number")
    need(set(mix) <= set(MIX_DIGITS), "malformed: a share of a product")
    for letter, (joint, k, v, x) in zip(mix, products, strict=True):
        share = Fraction(MIX_DIGITS.index(letter), MIX)
        ends = required(box.x[joint][v], "a product of an unknown without bounds")
        # y·u ≥ corner·u + edge·y − corner·edge where (y − corner)(u − edge) ≥ 0, and so on.
        for part, edge, first in ((share, ends[0], True), (1 - share, ends[1], False)):
            corner = sides[k][0 if (x > 0) == first else 1]
            lines[joint, v] = lines.get((joint, v), ZERO) + x * part * corner
            along[k] += x * part * edge
            constant -= x * part * corner * edge
    for (joint, v), x in lines.items():
        if x:
            ends = required(box.x[joint][v], "an unknown without bounds")
            constant += min(x * ends[0], x * ends[1])
    return constant + _over(along, inverse, sides, cubic.rho())


def _over(
    along: dict[int, Fraction],
    inverse: dict[int, Fraction],
    sides: Sequence[tuple[Fraction, Fraction]],
    rho: Sequence[tuple[int, int, int]],
) -> Fraction:
    """Least value of Σ along·y + Σ inverse/T, with ρ = h²/T."""
    constant = ZERO
    for h, t, r in rho:
        factor = along.pop(r)
        (h0, h1), t0 = sides[h], sides[t][0]
        if factor >= 0:
            # h²/T ≥ 2θh − θ²T for every θ.
            theta = _slope(factor, along[h], along[t], inverse[t], sides[h], sides[t])
            along[h] += 2 * theta * factor
            along[t] -= theta**2 * factor
        elif t0 > 0:
            # h²/T ≤ h²/t0, below its chord.
            along[h] += factor * (h0 + h1) / t0
            constant -= factor * h0 * h1 / t0
        else:
            along[h] += factor
    for k, slope in along.items():
        low, high = sides[k]
        e = inverse.get(k, ZERO)
        if e:
            need(low > 0, "1/T of a span that may vanish")
            if e > 0:
                # 1/T ≥ 2/τ − T/τ², the tangent at any τ.
                best = _root(e / slope) if slope > 0 else high
                place = min(max(best, low), high)
                constant += 2 * e / place
                slope -= e / place**2
            else:
                constant += e * (1 / low + 1 / high)
                slope -= e / (low * high)
        constant += min(slope * low, slope * high)
    return constant


def _root(x: Fraction) -> Fraction:
    """About the square root."""
    return Fraction(isqrt(floor(x * FINE**2)), FINE)


def _slope(
    factor: Fraction,
    first: Fraction,
    second: Fraction,
    inverse: Fraction,
    h: tuple[Fraction, Fraction],
    t: tuple[Fraction, Fraction],
) -> Fraction:
    """θ whose tangent of ρ gives about the best bound: floats only choose."""
    if not factor or t[0] <= 0:
        return ZERO
    f, a, b, e = float(factor), float(first), float(second), float(inverse)
    (h0, h1), (t0, t1) = (float(h[0]), float(h[1])), (float(t[0]), float(t[1]))
    start, end = h0 / t1, min(1.0, h1 / t0)
    best, found = ZERO, -float("inf")
    for i in range(_SLOPES + 1):
        theta = start + (end - start) * i / _SLOPES
        x, y = a + 2 * theta * f, b - theta**2 * f
        middle = min(max((max(e, 0.0) / y) ** 0.5, t0), t1) if y > 0 else t1
        value = min(x * h0, x * h1) + min(y * s + e / s for s in (t0, t1, middle))
        if value > found:
            best, found = Fraction(theta), value
    return best
