"""The shortest total at fixed ratios: against other routes, and what no total repairs."""

from dataclasses import replace

import numpy as np
import pytest
from support.uneven import CURVES as UNEVEN
from trajgap.nlp import Evidence, Status, solve_per_joint
from trajgap.nlp.optimum import solve
from trajgap.problem import Coupling, Limits, Problem, TrajgapError, Verdict, check, curves

Q = np.array([[0.2, -1.0], [0.9, 0.3], [0.4, 1.1], [1.3, 0.6]])
LIMITS = Limits([1.5, 2.0], [4.0, 3.0], [30.0, 12.0])
RATIOS = np.array([1.0, 1.7, 0.6])
CURVES = [*(curve() for curve in UNEVEN.values()), curves.uniform_cubic_b_spline(4, "timed")]
EVERY = pytest.mark.parametrize("curve", CURVES, ids=lambda curve: curve.name)


def shortest(problem: Problem) -> float:
    answer = solve(problem)
    assert answer.status is Status.CONVERGED
    assert answer.evidence is Evidence.BEST_KNOWN
    assert "closed form" in str(answer.why)
    assert check(problem, answer.durations).limits is Verdict.PASS
    np.testing.assert_allclose(answer.durations / answer.total_time, problem.shares, rtol=1e-12)
    return answer.total_time


@EVERY
def test_a_bound_on_a_duration_is_in_force_where_it_asks_for_more(curve) -> None:
    problem = Problem(Q, LIMITS, curve, ratios=RATIOS)
    own = shortest(problem)
    held = replace(problem, duration_lower=[0.0, own, 0.0])
    assert shortest(held) == pytest.approx(own * RATIOS.sum() / 1.7, rel=1e-9)


@EVERY
def test_the_free_optimum_is_at_most_as_long_and_is_met_at_its_own_ratios(curve) -> None:
    problem = Problem(Q, LIMITS, curve)
    free = solve(problem)
    assert shortest(replace(problem, ratios=RATIOS)) >= free.total_time * (1 - 1e-9)
    at_its_own = shortest(replace(problem, ratios=free.durations))
    assert at_its_own == pytest.approx(free.total_time, rel=1e-8)


def test_one_segment_has_one_ratio() -> None:
    problem = Problem(Q[:2], LIMITS, curves.rest_to_rest(1, 5))
    fixed = shortest(replace(problem, ratios="equal"))
    assert fixed == pytest.approx(solve(problem).total_time, rel=1e-9)
    assert fixed == pytest.approx(shortest(replace(problem, ratios=[7.3])), rel=1e-12)


@pytest.mark.parametrize("ratios", ["equal", "chord", RATIOS])
def test_joints_by_themselves_give_the_same_total(ratios) -> None:
    problem = Problem(Q, LIMITS, curves.cubic_spline(3), coupling=Coupling.PER_JOINT, ratios=ratios)
    answer = solve_per_joint(problem, slacks=(0.01,))
    own = shortest(problem)
    assert answer.total_time == pytest.approx(own, rel=1e-12)
    assert max(one.total_time for one in answer.joints) == pytest.approx(own, rel=1e-12)
    (span,) = answer.ranges
    assert (span.lowest, span.highest) == pytest.approx((own, own + 0.01), rel=1e-12)


def test_a_path_that_leaves_its_range_is_not_mended_by_time() -> None:
    limits = replace(LIMITS, position_upper=[1.31, 1.1])
    problem = Problem(Q, limits, curves.cubic_spline(3), ratios=RATIOS)
    answer = solve(problem)
    assert answer.status is Status.INFEASIBLE
    assert "at these ratios joint 2 reaches" in str(answer.why)
    sliding = solve(replace(problem, linear=(False, True)))
    assert " m, beyond" in sliding.why
    assert "rad" not in sliding.why
    wider = replace(problem, limits=replace(limits, position_upper=[1.31, 1.4]))
    assert shortest(wider) == pytest.approx(shortest(replace(problem, limits=LIMITS)), rel=1e-12)


def test_bounds_on_durations_may_leave_no_total() -> None:
    problem = Problem(Q, LIMITS, curves.cubic_spline(3), ratios=RATIOS)
    own = shortest(problem)
    short = replace(problem, duration_upper=0.99 * own * problem.shares)
    assert solve(short).status is Status.INFEASIBLE
    assert "the upper bounds on durations end" in str(solve(short).why)
    bounds = own * problem.shares
    exact = replace(problem, duration_upper=bounds, duration_lower=bounds)
    assert shortest(exact) == pytest.approx(own, rel=1e-12)


def test_a_joint_that_may_not_move() -> None:
    answer = solve(Problem(Q, Limits([1.0, 0.0]), curves.cubic_spline(3), ratios="equal"))
    assert answer.status is Status.INFEASIBLE
    assert answer.why == "joint 2 moves, though its velocity limit is 0"
    still = Q.copy()
    still[:, 1] = 0.5
    assert shortest(Problem(still, Limits([1.0, 0.0]), curves.cubic_spline(3), ratios="equal")) > 0


def test_a_jump_at_the_ratios_is_named() -> None:
    bent = Problem([[0.0], [0.5], [1.5]], Limits(1.0, 1.0), curves.piecewise((1, 1), 0, ()))
    answer = solve(replace(bent, ratios="equal"))
    assert answer.status is Status.NONE_FOUND
    assert answer.why == "at these ratios the velocity of joint 1 jumps, whatever the total"
    assert shortest(replace(bent, ratios="chord")) == pytest.approx(1.5, rel=1e-9)


@pytest.mark.parametrize(
    ("curve", "said"),
    [
        (curves.piecewise((5, 5, 5)), "coefficients per joint free"),
        (curves.piecewise((3, 3, 3), 2, ((1, 0.1),)), "prescribes derivatives other than 0"),
    ],
)
def test_no_formula_is_one_line(curve, said: str) -> None:
    with pytest.raises(TrajgapError, match=said) as error:
        solve(Problem(Q, LIMITS, curve, ratios="equal"))
    assert "leave the ratios out" in str(error.value)


def test_a_short_segment_beside_a_long_one_passes_the_check() -> None:
    close = Q.copy()
    close[1] = close[0] + 1e-7
    answer = solve(Problem(close, LIMITS, curves.quintic_spline(3), ratios="chord"))
    assert answer.check.verdict is Verdict.PASS
