"""Each joint separately: the longest durations, and the ranges of near optima by two methods."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import nnls
from support.samples import FAMILIES, small_problem
from trajgap.nlp import Evidence, PerJointSolution, Status, solve_per_joint
from trajgap.nlp.clock import stopping_after
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.limit_rows import exact_rows
from trajgap.nlp.per_joint import Near, nearby
from trajgap.problem import Array, Limits, Problem, check, load_case, piecewise, rest_to_rest


def puma(reading: str) -> Problem:
    return load_case("puma560-mnam-pso-353").problem(reading_id=reading)


@cache
def answered(reading: str = "durations-at-least-0.3") -> PerJointSolution:
    return solve_per_joint(puma(reading), slacks=(5e-4, 1e-6))


@pytest.mark.parametrize(
    "reading",
    ["durations-at-least-0.3", pytest.param("durations-positive", marks=pytest.mark.slow)],
)
def test_the_procedure_is_the_longest_of_each_joints_own_optimum(reading: str) -> None:
    problem, answer = puma(reading), answered(reading)
    own = [solve(problem.joint(j)) for j in range(6)]
    assert answer.status is Status.CONVERGED
    assert answer.durations == pytest.approx(np.max([s.durations for s in own], axis=0))
    wide, narrow = answer.ranges
    assert wide.lowest <= narrow.lowest <= answer.total_time <= narrow.highest <= wide.highest
    assert answer.total_time >= solve(problem).total_time


def test_a_curve_with_free_derivatives_has_joint_optima_but_no_longest_motion() -> None:
    q = np.array([[0.2, -1.0], [0.9, 0.3], [0.4, 1.1], [1.3, 0.6]])
    answer = solve_per_joint(Problem(q, Limits(1.5, 4.0, joints=2), piecewise((5, 5, 5), 2)))
    assert not answer.found
    assert all(s.found for s in answer.joints)
    assert "leaves 4 derivatives of each joint free" in answer.why


def test_a_joint_without_answer_leaves_the_procedure_without_one() -> None:
    q = np.array([[0.0, 0.0], [1.0, 1.0]])
    answer = solve_per_joint(Problem(q, Limits([1.0, 0.0], 2.0), rest_to_rest(1, 5)))
    assert answer.status is Status.INFEASIBLE
    assert not answer.found
    assert "joint 2" in answer.why
    assert "joint 2" in str(answer)


def test_the_longest_of_searches_that_did_not_converge_is_not_called_best_known() -> None:
    problem = puma("durations-at-least-0.3")
    with stopping_after(0.0):
        stopped = solve_per_joint(problem)
    assert {s.evidence for s in stopped.joints} == {Evidence.UNCONVERGED}
    assert stopped.found
    assert stopped.evidence is Evidence.UNCONVERGED
    assert answered().evidence is Evidence.BEST_KNOWN


def unexplained(problem: Problem, h: Array, weights: Array, cap: float) -> float:
    """What is left of the objective's slope after the limits, the cap and the bounds at ``h``.

    In log durations; 0 where no other motion nearby is better to first order.
    """
    rows = exact_rows(problem, h)
    at = rows.excess > -1e-6
    ends = [np.eye(h.size)[k] for k in np.flatnonzero(h > problem.duration_upper * (1 - 1e-8))]
    ends += [-np.eye(h.size)[k] for k in np.flatnonzero(h < problem.duration_lower * (1 + 1e-8))]
    if h.sum() > cap * (1 - 1e-8):
        ends.append(h / h.sum())
    walls = np.vstack([rows.gradient[at], *ends])
    _, left = nnls(walls.T, -weights * h)
    return float(left) / cap


@pytest.mark.parametrize("family", FAMILIES)
def test_durations_within_a_slack_meet_the_conditions_of_an_optimum(family: str) -> None:
    for seed, slack in ((0, 1e-3), (1, 1e-6)):
        problem = small_problem(family, seed).joint(0)
        optimum = solve(problem).durations
        cap, n = float(optimum.sum()) * (1.0 + slack), problem.segments
        for weights in (*-np.eye(n), np.eye(n)[0] - 1.0):
            (h,) = nearby(Near([problem], [optimum], [cap], weights))
            assert check(problem, h).stretch <= 1.0 + 1e-8
            assert h.sum() <= cap * (1.0 + 1e-8)
            assert weights @ h <= weights @ optimum * (1 - 1e-9)
            assert unexplained(problem, h, weights, cap) < 1e-4


def test_a_range_that_is_known_in_closed_form() -> None:
    # Rest to rest, h_k ≥ its own least duration and nothing else: what the slack leaves goes to
    # any one segment, or is shared.
    q = np.array([[0.3], [1.1], [0.4], [2.0]])
    problem = Problem(q, Limits(2.0, 3.0, joints=1), rest_to_rest(3, 5))
    least = solve(problem).durations
    cap = float(least.sum()) + 0.01
    for k in range(3):
        found = nearby(Near([problem], [least], [cap], -np.eye(3)[k]))
        assert found[0] == pytest.approx(least + 0.01 * np.eye(3)[k], abs=1e-9)
    bounded = replace(problem, duration_upper=least + np.array([0.004, 1.0, 1.0]))
    found = nearby(Near([bounded], [least], [cap], -np.eye(3)[0]))
    assert found[0][0] == pytest.approx(least[0] + 0.004, abs=1e-9)
