"""One small certificate of every kind of proof, and the true optimum of the problem in a file.

Each kind of proof that `verify` knows has an entry in `KINDS`, so that the attacks in
test_verify.py reach it.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from support.forgeries.forgery import document as committed
from support.three_pieces import dense_best
from trajgap.problem import (
    Limits,
    Problem,
    evaluate,
    quintic_spline,
    rest_to_rest,
    solve_in_closed_form,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.verify.quintic_tree import read_tree
from trajgap.verify.reading import Clock
from trajgap.verify.verdict import seal

Document = dict[str, Any]


@dataclass(frozen=True)
class Kind:
    """A way to make a small certificate, and a second route to the optimum of any like it."""

    make: Callable[[], Problem]
    gap: float
    optimum: Callable[[Problem], float]
    """An upper estimate of the least total, inf where nothing is feasible."""


def declared() -> Problem:
    """Few boxes, and every kind of number."""
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    limits = Limits([1.0, 0.9], [2.0, 1.5], [np.inf, 8.0], [-1.5, -np.inf], [np.inf, 1.75])
    return Problem(q, limits, three_five_three(), (0.5, 0.1, 0.1), (6.0, 6.0, 7.0))


def rest() -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75]])
    limits = Limits([1.0, 0.9], [2.0, np.inf], [np.inf, 8.0], [-1.5, -np.inf], [np.inf, 1.75])
    return Problem(q, limits, rest_to_rest(2, 5), (0.5, 4.0), (6.0, 7.0))


def stretched() -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    limits = Limits([1.0, 0.9], [2.0, 1.5], [np.inf, 9.0], [-1.5, -np.inf], [np.inf, 1.75])
    return Problem(
        q, limits, uniform_cubic_b_spline(4, "stretched"), (0.5, 4.0, 0.1), (6.0, 7.0, 8.0)
    )


def quintic() -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    limits = Limits([1.0, 0.9], [2.0, 1.5], [np.inf, 9.0])
    return Problem(q, limits, quintic_spline(3), (0.5, 0.1, 0.1))


def _alone(needs: np.ndarray, problem: Problem) -> float:
    """Total where each segment stands alone; positions are left out, which only shortens it."""
    h = np.maximum(needs, problem.duration_lower)
    return float("inf") if (h > problem.duration_upper).any() else float(h.sum())


def rest_optimum(problem: Problem) -> float:
    """Each segment alone, by bisection on the checker's exact peaks."""
    needs = []
    for k in range(problem.segments):
        low, high = 0.0, 1e6
        q = problem.waypoints[k : k + 2]
        one = Problem(q, problem.limits, rest_to_rest(1, 5))
        if not np.ptp(q, axis=0).any():
            needs.append(0.0)
            continue
        for _ in range(90):
            middle = 0.5 * (low + high)
            fits = float(evaluate(one, np.array([[middle]])).stretch[0]) <= 1.0
            low, high = (low, middle) if fits else (middle, high)
        needs.append(high)
    return _alone(np.array(needs), problem)


def stretched_optimum(problem: Problem) -> float:
    """The floating-point closed form of `trajgap.problem`."""
    limits = problem.limits.derivatives
    return _alone(solve_in_closed_form(problem.curve, problem.waypoints, limits), problem)


def at_ratios() -> Problem:
    """Tight in the second joint, and in no segment at its end."""
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    limits = Limits([1.0, 0.9], [2.0, 1.5], [np.inf, 9.0], [-1.5, -np.inf], [np.inf, 1.75])
    return Problem(
        q, limits, quintic_spline(3), (0.5, 0.1, 0.1), (9.0, 9.0, 9.0), ratios=[1.0, 1.75, 1.25]
    )


def ratios_optimum(problem: Problem) -> float:
    """The stretch of any durations of these ratios; positions are left out."""
    shares = problem.shares
    if shares is None:
        return float("inf")
    total = float(evaluate(problem, shares[None]).stretch[0])
    total = max(total, float((problem.duration_lower / shares).max()))
    beyond = (total * shares > problem.duration_upper * (1 + 1e-12)).any()
    return float("inf") if beyond else total


KINDS = {
    "declared": Kind(declared, 0.03, lambda problem: dense_best(problem, 81)),
    "rest-to-rest": Kind(rest, 1e-6, rest_optimum),
    "quintic-spline": Kind(quintic, 0.1, lambda problem: dense_best(problem, 81)),
    "stretched": Kind(stretched, 1e-6, stretched_optimum),
    "fixed-ratios": Kind(at_ratios, 1e-6, ratios_optimum),
}


@cache
def text(kind: str) -> str:
    """The committed certificate of a kind, as JSON; its tree is a list of nodes."""
    document = committed(kind)
    nodes = document["proof"]["tree"]
    if isinstance(nodes, str):
        # As a list of nodes each number can be altered by itself.
        document["proof"]["tree"] = read_tree(nodes, Clock(60.0))
        document["seal"] = seal({k: x for k, x in document.items() if k != "seal"})
    return json.dumps(document)


def stated(document: Document) -> Problem:
    """The problem in a certificate, by a second route."""
    p = document["problem"]

    def numbers(row: list[Any], absent: float) -> list[float]:
        return [absent if x is None else float(Fraction(x)) for x in row]

    v, a, j = np.array([numbers(row, np.inf) for row in p["limits"]]).T
    limits = Limits(
        v, a, j, numbers(p["position_lower"], -np.inf), numbers(p["position_upper"], np.inf)
    )
    return Problem(
        np.array([numbers(row, 0.0) for row in p["waypoints"]]),
        limits,
        KINDS[document["proof"]["kind"]].make().curve,
        numbers(p["duration_lower"], 0.0),
        numbers(p["duration_upper"], np.inf),
        ratios=numbers(p["ratios"], 0.0) if "ratios" in p else None,
    )
