"""Proof of a lower bound for 3-5-3 polynomials, checked again: standard library only.

Why the proof holds is in docs/certificates.md; the symbols are the same here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import comb, lcm, perm
from operator import mul
from typing import Any

from .verify_answer import at, check_answer, derivative, pieces, read_answer
from .verify_problem import Proved, Refused, Stated, need, number, read_problem, whole

STRICT = Fraction(1, 2**40)
PLACES = 2**20
_FINEST = 2**256
SIZE = 6
"""Coefficients per variable: no row has a higher degree, and raising it only tightens the test."""
BINOMIALS = lcm(*(comb(SIZE - 1, p) for p in range(SIZE)))

Poly = dict[tuple[int, int], Fraction]

ONE: Poly = {(0, 0): Fraction(1)}
M: tuple[Poly, ...] = (  # shares of the total, times S
    {(1, 0): Fraction(1), (1, 1): Fraction(-1)},
    {(0, 0): Fraction(1), (1, 0): Fraction(-1), (0, 1): Fraction(-1), (1, 1): Fraction(1)},
    {(0, 1): Fraction(1), (1, 1): Fraction(-1)},
)
S: Poly = {(0, 0): Fraction(1), (1, 1): Fraction(-1)}


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "three-piece" again.

    Parameters
    ----------
    document : dict

    Returns
    -------
    Proved

    Raises
    ------
    Refused
        If it does not prove its claim.
    """
    problem, claim, proof = read_problem(document["problem"]), document["claim"], document["proof"]
    _declared(problem)
    total, lower = number(proof["total"]), number(claim["lower"])
    need(total > 0, "the total is not positive")
    need(lower <= total, "the lower bound exceeds the total that is proved")
    answer, upper = read_answer(claim), None
    if answer is not None:
        upper = answer[1]
        check_answer(problem, answer[0])
    infeasible = claim["infeasible"] is True
    if infeasible:
        need(answer is None, "infeasible, but with an answer")
        longest = [x for x in problem.longest if x is not None]
        timeless = all(row[5] >= 0 or (row[0] == "place" and row[2] == 0) for row in proof["rows"])
        above = len(longest) == 3 and lower > sum(longest)
        need(timeless or above, "infeasible only above all upper bounds, or without the total")
    quintics = [_quintic(problem, j) for j in range(len(problem.limits))]
    polys = [_row(problem, quintics, row, total) for row in proof["rows"]]
    boxes = _leaves(proof["tree"])
    need(len(boxes) == len(proof["leaves"]), "leaves and tree differ in number")
    for count, (box, leaf) in enumerate(zip(boxes, proof["leaves"], strict=True)):
        which = [whole(k, 0, len(polys) - 1) for k in leaf[::2]]
        weights = [number(x) for x in leaf[1::2]]
        need(len(which) == len(weights) > 0, f"leaf {count}: no weights")
        need(min(weights) >= 0 and any(weights), f"leaf {count}: weights")
        mixed = _plus(*((w, polys[k]) for k, w in zip(which, weights, strict=True)))
        need(_covers(mixed, box), f"leaf {count} is not proved")
    return Proved(lower, upper, infeasible)


def _declared(problem: Stated) -> None:
    given = problem.declaration
    rest = {1: Fraction(0), 2: Fraction(0)}
    need(
        given is not None
        and given.degrees == [3, 5, 3]
        and given.continuity == [2, 2]
        and given.prescribed == [rest, {}, {}, rest]
        and not given.virtual,
        "declaration not covered: no 3-5-3 polynomial at rest at the ends",
    )


def _times(*factors: Poly) -> Poly:
    out = ONE
    for p in factors:
        product: Poly = {}
        for (i, j), x in out.items():
            for (k, m), y in p.items():
                product[i + k, j + m] = product.get((i + k, j + m), Fraction(0)) + x * y
        out = product
    return out


def _plus(*terms: tuple[Fraction, Poly]) -> Poly:
    out: Poly = {}
    for factor, p in terms:
        for key, x in p.items():
            out[key] = out.get(key, Fraction(0)) + factor * x
    return out


def _quintic(problem: Stated, joint: int) -> list[list[Fraction]]:
    """The quintic's coefficients for h₂ = 1 as α + β₁x + γ₁x² + β₂y + γ₂y²: five lists."""
    alone = replace(
        problem,
        waypoints=[[row[joint]] for row in problem.waypoints],
        limits=problem.limits[joint : joint + 1],
    )
    f = {
        (x, y): pieces(alone, [Fraction(1, x), Fraction(1), Fraction(1, y)])[0][1]
        for x, y in ((1, 1), (2, 1), (3, 1), (1, 2), (1, 3), (2, 3))
    }
    out: list[list[Fraction]] = [[] for _ in range(5)]
    for p in range(6):
        v = {key: c[p] for key, c in f.items()}
        g1 = (v[3, 1] - 2 * v[2, 1] + v[1, 1]) / 2
        g2 = (v[1, 3] - 2 * v[1, 2] + v[1, 1]) / 2
        b1, b2 = v[2, 1] - v[1, 1] - 3 * g1, v[1, 2] - v[1, 1] - 3 * g2
        a = v[1, 1] - b1 - g1 - b2 - g2
        need(v[2, 3] == a + 2 * b1 + 4 * g1 + 3 * b2 + 9 * g2, "the quintic is not of this form")
        for values, x in zip(out, (a, b1, g1, b2, g2), strict=True):
            values.append(x)
    return out


def _row(problem: Stated, quintics: list[list[list[Fraction]]], row: Any, total: Fraction) -> Poly:
    """Polynomial in a, b that is < 0 wherever a trajectory shorter than ``total`` is feasible."""
    kind, (joint, order, sign, place, cap) = row[0], row[1:]
    whole(cap, -1, 2)
    longest = total if cap < 0 else problem.longest[cap]
    need(longest is not None, "a row leans on an upper bound that is not there")
    assert longest is not None
    c = longest if cap < 0 else longest * (1 + STRICT)
    hold = S if cap < 0 else M[cap]  # every duration is below c·M[g]/hold
    if kind == "lower":
        k = whole(joint, 0, 2)
        return _plus((problem.shortest[k] / c, hold), (Fraction(-1), M[k]))
    whole(joint, 0, len(problem.limits) - 1)
    whole(order, 0 if kind == "place" else 1, 3)
    need(type(sign) is int and sign in (1, -1), "sign")
    q = [w[joint] for w in problem.waypoints]
    if order == 0:
        end = problem.position[(1 + sign) // 2][joint]
        need(end is not None, "a row leans on a position limit that is not there")
        assert end is not None
        limit = max(sign * x for x in end) + STRICT
    else:
        bound = problem.limits[joint][order - 1]
        need(bound is not None and bound[1] > 0, "a row leans on a limit that is not there")
        assert bound is not None
        limit = bound[1]
    if kind == "place":
        s = Fraction(whole(place, 0, PLACES), PLACES)
        values = [at(derivative(part, order), s) for part in quintics[joint]]
        a: Poly = {(1, 0): Fraction(1)}
        a1 = {(0, 0): Fraction(1), (1, 0): Fraction(-1)}
        b: Poly = {(0, 1): Fraction(1)}
        b1 = {(0, 0): Fraction(1), (0, 1): Fraction(-1)}
        shapes = ((a, a, b, b), (a, a1, b, b), (a1, a1, b, b), (a, a, b, b1), (a, a, b1, b1))
        left = _plus(*((sign * v, _times(*f)) for v, f in zip(values, shapes, strict=True)))
        below, segment = _times(a, a, b, b), 1
    else:
        segment = {"first": 0, "mean": 1, "last": 2}[kind]
        need(kind != "mean" or order == 1, "a mean speed has order 1")
        way = abs(q[segment + 1] - q[segment]) * (1 if kind == "mean" else perm(3, order))
        left, below = {(0, 0): way}, ONE
    if order == 0:
        return _plus((Fraction(1), left), (-limit, below))
    left = _times(left, *([hold] * order))
    right = _times(below, *([M[segment]] * order))
    return _plus((1 / (limit * c**order), left), (Fraction(-1), right))


def _covers(poly: Poly, box: Sequence[Fraction]) -> bool:
    """Whether all Bernstein coefficients on a box (a low, a high, b low, b high) are ≥ 0."""
    need(all(max(key) < SIZE for key in poly), "a row has too high a degree")
    unit = lcm(*(x.denominator for x in poly.values()))
    table = [[int(poly.get((i, j), 0) * unit) for j in range(SIZE)] for i in range(SIZE)]
    for low, high in (box[2:], box[:2]):
        blossom = _blossom(low, high)
        table = [[sum(map(mul, line, row)) for row in blossom] for line in table]
        table = [list(line) for line in zip(*table, strict=True)]
    return all(x >= 0 for line in table for x in line)


def _blossom(low: Fraction, high: Fraction) -> list[list[int]]:
    """Weights of the powers in each Bernstein coefficient, times a positive number.

    Coefficient i is the blossom of the polynomial at i arguments ``high``, the others ``low``.
    """
    n, scale = SIZE - 1, lcm(low.denominator, high.denominator)
    first, last = int(low * scale), int(high * scale)
    out = []
    for i in range(n + 1):
        # Elementary symmetric sums of the arguments, by the product of (1 + argument·z).
        sums = [1] + [0] * n
        for argument in [last] * i + [first] * (n - i):
            for p in range(n, 0, -1):
                sums[p] += argument * sums[p - 1]
        units = (scale ** (n - p) * BINOMIALS // comb(n, p) for p in range(n + 1))
        out.append([e * unit for e, unit in zip(sums, units, strict=True)])
    return out


def _leaves(tree: str) -> list[tuple[Fraction, ...]]:
    """Boxes of a bisection tree in preorder: a, b halve a side, "." is a leaf."""
    stack = [(Fraction(0), Fraction(1), Fraction(0), Fraction(1))]
    found: list[tuple[Fraction, ...]] = []
    for letter in tree:
        need(bool(stack), "the tree has too many letters")
        a0, a1, b0, b1 = stack.pop()
        # Each halving adds a digit: a file of some megabytes would ask for all of the memory.
        need(max(x.denominator for x in (a0, a1, b0, b1)) < _FINEST, "the tree is too deep")
        if letter == ".":
            found.append((a0, a1, b0, b1))
        elif letter == "a":
            half = (a0 + a1) / 2
            stack += [(half, a1, b0, b1), (a0, half, b0, b1)]
        elif letter == "b":
            half = (b0 + b1) / 2
            stack += [(a0, a1, half, b1), (a0, a1, b0, half)]
        else:
            raise Refused(f"the tree has an unknown letter {letter!r}")
    need(not stack, "the tree leaves a part of the square open")
    return found
