"""Proof of the optimum of rest-to-rest polynomials, checked again: standard library only."""

from __future__ import annotations

from fractions import Fraction
from math import comb
from typing import Any

from .verify_answer import at, check_answer, derivative
from .verify_problem import Proved, Stated, need, read_problem
from .verify_segments import prove_segments


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "rest-to-rest" again.

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
    shape = _from_rest(_degree(problem))

    def peak(joint: int, segment: int, order: int, s: Fraction) -> Fraction:
        q = problem.waypoints
        way = abs(q[segment + 1][joint] - q[segment][joint])
        return way * abs(at(derivative(shape, order), s))

    return prove_segments(document, problem, peak, lambda h: check_answer(problem, h))


def _degree(problem: Stated) -> int:
    given = problem.declaration
    need(given is not None, "declaration not covered: no rest-to-rest polynomials")
    assert given is not None
    degree, n = given.degrees[0], len(given.degrees)
    rest = {order: Fraction(0) for order in range(1, (degree + 1) // 2)}
    need(
        given.degrees == [2 * len(rest) + 1] * n
        and bool(rest)
        and given.continuity == [0] * (n - 1)
        and given.prescribed == [rest] * (n + 1)
        and not given.virtual,
        "declaration not covered: no rest-to-rest polynomials",
    )
    return degree


def _from_rest(degree: int) -> list[Fraction]:
    """From 0 to 1 with half of the derivatives 0 at both ends: the integral of (s(1 − s))ᵐ."""
    m = degree // 2
    inside = [Fraction(0)] * m + [Fraction((-1) ** k * comb(m, k)) for k in range(m + 1)]
    total = sum(c / (p + 1) for p, c in enumerate(inside))
    return [Fraction(0)] + [c / (p + 1) / total for p, c in enumerate(inside)]
