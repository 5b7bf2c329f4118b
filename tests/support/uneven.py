"""Problems whose lower and upper limits differ, and dense samples of what keeps them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize
from trajgap.problem import (
    Array,
    Curve,
    Limits,
    Problem,
    Timing,
    cubic_spline,
    evaluate,
    fit,
    quintic_spline,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)

WAYPOINTS = np.array([[0.1, -0.4], [0.7, 0.3], [1.2, -0.5], [0.9, 0.2]])
"""Both joints turn, so that every side of a limit is met."""
LIMITS = Limits([[-0.9, 1.4], [-2, 1.1]], [[-3, 5], [-6, 2.5]], [[-40, 25], [-20, 60]])
"""No two sides alike."""
CURVES: dict[str, Callable[[], Curve]] = {
    "3-5-3": three_five_three,
    "cubic": lambda: cubic_spline(3),
    "quintic": lambda: quintic_spline(3),
    "rest-to-rest": lambda: rest_to_rest(3, 5),
    "stretched": lambda: uniform_cubic_b_spline(4, Timing.STRETCHED),
}
"""Kinds of curves through four way-points."""
PLACES = 61
"""Samples of a piece: between them a parabola rises by less than 1e-3 of its size."""


def uneven_problem(curve: str, limits: Limits = LIMITS) -> Problem:
    """A problem of three segments and two joints."""
    return Problem(WAYPOINTS, limits, CURVES[curve]())


def mirrored(problem: Problem) -> Problem:
    """The same question for −q: every lower limit is an upper one."""
    limits = problem.limits.with_sides(problem.limits.sides[::-1])
    return Problem(-problem.waypoints, limits, problem.curve)


def sampled_ratios(problem: Problem, h: Array, places: int = PLACES) -> Array:
    """Values over the limit on their side at dense places of each piece, all in one row."""
    motion = fit(problem.curve, problem.waypoints, h)
    below, above = problem.limits.sides
    found = []
    for start, step in zip(motion.breaks[:-1], np.diff(motion.breaks), strict=True):
        times = start + step * np.linspace(1e-9, 1.0 - 1e-9, places)
        for r in (1, 2, 3):
            values = motion(times, r)
            found += [values / above[:, r - 1], -values / below[:, r - 1]]
    return np.concatenate(found).ravel()


def sampled_optimum(problem: Problem, tries: int = 5) -> float:
    """Least total of several descents of SLSQP on samples: a little below the true optimum."""
    generator, best = np.random.default_rng(0), np.inf
    usual = np.log(evaluate(problem, np.ones((1, problem.segments))).stretch[0])
    for _ in range(tries):
        found = minimize(
            lambda z: float(np.exp(z).sum()),
            usual + generator.normal(0.0, 0.3, problem.segments),
            jac=np.exp,
            constraints={
                "type": "ineq",
                "fun": lambda z: 1.0 - sampled_ratios(problem, np.exp(z)),
            },
            method="SLSQP",
            options={"maxiter": 300, "ftol": 1e-12},
        )
        if found.success and sampled_ratios(problem, np.exp(found.x)).max() < 1.0 + 1e-7:
            best = min(best, float(found.fun))
    return best
