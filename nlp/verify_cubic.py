"""Re-proof of lower bounds for C2 cubic splines, in rationals: no solver, standard library only.

Why the proof holds is in docs/certificates-cubic.md. A file gives weights; every bound that follows
from them is computed here anew, in exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import floor, isqrt
from typing import Any

from .verify_answer import check_answer, read_answer
from .verify_cubic_box import FINE, Box, Range
from .verify_cubic_system import MOST, TICKS, ZERO, Cubic
from .verify_problem import Proved, need, number, whole

MIX = 32
ALPHABET = "0123456789abcdefghijklmnopqrstuvw"
_SLOPES = 128


def least(box: Box, target: dict[int, int], step: Sequence[Any], known: Sequence[Any]) -> Fraction:
    """Least value of the target plus the weighted conditions and equations over the box."""
    cubic, sides = box.cubic, box.sides()
    held, equations, mix = step
    terms: dict[tuple[int, Any], Fraction] = {}
    along = dict.fromkeys(range(len(sides)), ZERO)
    for k, factor in target.items():
        along[k] += factor
    constant, inverse = ZERO, dict.fromkeys(range(cubic.m), ZERO)
    need(len(held) % 2 == 0 and len(equations) % 2 == 0, "weights come in pairs")
    for number_, weight in zip(held[::2], held[1::2], strict=True):
        w = whole(weight, 0, MOST)
        joint, own, lengths, rest = known[whole(number_, 0, len(known) - 1)]
        for key, x in own.items():
            terms[joint, key] = terms.get((joint, key), ZERO) + w * x
        for k, x in lengths.items():
            along[k] += w * x
        constant += w * rest
    for number_, weight in zip(equations[::2], equations[1::2], strict=True):
        w = whole(weight, -MOST, MOST)
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
    for letter, (joint, k, v, x) in zip(mix, products, strict=True):
        share = Fraction(ALPHABET.index(letter), MIX)
        ends = box.x[joint][v]
        need(ends is not None, "a product of an unknown without bounds")
        assert ends is not None
        # y·u ≥ corner·u + edge·y − corner·edge where (y − corner)(u − edge) ≥ 0, and so on.
        for part, edge, first in ((share, ends[0], True), (1 - share, ends[1], False)):
            corner = sides[k][0 if (x > 0) == first else 1]
            lines[joint, v] = lines.get((joint, v), ZERO) + x * part * corner
            along[k] += x * part * edge
            constant -= x * part * corner * edge
    for (joint, v), x in lines.items():
        ends = box.x[joint][v]
        need(ends is not None or not x, "an unknown without bounds")
        constant += min(x * ends[0], x * ends[1]) if ends is not None else ZERO
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


def _walk(cubic: Cubic, proof: dict[str, Any]) -> int:
    """Carry out the steps; the least floor, in ticks, of all boxes left open, or the cap."""
    known = [cubic.condition(entry) for entry in proof["rows"]]
    nothing: list[list[Range]] = [[None] * cubic.size for _ in range(cubic.joints)]
    stack = [(Box(cubic, *cubic.root(proof["root"]), nothing, 0), proof["tree"])]
    least = int(cubic.cap * TICKS)
    while stack:
        box, steps = stack.pop()
        need(isinstance(steps, list), "the tree is no list of steps")
        split = False
        for step in steps:
            need(not split, "a step after a split")
            if box.empty:
                break
            if step[0] == "s":
                split = True
                k, at = whole(step[1], 0, cubic.free - 1), whole(step[2], 0, MOST)
                _, _, _, lower, upper = step
                for side, rest in ((box.high, lower), (box.low, upper)):
                    ends = (list(box.low), list(box.high))
                    ends[side is box.high][k] = (min if side is box.high else max)(at, side[k])
                    stack.append((Box(cubic, *ends, [list(x) for x in box.x], box.floor), rest))
            else:
                _carry_out(box, step, known)
        if not (box.empty or split):
            least = min(least, box.floor)
    return least


def _carry_out(box: Box, step: Sequence[Any], known: Sequence[Any]) -> None:
    """One step on one box, if it is proved."""
    cubic, kind = box.cubic, step[0]
    if kind == "r":
        box.meet()
    elif kind == "e":
        need(least(box, {}, step[1:], known) > 0, "a box is not proved to be empty")
        box.empty = True
    elif kind == "f":
        value, scale = whole(step[1], 0, MOST), whole(step[2], 1, MOST)
        total = dict.fromkeys(range(cubic.m), scale)
        proved = least(box, total, step[3:], known) * TICKS >= value * scale
        need(proved, "a floor is not proved")
        box.floor = max(box.floor, value)
        box.trim()
    else:
        need(kind == "t", "an unknown step")
        k, sign = whole(step[1], 0, cubic.free - 1), whole(step[2], -1, 1)
        value, scale = whole(step[3], -MOST, MOST), whole(step[4], 1, MOST)
        need(sign != 0, "neither a lower nor an upper side")
        proved = least(box, {k: sign * scale}, step[5:], known) * TICKS >= sign * value * scale
        need(proved, "a side is not proved")
        if sign > 0:
            box.low[k] = max(box.low[k], value)
        else:
            box.high[k] = min(box.high[k], value)
        box.trim()


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "cubic" again.

    Parameters
    ----------
    document : dict
        The whole certificate.

    Returns
    -------
    Proved

    Raises
    ------
    Refused
        With the step that is not proved.
    """
    cubic, claim, proof = Cubic(document), document["claim"], document["proof"]
    lower, answer = number(claim["lower"]), read_answer(claim)
    if answer is not None:
        check_answer(cubic.problem, answer[0])
        need(not claim["infeasible"], "infeasible, with durations that keep the limits")
    total = Fraction(whole(proof["total"], 0, MOST), TICKS) * cubic.second
    need(lower <= total, "the lower bound exceeds the total that is proved")
    need(_walk(cubic, proof) >= proof["total"], "a box left open has a lower floor")
    if claim["infeasible"]:
        longest = [x for x in cubic.problem.longest if x is not None]
        above = len(longest) == cubic.n and lower > sum(longest)
        need(above, "infeasible only above the sum of all upper bounds")
        return Proved(lower, None, True)
    return Proved(lower, None if answer is None else answer[1])
