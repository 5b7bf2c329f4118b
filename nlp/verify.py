"""Re-proof of a certificate, apart from the solver: only the standard library, exact rationals.

Why the proof holds is in docs/certificates.md; the symbols are the same here.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import comb, perm
from pathlib import Path
from typing import Any

FORMAT = "trajgap-certificate-1"
PI = (Fraction(314159265358979, 10**14), Fraction(314159265358980, 10**14))
STRICT = Fraction(1, 2**40)
PLACES = 2**20
_NUMBER = re.compile(r"-?\d{1,400}(/[1-9]\d{0,400}|\.\d{1,400})?(e-?\d{1,2})?")
_LARGEST = 200_000_000

Poly = dict[tuple[int, int], Fraction]


class Refused(ValueError):
    """The file does not prove what it claims; the message says where."""


@dataclass(frozen=True)
class Verdict:
    """What a certificate is worth.

    Attributes
    ----------
    proves : bool
        Whether its claim about the problem that it states is proved.
    altered : bool
        Whether it, or the problem in it, differs from what was written.
    reason : str
    lower, upper : Fraction or None
        The optimum lies between; ``upper`` is None where no durations are feasible.
    """

    proves: bool
    altered: bool
    reason: str
    lower: Fraction | None = None
    upper: Fraction | None = None

    def __str__(self) -> str:
        if not self.proves:
            return f"refused: {self.reason}"
        return ("altered, still proves: " if self.altered else "proves: ") + self.reason


def seal(part: Any) -> str:
    """SHA-256 of the canonical JSON of a document or a part of it."""
    text = json.dumps(part, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def verify(source: str | Path | dict[str, Any]) -> Verdict:
    """Prove a certificate again.

    Parameters
    ----------
    source : str, Path or dict
        File, or its parsed JSON.

    Returns
    -------
    Verdict
    """
    altered = False
    try:
        if not isinstance(source, dict):
            if Path(source).stat().st_size > _LARGEST:
                raise Refused("the file is too large")
            source = json.loads(Path(source).read_text("utf-8"))
        _need(isinstance(source, dict), "the file is not a JSON object")
        assert isinstance(source, dict)
        rest = {key: value for key, value in source.items() if key != "seal"}
        altered = seal(rest) != source.get("seal")
        altered |= seal(source.get("problem")) != source.get("problem_hash")
        lower, upper = _prove(source)
    except Refused as error:
        return Verdict(False, altered, str(error))
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        return Verdict(False, altered, f"malformed: {type(error).__name__}: {error}")
    except (OSError, RecursionError, ZeroDivisionError, OverflowError) as error:
        return Verdict(False, altered, f"unreadable: {error}")
    shown = f"the least total is at least {float(lower):.12g} s"
    shown += f" and at most {float(upper):.12g} s" if upper is not None else ": infeasible"
    return Verdict(True, altered, shown, lower, upper)


def _need(condition: bool, reason: str) -> None:
    if not condition:
        raise Refused(reason)


def _number(text: Any) -> Fraction:
    _need(isinstance(text, str) and _NUMBER.fullmatch(text) is not None, f"no number: {text!r}")
    mantissa, _, exponent = text.partition("e")
    return Fraction(mantissa) * Fraction(10) ** int(exponent or 0)


def _whole(value: Any, low: int, high: int) -> int:
    _need(type(value) is int and low <= value <= high, f"no integer in {low}..{high}: {value!r}")
    return int(value)


def _bounds(entry: Any) -> tuple[Fraction, Fraction] | None:
    """Rational bounds of a number, which may carry a factor π or 1/π; None where there is none."""
    if entry is None:
        return None
    if isinstance(entry, str):
        return _number(entry), _number(entry)
    value, power = _number(entry["value"]), _whole(entry["pi"], -1, 1)
    ends = [value * p if power > 0 else value / p if power < 0 else value for p in PI]
    return min(ends), max(ends)


@dataclass(frozen=True)
class _Problem:
    waypoints: list[list[Fraction]]
    limits: list[list[tuple[Fraction, Fraction] | None]]
    position: list[list[tuple[Fraction, Fraction] | None]]
    shortest: list[Fraction]
    longest: list[Fraction | None]
    degree: int | None  # of every rest-to-rest segment; None: 3-5-3


def _read(data: dict[str, Any]) -> _Problem:
    degrees, n = [_whole(d, 1, 9) for d in data["degrees"]], len(data["degrees"])
    rest = [[r, "0"] for r in range(1, (degrees[0] + 1) // 2)]
    declared = (data["continuity"], data["prescribed"], data["virtual"])
    if degrees == [3, 5, 3] and declared[0] == [2, 2]:
        rest = [[1, "0"], [2, "0"]]
        _need(declared == ([2, 2], [rest, [], [], rest], []), "3-5-3, but not at rest at the ends")
        degree = None
    else:
        _need(declared == ([0] * (n - 1), [rest] * (n + 1), []), "declaration not covered")
        _need(degrees == [2 * len(rest) + 1] * n and rest != [], "declaration not covered")
        degree = degrees[0]
    joints = len(data["joints"])
    q = [[_number(x) for x in row] for row in data["waypoints"]]
    _need(len(q) == n + 1 and joints > 0 and all(len(r) == joints for r in q), "way-points: shape")
    limits = [[_bounds(x) for x in row] for row in data["limits"]]
    _need(len(limits) == joints and all(len(r) == 3 for r in limits), "limits: shape")
    _need(all(x is None or x[0] >= 0 for r in limits for x in r), "limits: negative")
    position = [[_bounds(x) for x in data[key]] for key in ("position_lower", "position_upper")]
    _need(all(len(side) == joints for side in position), "position limits: shape")
    shortest = [_number(x) for x in data["duration_lower"]]
    longest = [None if x is None else _number(x) for x in data["duration_upper"]]
    _need(len(shortest) == len(longest) == n and min(shortest) >= 0, "duration bounds")
    _need(all(x is None or x > 0 for x in longest), "duration bounds")
    return _Problem(q, limits, position, shortest, longest, degree)


def _spline(q: Sequence[Fraction], h: Sequence[Fraction]) -> list[list[Fraction]]:
    """Coefficients of each piece in t − t_k, from the 14 conditions by Gauss elimination."""
    start = (0, 4, 10)
    rows: list[list[Fraction]] = []

    def line(terms: list[tuple[int, Fraction, int, int]], value: Fraction) -> None:
        row = [Fraction(0)] * 14 + [value]
        for piece, t, order, sign in terms:
            for p in range(order, 6 if piece == 1 else 4):
                row[start[piece] + p] += sign * perm(p, order) * t ** (p - order)
        rows.append(row)

    zero = Fraction(0)
    for k in range(3):
        line([(k, zero, 0, 1)], q[k])
        line([(k, h[k], 0, 1)], q[k + 1])
    for order in (1, 2):
        line([(0, zero, order, 1)], zero)
        line([(2, h[2], order, 1)], zero)
        for k in (0, 1):
            line([(k, h[k], order, 1), (k + 1, zero, order, -1)], zero)
    for k in range(14):
        pivot = next(i for i in range(k, 14) if rows[i][k] != 0)
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in range(14):
            if i != k and rows[i][k] != 0:
                factor = rows[i][k]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
    values = [row[14] for row in rows]
    return [values[0:4], values[4:10], values[10:14]]


def _from_rest(degree: int) -> list[Fraction]:
    """From 0 to 1 with half of the derivatives 0 at both ends: the integral of (s(1 − s))ᵐ."""
    m = degree // 2
    inside = [Fraction(0)] * m + [Fraction((-1) ** k * comb(m, k)) for k in range(m + 1)]
    total = sum(c / (p + 1) for p, c in enumerate(inside))
    return [Fraction(0)] + [c / (p + 1) / total for p, c in enumerate(inside)]


def _pieces(
    problem: _Problem, q: Sequence[Fraction], h: Sequence[Fraction]
) -> list[list[Fraction]]:
    if problem.degree is None:
        return _spline(q, h)
    form = _from_rest(problem.degree)
    pieces = []
    for k, x in enumerate(h):
        piece = [(q[k + 1] - q[k]) * c / x**p for p, c in enumerate(form)]
        pieces.append([piece[0] + q[k], *piece[1:]])
    return pieces


def _derivative(poly: Sequence[Fraction], order: int) -> list[Fraction]:
    return [perm(p, order) * c for p, c in enumerate(poly)][order:] or [Fraction(0)]


def _nonnegative(poly: Sequence[Fraction], low: Fraction, high: Fraction, depth: int = 60) -> bool:
    """Whether a polynomial is ≥ 0 on [low, high]: Bernstein coefficients, by bisection."""
    n = len(poly) - 1
    taylor = [
        sum(comb(p, k) * poly[p] * low ** (p - k) for p in range(k, n + 1)) * (high - low) ** k
        for k in range(n + 1)
    ]
    control = [
        sum(Fraction(comb(i, k), comb(n, k)) * taylor[k] for k in range(i + 1))
        for i in range(n + 1)
    ]
    if min(control) >= 0:
        return True
    if depth == 0 or control[0] < 0 or control[-1] < 0:
        return False
    middle = (low + high) / 2
    return _nonnegative(poly, low, middle, depth - 1) and _nonnegative(
        poly, middle, high, depth - 1
    )


def _check_answer(problem: _Problem, h: Sequence[Fraction]) -> None:
    for k, x in enumerate(h):
        top = problem.longest[k]
        inside = x > 0 and x >= problem.shortest[k] and (top is None or x <= top)
        _need(inside, f"answer: duration {k + 1} is outside its bounds")
    for j, limits in enumerate(problem.limits):
        pieces = _pieces(problem, [row[j] for row in problem.waypoints], h)
        bends = [_derivative(piece, 2) for piece in pieces]
        for k in range(len(h) - 1):
            end = sum(c * h[k] ** p for p, c in enumerate(bends[k]))
            _need(limits[2] is None or end == bends[k + 1][0], "answer: the acceleration jumps")
        for k, piece in enumerate(pieces):
            bounds = [(r, s, x[0]) for r, x in enumerate(limits, 1) if x for s in (1, -1)]
            low, high = problem.position[0][j], problem.position[1][j]
            bounds += [(0, 1, high[0])] if high else []
            bounds += [(0, -1, -low[1])] if low else []
            for order, sign, bound in bounds:
                rest = [-sign * c for c in _derivative(piece, order)]
                rest[0] += bound
                _need(
                    _nonnegative(rest, Fraction(0), h[k]),
                    f"answer: joint {j + 1}, segment {k + 1}, derivative {order} exceeds its limit",
                )


# --- the lower bound ------------------------------------------------------------------------------

ONE: Poly = {(0, 0): Fraction(1)}
M: tuple[Poly, ...] = (  # shares of the total, times S
    {(1, 0): Fraction(1), (1, 1): Fraction(-1)},
    {(0, 0): Fraction(1), (1, 0): Fraction(-1), (0, 1): Fraction(-1), (1, 1): Fraction(1)},
    {(0, 1): Fraction(1), (1, 1): Fraction(-1)},
)
S: Poly = {(0, 0): Fraction(1), (1, 1): Fraction(-1)}
A_OVER, B_OVER = M[1], {(0, 1): Fraction(1)}


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


def _quintic(q: Sequence[Fraction]) -> list[list[Fraction]]:
    """The quintic's coefficients for h₂ = 1 as α + β₁x + γ₁x² + β₂y + γ₂y²: five lists."""
    f = {
        (x, y): _spline(q, [Fraction(1, x), Fraction(1), Fraction(1, y)])[1]
        for x, y in ((1, 1), (2, 1), (3, 1), (1, 2), (1, 3), (2, 3))
    }
    out: list[list[Fraction]] = [[] for _ in range(5)]
    for p in range(6):
        v = {key: c[p] for key, c in f.items()}
        g1 = (v[3, 1] - 2 * v[2, 1] + v[1, 1]) / 2
        g2 = (v[1, 3] - 2 * v[1, 2] + v[1, 1]) / 2
        b1, b2 = v[2, 1] - v[1, 1] - 3 * g1, v[1, 2] - v[1, 1] - 3 * g2
        a = v[1, 1] - b1 - g1 - b2 - g2
        _need(v[2, 3] == a + 2 * b1 + 4 * g1 + 3 * b2 + 9 * g2, "the quintic is not of this form")
        for values, x in zip(out, (a, b1, g1, b2, g2), strict=True):
            values.append(x)
    return out


def _row(
    problem: _Problem, quintics: list[list[list[Fraction]]], row: Any, total: Fraction
) -> Poly:
    """Polynomial in a, b that is < 0 wherever a trajectory shorter than ``total`` is feasible."""
    kind, (joint, order, sign, place, cap) = row[0], row[1:]
    _whole(cap, -1, 2)
    longest = total if cap < 0 else problem.longest[cap]
    _need(longest is not None, "a row leans on an upper bound that is not there")
    assert longest is not None
    c = longest if cap < 0 else longest * (1 + STRICT)
    hold = S if cap < 0 else M[cap]  # every duration is below c·M[g]/hold
    if kind == "lower":
        k = _whole(joint, 0, 2)
        return _plus((problem.shortest[k] / c, hold), (Fraction(-1), M[k]))
    _whole(joint, 0, len(problem.limits) - 1)
    _whole(order, 0 if kind == "place" else 1, 3)
    _need(sign in (1, -1), "sign")
    q = [w[joint] for w in problem.waypoints]
    if order == 0:
        end = problem.position[(1 + sign) // 2][joint]
        _need(end is not None, "a row leans on a position limit that is not there")
        assert end is not None
        limit = max(sign * x for x in end) + STRICT
    else:
        bound = problem.limits[joint][order - 1]
        _need(bound is not None and bound[1] > 0, "a row leans on a limit that is not there")
        assert bound is not None
        limit = bound[1]
    if kind == "place":
        s = Fraction(_whole(place, 0, PLACES), PLACES)
        values = [
            sum(x * s**p for p, x in enumerate(_derivative(part, order)))
            for part in quintics[joint]
        ]
        a: Poly = {(1, 0): Fraction(1)}
        a1 = {(0, 0): Fraction(1), (1, 0): Fraction(-1)}
        b: Poly = {(0, 1): Fraction(1)}
        b1 = {(0, 0): Fraction(1), (0, 1): Fraction(-1)}
        shapes = ((a, a, b, b), (a, a1, b, b), (a1, a1, b, b), (a, a, b, b1), (a, a, b1, b1))
        left = _plus(*((sign * v, _times(*f)) for v, f in zip(values, shapes, strict=True)))
        below, segment = _times(a, a, b, b), 1
    else:
        segment = {"first": 0, "mean": 1, "last": 2}[kind]
        _need(kind != "mean" or order == 1, "a mean speed has order 1")
        way = abs(q[segment + 1] - q[segment]) * (1 if kind == "mean" else perm(3, order))
        left, below = {(0, 0): way}, ONE
    if order == 0:
        return _plus((Fraction(1), left), (-limit, below))
    left = _times(left, *([hold] * order))
    right = _times(below, *([M[segment]] * order))
    return _plus((1 / (limit * c**order), left), (Fraction(-1), right))


def _covers(poly: Poly, box: tuple[Fraction, ...]) -> bool:
    """Whether all Bernstein coefficients on a box (a low, a high, b low, b high) are ≥ 0."""
    size = 6  # no row has a higher degree, and raising the degree only tightens the coefficients
    _need(all(max(key) < size for key in poly), "a row has too high a degree")
    table = [[poly.get((i, j), Fraction(0)) for j in range(size)] for i in range(size)]
    for low, high in (box[2:], box[:2]):
        table = [_control(line, low, high) for line in table]
        table = [list(line) for line in zip(*table, strict=True)]
    return all(x >= 0 for line in table for x in line)


def _control(line: list[Fraction], low: Fraction, high: Fraction) -> list[Fraction]:
    """Bernstein coefficients as blossoms: i arguments ``high``, the others ``low``."""
    n = len(line) - 1
    out = []
    for i in range(n + 1):
        # Elementary symmetric means of the arguments, by the product of (1 + argument·z).
        sums = [Fraction(1)] + [Fraction(0)] * n
        for argument in [high] * i + [low] * (n - i):
            for p in range(n, 0, -1):
                sums[p] += argument * sums[p - 1]
        terms = (c * e / comb(n, p) for p, (c, e) in enumerate(zip(line, sums, strict=True)))
        out.append(sum(terms, Fraction(0)))
    return out


def _leaves(tree: str) -> list[tuple[Fraction, ...]]:
    """Boxes of a bisection tree in preorder: a, b halve a side, "." is a leaf."""
    stack = [(Fraction(0), Fraction(1), Fraction(0), Fraction(1))]
    found: list[tuple[Fraction, ...]] = []
    for letter in tree:
        _need(bool(stack), "the tree has too many letters")
        a0, a1, b0, b1 = stack.pop()
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
    _need(not stack, "the tree leaves a part of the square open")
    return found


def _least(problem: _Problem, degree: int, bounds: Any) -> list[Fraction]:
    """Least duration of every rest-to-rest segment: limit·hʳ ≥ |Δq|·|derivative at a place|."""
    _need(len(bounds) == len(problem.longest), "one bound per segment")
    out = []
    for k, (joint, order, place, text) in enumerate(bounds):
        x = _number(text)
        if joint == -1:
            _need(x <= problem.shortest[k], f"segment {k + 1}: above its lower bound")
        else:
            _whole(joint, 0, len(problem.limits) - 1)
            bound = problem.limits[joint][_whole(order, 1, 3) - 1]
            _need(bound is not None and bound[1] > 0, "a limit that is not there")
            assert bound is not None
            s = Fraction(_whole(place, 0, PLACES), PLACES)
            shape = _derivative(_from_rest(degree), order)
            peak = abs(sum(c * s**p for p, c in enumerate(shape)))
            way = abs(problem.waypoints[k + 1][joint] - problem.waypoints[k][joint])
            proved = x >= 0 and bound[1] * x**order <= way * peak
            _need(proved, f"segment {k + 1}: its least duration is not proved")
        out.append(x)
    return out


def _prove(document: dict[str, Any]) -> tuple[Fraction, Fraction | None]:
    _need(document["format"] == FORMAT, "unknown format")
    problem, claim, proof = _read(document["problem"]), document["claim"], document["proof"]
    least = None if problem.degree is None else _least(problem, problem.degree, proof["segments"])
    total = _number(proof["total"]) if least is None else sum(least, Fraction(0))
    lower = _number(claim["lower"])
    _need(total >= 0 and lower <= total, "the lower bound exceeds the total that is proved")
    upper = None
    if claim["durations"] is None:
        _need(claim["upper"] is None, "an upper bound without durations")
        if least is not None:
            late = any(u is not None and x > u for x, u in zip(least, problem.longest, strict=True))
            _need(late, "infeasible only if a segment needs more than its upper bound")
            return lower, upper
        longest = [x for x in problem.longest if x is not None]
        timeless = all(row[5] >= 0 or (row[0] == "place" and row[2] == 0) for row in proof["rows"])
        above = len(longest) == 3 and lower > sum(longest)
        _need(timeless or above, "infeasible only above all upper bounds, or without the total")
    else:
        h = [_number(x) for x in claim["durations"]]
        upper = _number(claim["upper"])
        _need(
            len(h) == len(problem.longest) and sum(h) <= upper,
            "the durations exceed the upper bound",
        )
        _check_answer(problem, h)
    if least is not None:
        return lower, upper
    _need(total > 0, "the total is not positive")
    quintics = [_quintic(list(column)) for column in zip(*problem.waypoints, strict=True)]
    polys = [_row(problem, quintics, row, total) for row in proof["rows"]]
    boxes = _leaves(proof["tree"])
    _need(len(boxes) == len(proof["leaves"]), "leaves and tree differ in number")
    for number, (box, leaf) in enumerate(zip(boxes, proof["leaves"], strict=True)):
        which = [_whole(k, 0, len(polys) - 1) for k in leaf[::2]]
        weights = [_number(x) for x in leaf[1::2]]
        _need(len(which) == len(weights) > 0, f"leaf {number}: no weights")
        _need(min(weights) >= 0 and any(weights), f"leaf {number}: weights")
        mixed = _plus(*((w, polys[k]) for k, w in zip(which, weights, strict=True)))
        _need(_covers(mixed, box), f"leaf {number} is not proved")
    return lower, upper
