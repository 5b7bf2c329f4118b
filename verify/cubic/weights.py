"""The bound that weights of conditions and equations prove over a box of a C2 cubic spline."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import sqrt
from typing import Any

from ..ranges import MIX, MIX_DIGITS, MOST_INTEGER, MOST_WEIGHTS
from ..reading import need, required, weights, whole
from .box import Box
from .system import FINE, Condition, Cubic, Number, Sides, root_below

Spot = tuple[int, int, int]
"""Joint, coordinate and unknown of a product."""


def least(
    cubic: Cubic,
    box: Box,
    known: Sequence[Condition],
    target: dict[int, int],
    held: list[Any],
    equations: list[Any],
    shares: Callable[[list[Spot]], str],
) -> Number:
    """Least value of the target plus the weighted conditions and equations over the box.

    At feasible points that sum is at most the target.

    Parameters
    ----------
    target : dict
        Weights of the coordinates.
    held, equations : list
        [condition, w, …] and [equation, μ, …].
    shares : callable
        Given the products that occur, a character for each: its share of the bound that is exact
        where the unknown is lowest.

    Raises
    ------
    Refused
        If the weights are malformed, or an unknown has no bounds.
    """
    sides = box.sides(cubic)
    terms: dict[tuple[int, Any], Number] = {}
    along: dict[int, Number] = {k: target.get(k, 0) for k in range(cubic.coordinates)}
    constant: Number = 0
    inverse = dict.fromkeys(range(cubic.m), Fraction(0))
    for row, weight in weights(held, len(known), MOST_WEIGHTS):
        w = whole(weight, 0, MOST_INTEGER)
        joint, own, lengths, rest = known[row]
        for key, x in own.items():
            terms[joint, key] = terms.get((joint, key), 0) + w * x
        for k, x in lengths.items():
            along[k] += w * x
        constant += w * rest
    for row, weight in weights(equations, cubic.joints * cubic.size, MOST_WEIGHTS):
        w = whole(weight, -MOST_INTEGER, MOST_INTEGER)
        joint, i = divmod(row, cubic.size)
        for key, x in cubic.equations[i].items():
            terms[joint, key] = terms.get((joint, key), 0) + w * x
        if i in cubic.moved:
            t, sign = cubic.moved[i]
            inverse[t] -= w * sign * 6 * cubic.steps[t][joint]
    alone = {place: x for place, x in terms.items() if isinstance(place[1], int)}
    products = {(j, *key): x for (j, key), x in terms.items() if not isinstance(key, int) and x}
    mix = shares(sorted(products))
    need(len(mix) == len(products), "shares and products differ in number")
    need(set(mix) <= set(MIX_DIGITS), "malformed: a share of a product")
    for letter, (joint, k, v) in zip(mix, sorted(products), strict=True):
        x, share = products[joint, k, v], MIX_DIGITS.index(letter)
        ends = required(box.x[joint][v], "a product of an unknown without bounds")
        # y·u ≥ corner·u + edge·y − corner·edge where (y − corner)(u − edge) ≥ 0, and so on.
        for part, end, first in ((share, ends[0], True), (MIX - share, ends[1], False)):
            corner, edge = sides[k][0 if (x > 0) == first else 1], Fraction(end, FINE)
            factor = x * Fraction(part, MIX)
            alone[joint, v] = alone.get((joint, v), 0) + factor * corner
            along[k] += factor * edge
            constant -= factor * corner * edge
    for (joint, v), x in alone.items():
        if x:
            ends = required(box.x[joint][v], "an unknown without bounds")
            constant += Fraction(min(x * ends[0], x * ends[1])) / FINE
    return constant + _over(along, inverse, sides, cubic.rho)


def _over(
    along: dict[int, Number],
    inverse: dict[int, Fraction],
    sides: Sides,
    rho: Sequence[tuple[int, int, int]],
) -> Number:
    """Least value of Σ along·y + Σ inverse/T, with ρ = h²/T."""
    constant: Number = 0
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
        e = inverse.get(k)
        if e:
            need(low > 0, "1/T of a span that may vanish")
            if e > 0:
                # 1/T ≥ 2/τ − T/τ², the tangent at any τ.
                best = root_below(e / slope) if slope > 0 else high
                place = min(max(best, low), high)
                constant += 2 * e / place
                slope -= e / place**2
            else:
                constant += e * (1 / low + 1 / high)
                slope -= e / (low * high)
        constant += min(slope * low, slope * high)
    return constant


def _slope(
    factor: Number,
    first: Number,
    second: Number,
    inverse: Number,
    h: tuple[Fraction, Fraction],
    t: tuple[Fraction, Fraction],
) -> Fraction:
    """θ whose tangent of ρ gives about the best bound: floats only choose.

    It is h/T where first·h + second·T + inverse/T + factor·h²/T, which is convex once a negative
    inverse is replaced by its chord, is least: there both sides of the duality meet.
    """
    if not factor or t[0] <= 0:
        return Fraction(0)
    f, a, b, e = map(float, (factor, first, second, inverse))
    (h0, h1), (low, high) = map(float, h), map(float, t)
    if e < 0:
        b, e = b - e / (low * high), 0.0

    def best(span: float) -> float:
        return min(max(-a * span / (2 * f), h0), h1)

    def value(span: float) -> float:
        return a * best(span) + b * span + (e + f * best(span) ** 2) / span

    # Between the ends of T the sum is least where h is free, or at an end of h.
    quotients = [(e, b - a * a / (4 * f)), (e + f * h0 * h0, b), (e + f * h1 * h1, b)]
    turns = [sqrt(over / under) for over, under in quotients if under > 0]
    span = min((min(max(x, low), high) for x in (low, high, *turns)), key=value)
    return Fraction(best(span) / span)
