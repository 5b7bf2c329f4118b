"""Proof of a lower bound for 3-5-3 or 4-3-4 polynomials, checked again: standard library only.

Why the proof holds is in docs/certificates.md; the symbols are the same here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, factorial, lcm, perm
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


@dataclass(frozen=True)
class Form:
    """One kind of curve.

    Attributes
    ----------
    degrees : list of int
    divisors : dict
        By kind of row at a place: its segment, and the coefficients of xⁱyʲ that the piece is
        multiplied by, none negative.
    cubic_ends : bool
        Whether the end pieces are d·s³; if not, only their being at rest is used.
    """

    degrees: list[int]
    divisors: dict[str, tuple[int, dict[tuple[int, int], int]]]
    cubic_ends: bool


FORMS = {
    "three-piece": Form([3, 5, 3], {"place": (1, {(0, 0): 1})}, True),
    "four-three-four": Form(
        [4, 3, 4],
        {
            "place": (1, {(0, 0): 1, (1, 0): 2, (0, 1): 2, (1, 1): 3}),
            "place-first": (0, {(1, 0): 1, (2, 0): 2, (1, 1): 2, (2, 1): 3}),
            "place-last": (2, {(0, 1): 1, (1, 1): 2, (0, 2): 2, (1, 2): 3}),
        },
        False,
    ),
}
"""By ``proof.kind``."""

Ratios = dict[tuple[int, int], list[Fraction]]
"""Coefficients in s of each xⁱyʲ."""
Curves = dict[str, list[Ratios]]
"""By kind of row and joint: a piece times its divisor."""


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "three-piece" or "four-three-four" again.

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
    form = FORMS[proof["kind"]]
    _declared(problem, form)
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
        timeless = all(
            row[5] >= 0 or (row[0] in form.divisors and row[2] == 0) for row in proof["rows"]
        )
        above = len(longest) == 3 and lower > sum(longest)
        need(timeless or above, "infeasible only above all upper bounds, or without the total")
    curves = _curves(problem, form)
    polys = [_row(problem, form, curves, row, total) for row in proof["rows"]]
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


def _declared(problem: Stated, form: Form) -> None:
    given = problem.declaration
    rest = {1: Fraction(0), 2: Fraction(0)}
    need(
        given is not None
        and given.degrees == form.degrees
        and given.continuity == [2, 2]
        and given.prescribed == [rest, {}, {}, rest]
        and not given.virtual,
        "declaration not covered: not the polynomials of this kind of proof, at rest at the ends",
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


def _curves(problem: Stated, form: Form) -> Curves:
    """Each piece times its divisor, as a polynomial of degree 2 in x and in y, for s in [0, 1].

    It is read off from exact splines on nine pairs of ratios, and checked on two more.
    """
    nodes = [Fraction(x) for x in (1, 2, 3)]
    grid = [(x, y) for x in nodes for y in nodes]
    further = [(Fraction(2), Fraction(5)), (Fraction(7, 2), Fraction(1, 3))]
    splines = {(x, y): pieces(problem, [1 / x, Fraction(1), 1 / y]) for x, y in grid + further}
    out: Curves = {}
    for kind, (segment, divisor) in form.divisors.items():
        out[kind] = []
        for joint in range(len(problem.limits)):
            values = {}
            for (x, y), spline in splines.items():
                h = (1 / x, Fraction(1), 1 / y)[segment]
                by = sum((c * x**i * y**j for (i, j), c in divisor.items()), Fraction(0))
                values[x, y] = [by * c * h**p for p, c in enumerate(spline[joint][segment])]
            rows = [_parabola([values[x, y] for y in nodes]) for x in nodes]
            found: Ratios = {}
            for j in range(3):
                for i, coefficients in enumerate(_parabola([row[j] for row in rows])):
                    found[i, j] = coefficients
            for x, y in further:
                expected = [Fraction(0)] * len(values[x, y])
                for (i, j), c in found.items():
                    expected = [e + x**i * y**j * v for e, v in zip(expected, c, strict=True)]
                need(values[x, y] == expected, "a piece is not of this form")
            out[kind].append(found)
    return out


def _parabola(nodes: list[list[Fraction]]) -> list[list[Fraction]]:
    """Coefficients of the parabolas with these values at 1, 2, 3: ascending."""
    out: list[list[Fraction]] = [[], [], []]
    for v1, v2, v3 in zip(*nodes, strict=True):
        c = (v3 - 2 * v2 + v1) / 2
        b = v2 - v1 - 3 * c
        for values, x in zip(out, (v1 - b - c, b, c), strict=True):
            values.append(x)
    return out


def _on_square(ratios: dict[tuple[int, int], Fraction]) -> Poly:
    """a²b²·Σ c·xⁱyʲ in a and b."""
    a: Poly = {(1, 0): Fraction(1)}
    a1: Poly = {(0, 0): Fraction(1), (1, 0): Fraction(-1)}
    b: Poly = {(0, 1): Fraction(1)}
    b1: Poly = {(0, 0): Fraction(1), (0, 1): Fraction(-1)}
    return _plus(
        *(
            (c, _times(*[a] * (2 - i), *[a1] * i, *[b] * (2 - j), *[b1] * j))
            for (i, j), c in ratios.items()
            if c
        )
    )


def _row(problem: Stated, form: Form, curves: Curves, row: Any, total: Fraction) -> Poly:
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
    whole(order, 0 if kind in form.divisors else 1, 3)
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
    if kind in form.divisors:
        s = Fraction(whole(place, 0, PLACES), PLACES)
        ratios = curves[kind][joint]
        left = _on_square({key: sign * at(derivative(c, order), s) for key, c in ratios.items()})
        segment, divisor = form.divisors[kind]
        below = _on_square({key: Fraction(c) for key, c in divisor.items()})
    else:
        segment = {"first": 0, "mean": 1, "last": 2}[kind]
        need(kind != "mean" or order == 1, "a mean speed has order 1")
        least = perm(3, order) if form.cubic_ends else factorial(order)
        way = abs(q[segment + 1] - q[segment]) * (1 if kind == "mean" else least)
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
