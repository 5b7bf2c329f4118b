"""Proof of the optimum of a stretched uniform cubic B-spline, checked again: standard library only.

A segment's duration h divides the derivatives in e by h, h², h³, and enters no other segment. The
limits are those inside the segments: where neighbours differ in duration, the velocity jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from .verify_answer import at, check_durations, derivative, nonnegative, read_answer
from .verify_problem import Proved, Stated, need, number, read_problem, whole

CURVE = "uniform cubic B-spline, segments stretched in time"
PLACES = 2**20


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "stretched" again.

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
    problem, claim = read_problem(document["problem"]), document["claim"]
    need(problem.curve == CURVE, "declaration not covered: no stretched uniform cubic B-spline")
    curves = [_pieces(list(column)) for column in zip(*problem.waypoints, strict=True)]
    least = _least(problem, curves, document["proof"]["segments"])
    lower = number(claim["lower"])
    need(lower <= sum(least), "the lower bound exceeds the total that is proved")
    answer = read_answer(claim)
    if claim["infeasible"] is True:
        need(answer is None, "infeasible, but with an answer")
        late = any(u is not None and x > u for x, u in zip(least, problem.longest, strict=True))
        need(late, "infeasible only if a segment needs more than its upper bound")
        return Proved(lower, None, True)
    if answer is None:
        return Proved(lower)
    _check(problem, curves, answer[0])
    return Proved(lower, answer[1])


def _pieces(q: Sequence[Fraction]) -> list[list[Fraction]]:
    """Coefficients of each piece in e, from its scaled derivatives at the way-points.

    A C2 cubic spline on unit steps whose slopes m satisfy m₋ + 4m + m₊ = 3(q₊ − q₋), here with
    both end slopes half the ends' second derivatives (equal control vertices V₀ = V₁): 2m = q″
    at the start, 2m = −q″ at the end.
    """
    n = len(q)
    # q″ at the start of a piece is 6(q₁ − q₀) − 4m₀ − 2m₁, at its end 2m₀ + 4m₁ − 6(q₁ − q₀).
    diagonal = [Fraction(6), *[Fraction(4)] * (n - 2), Fraction(6)]
    above = [Fraction(2), *[Fraction(1)] * (n - 2)]
    below = [*[Fraction(1)] * (n - 2), Fraction(2)]
    right = [6 * (q[1] - q[0])]
    right += [3 * (q[i + 1] - q[i - 1]) for i in range(1, n - 1)]
    right += [6 * (q[-1] - q[-2])]
    for i in range(1, n):
        factor = below[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * above[i - 1]
        right[i] -= factor * right[i - 1]
    slopes = [right[-1] / diagonal[-1]]
    for i in range(n - 2, -1, -1):
        slopes.insert(0, (right[i] - above[i] * slopes[0]) / diagonal[i])
    found = []
    for a, b, u, w in zip(q, q[1:], slopes, slopes[1:], strict=False):
        found.append([a, u, 3 * (b - a) - 2 * u - w, u + w - 2 * (b - a)])
    return found


def _least(
    problem: Stated, curves: Sequence[Sequence[Sequence[Fraction]]], bounds: Any
) -> list[Fraction]:
    """Least duration of every segment: limit·hʳ ≥ |derivative in e at a place|."""
    need(len(bounds) == len(problem.longest), "one bound per segment")
    out = []
    for k, (joint, order, place, text) in enumerate(bounds):
        x = number(text)
        need(x >= 0, f"segment {k + 1}: a negative duration")
        if whole(joint, -1, len(problem.limits) - 1) == -1:
            need(x <= problem.shortest[k], f"segment {k + 1}: above its lower bound")
        else:
            bound = problem.limits[joint][whole(order, 1, 3) - 1]
            need(bound is not None and bound[1] > 0, "a limit that is not there")
            assert bound is not None
            e = Fraction(whole(place, 0, PLACES), PLACES)
            peak = abs(at(derivative(curves[joint][k], order), e))
            need(bound[1] * x**order <= peak, f"segment {k + 1}: its least duration is not proved")
        out.append(x)
    return out


def _check(
    problem: Stated, curves: Sequence[Sequence[Sequence[Fraction]]], h: Sequence[Fraction]
) -> None:
    check_durations(problem, h)
    for j, pieces in enumerate(curves):
        low, high = problem.position[0][j], problem.position[1][j]
        for k, piece in enumerate(pieces):
            sides = [
                (r, s, x[0] * h[k] ** r)
                for r, x in enumerate(problem.limits[j], 1)
                if x
                for s in (1, -1)
            ]
            sides += [(0, 1, high[0])] if high else []
            sides += [(0, -1, -low[1])] if low else []
            for order, sign, limit in sides:
                rest = [-sign * c for c in derivative(piece, order)]
                rest[0] += limit
                need(
                    nonnegative(rest, Fraction(0), Fraction(1)),
                    f"answer: joint {j + 1}, segment {k + 1}, derivative {order} exceeds its limit",
                )
