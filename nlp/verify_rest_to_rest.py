"""Proof of the optimum of rest-to-rest polynomials, checked again: standard library only."""

from __future__ import annotations

from fractions import Fraction
from math import comb
from typing import Any

from .verify_answer import at, check_answer, derivative, read_answer
from .verify_problem import Proved, Stated, need, number, read_problem, whole

PLACES = 2**20


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
    problem, claim = read_problem(document["problem"]), document["claim"]
    least = _least(problem, _degree(problem), document["proof"]["segments"])
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
    check_answer(problem, answer[0])
    return Proved(lower, answer[1])


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


def _least(problem: Stated, degree: int, bounds: Any) -> list[Fraction]:
    """Least duration of every rest-to-rest segment: limit·hʳ ≥ |Δq|·|derivative at a place|."""
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
            s = Fraction(whole(place, 0, PLACES), PLACES)
            peak = abs(at(derivative(_from_rest(degree), order), s))
            way = abs(problem.waypoints[k + 1][joint] - problem.waypoints[k][joint])
            proved = bound[1] * x**order <= way * peak
            need(proved, f"segment {k + 1}: its least duration is not proved")
        out.append(x)
    return out
