"""Proof of the optimum of a stretched uniform cubic B-spline, checked again: standard library only.

A segment's duration h divides the derivatives in e by h, h², h³, and enters no other segment. The
limits are those inside the segments: where neighbours differ in duration, the velocity jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from .verify_answer import at, check_durations, derivative, nonnegative
from .verify_problem import Proved, Stated, need, read_problem
from .verify_segments import prove_segments

CURVE = "uniform cubic B-spline, segments stretched in time"


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
    problem = read_problem(document["problem"])
    need(problem.curve == CURVE, "declaration not covered: no stretched uniform cubic B-spline")
    curves = [_pieces(list(column)) for column in zip(*problem.waypoints, strict=True)]

    def peak(joint: int, segment: int, order: int, e: Fraction) -> Fraction:
        return abs(at(derivative(curves[joint][segment], order), e))

    return prove_segments(document, problem, peak, lambda h: _check(problem, curves, h))


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
                    nonnegative(rest, Fraction(1)),
                    f"answer: joint {j + 1}, segment {k + 1}, derivative {order} exceeds its limit",
                )
