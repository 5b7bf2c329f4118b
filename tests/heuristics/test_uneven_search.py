"""Searches within limits whose sides differ: each side is judged, and equal ones as before."""

import numpy as np
import pytest
from support.uneven import CURVES, LIMITS, WAYPOINTS, mirrored, sampled_ratios, uneven_problem
from trajgap.heuristics import DeathPenalty, run
from trajgap.heuristics.algorithms import from_settings
from trajgap.nlp import solve
from trajgap.problem import Problem, Verdict, check

SWARM = from_settings(
    "pso",
    {"particles": 20, "iterations": 60},
)


def bounded(curve: str) -> Problem:
    own = uneven_problem(curve)
    return Problem(WAYPOINTS, LIMITS, own.curve, 0.1, 5.0)


@pytest.mark.parametrize("curve", CURVES)
def test_the_penalty_falls_on_either_side(curve: str) -> None:
    problem = bounded(curve)
    h = np.random.default_rng(5).uniform(0.3, 3.0, (200, 3))
    fitness = DeathPenalty(problem)(h)
    assert np.isinf(fitness).any()
    assert np.isfinite(fitness).any()
    for one, value in zip(h, fitness, strict=True):
        worst = sampled_ratios(problem, one, 201).max()
        if abs(worst - 1.0) > 1e-3:
            assert np.isinf(value) == (worst > 1.0)
    back = Problem(-WAYPOINTS, mirrored(problem).limits, problem.curve, 0.1, 5.0)
    np.testing.assert_array_equal(DeathPenalty(back)(h), fitness)


def test_a_search_keeps_both_sides_and_stays_above_the_optimum() -> None:
    problem = bounded("3-5-3")
    found = run(SWARM, problem, seed=1)
    assert found.feasible
    assert check(problem, found.durations).verdict is Verdict.PASS
    assert found.durations.sum() >= solve(problem).total_time * (1 - 1e-9)
    # Within the larger size alone a shorter motion would pass.
    assert check(problem, solve(problem.hull).durations).verdict is Verdict.VIOLATED
