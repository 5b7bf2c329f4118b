"""Optima within limits whose sides differ, beside SLSQP on dense samples and identities."""

import numpy as np
import pytest
from support.uneven import CURVES, LIMITS, WAYPOINTS, mirrored, sampled_optimum, uneven_problem
from trajgap.nlp import Status, retime, solve
from trajgap.problem import Limits, Problem, Verdict, cubic_spline, fit, piecewise, rest_to_rest


@pytest.mark.parametrize("curve", ["3-5-3", "cubic", "quintic", "rest-to-rest"])
def test_the_optimum_is_that_of_dense_samples(curve: str) -> None:
    problem = uneven_problem(curve)
    found = solve(problem)
    assert found.status is Status.CONVERGED
    assert found.check is not None
    assert found.check.verdict is Verdict.PASS
    assert found.total_time == pytest.approx(sampled_optimum(problem), rel=1e-3)


@pytest.mark.parametrize("curve", CURVES)
def test_mirror_order_and_scale_of_time(curve: str) -> None:
    problem = uneven_problem(curve)
    total = solve(problem).total_time
    assert solve(mirrored(problem)).total_time == pytest.approx(total, rel=1e-9)
    turned = LIMITS.with_sides(LIMITS.sides[:, ::-1])
    assert solve(Problem(WAYPOINTS[:, ::-1], turned, problem.curve)).total_time == pytest.approx(
        total, rel=1e-8
    )
    slow = LIMITS.with_sides(LIMITS.sides / 4.0 ** np.arange(1, 4))
    assert solve(Problem(WAYPOINTS, slow, problem.curve)).total_time == pytest.approx(
        4.0 * total, rel=1e-8
    )


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


def test_free_derivatives_are_used_by_side() -> None:
    free = piecewise((5, 5, 5), 2)
    limits = Limits([[-0.9, 1.4], [-2, 1.1]], [[-3, 5], [-6, 2.5]])
    problem = Problem(WAYPOINTS, limits, free)
    found, back = solve(problem, starts=2), solve(mirrored(problem), starts=2)
    assert found.check is not None
    assert found.check.verdict is Verdict.PASS
    assert found.total_time == pytest.approx(back.total_time, rel=1e-6)
    assert solve(problem.hull, starts=2).total_time < found.total_time * (1 - 1e-3)


def test_many_segments_are_solved_by_side() -> None:
    q = np.cumsum(np.random.default_rng(3).normal(size=(27, 1)), axis=0)
    limits = Limits([[-1.0, 2.0]], [[-4.0, 2.0]], [[-30.0, 60.0]])
    found = solve(Problem(q, limits, cubic_spline(26)))
    assert found.check is not None
    assert found.check.verdict is Verdict.PASS
    back = solve(Problem(-q, limits.with_sides(limits.sides[::-1]), cubic_spline(26)))
    assert back.total_time == pytest.approx(found.total_time, rel=1e-6)


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


def test_an_active_limit_names_its_side() -> None:
    found = solve(uneven_problem("rest-to-rest"))
    assert found.active
    for active in found.active:
        assert active.sensitivity < 0


def test_retiming_of_a_path_says_that_it_does_not_apply() -> None:
    problem = uneven_problem("cubic")
    motion = fit(problem.curve, WAYPOINTS, [0.7, 1.3, 0.9])
    answer = retime(motion, problem.limits)
    assert not answer.applicable
    assert "two sides" in str(answer.why)


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
