"""Optima within limits whose sides differ, beside SLSQP on dense samples and identities."""

import numpy as np
import pytest
from support.uneven import CURVES, LIMITS, WAYPOINTS, sampled_optimum, uneven_problem
from trajgap.nlp import Status, solve
from trajgap.problem import Limits, Problem, Verdict, cubic_spline, rest_to_rest


@pytest.mark.parametrize("curve", ["3-5-3", "cubic", "quintic", "rest-to-rest"])
def test_the_optimum_is_that_of_dense_samples(curve: str) -> None:
    problem = uneven_problem(curve)
    found = solve(problem)
    assert found.status is Status.OPTIMAL
    assert found.check is not None
    assert found.check.verdict is Verdict.PASS
    assert found.total_time == pytest.approx(sampled_optimum(problem), rel=1e-3)


@pytest.mark.parametrize("curve", CURVES)
def test_it_lies_between_the_narrower_and_the_wider_size(curve: str) -> None:
    problem = uneven_problem(curve)
    narrow = problem.limits.with_derivatives(problem.limits.sides.min(axis=0))
    inside = solve(Problem(WAYPOINTS, narrow, problem.curve)).total_time
    outside = solve(problem.hull).total_time
    assert outside * (1 + 1e-3) < solve(problem).total_time <= inside * (1 + 1e-9)


def test_a_closed_form() -> None:
    """A rest-to-rest cubic over 1 rad has |a| = 6/h² on both sides: the smaller size decides."""
    line, curve = np.array([[0.0], [1.0], [-1.0]]), rest_to_rest(2, 3)
    found = solve(Problem(line, Limits(velocity=[[-0.5, 2.0]]), curve))
    # max |v| of a way d is 1.5 |d|/h: forth at 2, back at 0.5.
    assert found.durations == pytest.approx([0.75, 6.0], rel=1e-9)
    found = solve(Problem(line, Limits(acceleration=[[-1.5, 6.0]]), curve))
    assert found.durations == pytest.approx([2.0, np.sqrt(8.0)], rel=1e-9)


def test_position_limits_hold_beside_uneven_ones() -> None:
    free = uneven_problem("quintic")
    motion = solve(free).trajectory
    # Joint 2 swings past its second way-point at 0.3; it may do so by half as much.
    most = float(motion(np.linspace(0.0, motion.total_time, 2001))[:, 1].max())
    assert most > 0.3 + 1e-2
    limits = LIMITS.with_positions([-np.inf, -np.inf], [np.inf, 0.15 + 0.5 * most])
    found = solve(Problem(WAYPOINTS, limits, free.curve))
    assert found.check is not None
    assert found.check.verdict is Verdict.PASS
    assert found.total_time > motion.total_time * (1 + 1e-6)


def test_too_little_time_is_proved_by_the_larger_side() -> None:
    problem = Problem(
        WAYPOINTS, Limits([[-0.9, 1.4], [-2, 1.1]]), cubic_spline(3), duration_upper=0.1
    )
    found = solve(problem)
    assert found.status is Status.INFEASIBLE
    assert "velocity limit" in str(found.why)


def test_a_search_stays_where_curves_have_coefficients() -> None:
    """One side is all but forbidden, and the joint has to turn: longer durations never keep it."""
    line = np.array([[-0.507552], [-0.232662], [0.0889934], [-0.112367]])
    limits = Limits(velocity=[[-1.145e-5, 1.042]])
    found = solve(Problem(line, limits, cubic_spline(3, ((1, 0.0212686),))))
    assert found.status is Status.NONE_FOUND
    assert found.why is not None
    assert "least excess" in found.why
