"""One small certificate of every kind of proof, and the true optimum of the problem in a file.

Each kind of proof that `verify` knows has an entry in `KINDS`, so attacks reach it.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from support.forgeries.forgery import document as committed
from support.intervals import dense_best
from trajgap.nlp import estimate_any_curve
from trajgap.problem import Curve, Limits, Problem, curves, evaluate
from trajgap.verify import Subject

Document = dict[str, Any]


@dataclass(frozen=True)
class Kind:
    """A way to make a small certificate, and a second route to the optimum of any like it."""

    make: Callable[[], Problem]
    gap: float
    optimum: Callable[[Problem], float]
    """An upper estimate of the least total, inf if nothing is feasible."""
    exact: bool = False
    """Whether the estimate is a lower one, too."""
    many: int = 1000
    """Attacks on each field in a slow test."""
    subject: Subject = Subject.DECLARED


WAYPOINTS = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
SIDES = ([-1.5, -np.inf], [np.inf, 1.75])
"""Position limits: of each joint on one side."""


def posed(curve: Curve, jerk: float, *bounds: Any, positions: Any = SIDES, **more: Any) -> Problem:
    """Few boxes, and every kind of number: joints that differ in what limits them."""
    q = WAYPOINTS[: curve.segments + 1]
    bend = 1.5 if curve.segments > 2 else np.inf
    limits = Limits([1.0, 0.9], [2.0, bend], [np.inf, jerk], *positions)
    return Problem(q, limits, curve, *bounds, **more)


def _searched(problem: Problem) -> float:
    return dense_best(problem, 2000)


def cubic() -> Problem:
    limits = Limits([1.0, 0.9], [2.0, 1.5], [9.0, 8.0])
    return Problem(WAYPOINTS, limits, curves.cubic_spline(3), (0.5, 1.5, 0.1), (6.0, 2.0, 7.0))


def any_curve() -> Problem:
    """A joint that brakes for the other one."""
    q = np.array([[0.0, 0.0], [0.25, 1.0], [3.0, 1.125]])
    limits = Limits([3.0, 1.5], [2.0, 4.0])
    return Problem(q, limits, curves.cubic_spline(2), (0.4, 0.7), (2.0, 1.875))


def any_curve_optimum(problem: Problem) -> float:
    found = estimate_any_curve(problem).total_time
    return float("inf") if found is None else found


def _alone(needs: np.ndarray, problem: Problem) -> float:
    """Total where each segment stands alone; positions are left out, which only shortens it."""
    h = np.maximum(needs, problem.duration_lower)
    return float("inf") if (h > problem.duration_upper).any() else float(h.sum())


def rest_optimum(problem: Problem) -> float:
    """Each segment alone, stretched until it keeps its limits."""
    each = zip(problem.waypoints[:-1], problem.waypoints[1:], strict=True)
    alone = [Problem(np.array(q), problem.limits, curves.rest_to_rest(1, 5)) for q in each]
    needs = [float(evaluate(one, [[1.0]]).stretch[0]) for one in alone]
    return _alone(np.array(needs), problem)


def stretched_optimum(problem: Problem) -> float:
    """The floating-point closed form of `trajgap.problem`."""
    limits = problem.limits.derivatives
    return _alone(curves.solve_in_closed_form(problem.curve, problem.waypoints, limits), problem)


def ratios_optimum(problem: Problem) -> float:
    """The stretch of any durations of these ratios; positions are left out."""
    shares = problem.shares
    if shares is None:
        return float("inf")
    total = float(evaluate(problem, shares[None]).stretch[0])
    total = max(total, float((problem.duration_lower / shares).max()))
    beyond = (total * shares > problem.duration_upper * (1 + 1e-12)).any()
    return float("inf") if beyond else total


SHORT = (0.5, 0.1, 0.1)
KINDS = {
    "declared": Kind(
        lambda: posed(curves.three_five_three(), 8.0, SHORT, (6.0, 6.0, 7.0)), 0.03, _searched
    ),
    "rest-to-rest": Kind(
        lambda: posed(curves.rest_to_rest(2, 5), 8.0, (0.5, 4.0), (6.0, 7.0)),
        1e-6,
        rest_optimum,
        exact=True,
    ),
    "quintic-spline": Kind(
        lambda: posed(curves.quintic_spline(3), 9.0, SHORT, positions=()), 0.1, _searched
    ),
    "stretched": Kind(
        lambda: posed(
            curves.uniform_cubic_b_spline(4, "stretched"), 9.0, (0.5, 4.0, 0.1), (6.0, 7.0, 8.0)
        ),
        1e-6,
        stretched_optimum,
        exact=True,
    ),
    # Tight in the second joint, and in no segment at its end.
    "fixed-ratios": Kind(
        lambda: posed(
            curves.quintic_spline(3), 9.0, SHORT, (9.0, 9.0, 9.0), ratios=[1.0, 1.75, 1.25]
        ),
        1e-6,
        ratios_optimum,
        exact=True,
    ),
    "cubic": Kind(cubic, 1e-3, _searched, many=100),
    "any-curve": Kind(any_curve, 1e-5, any_curve_optimum, exact=True, subject=Subject.ANY),
}


@cache
def text(kind: str) -> str:
    """The committed certificate of a kind, as JSON."""
    return json.dumps(committed(kind))


def stated(document: Document) -> Problem:
    """The problem in a certificate, by a second route."""
    p = document["problem"]

    def numbers(row: list[Any], absent: float) -> list[float]:
        return [absent if x is None else float(Fraction(x)) for x in row]

    v, a, j = np.array([numbers(row, np.inf) for row in p["limits"]]).T
    limits = Limits(
        v, a, j, numbers(p["position_lower"], -np.inf), numbers(p["position_upper"], np.inf)
    )
    kind = KINDS[document["proof"]["kind"]]
    curve = kind.make().curve
    if kind.subject is Subject.ANY:  # of which the velocities at the ends matter
        first, last = (
            tuple((1, float(Fraction(x))) for order, x in p["prescribed"][end] if order == 1)
            for end in (0, -1)
        )
        curve = curves.cubic_spline(2, first, last)
    q = np.array([numbers(row, 0.0) for row in p["waypoints"]])
    lower, upper = numbers(p["duration_lower"], 0.0), numbers(p["duration_upper"], np.inf)
    ratios = numbers(p["ratios"], 0.0) if "ratios" in p else None
    return Problem(q, limits, curve, lower, upper, ratios=ratios)
