"""Each joint by itself: the longest durations, and the ranges of near optima by two methods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.small_problems import FAMILIES, small_problem
from trajgap.nlp import Evidence, Status, solve_per_joint
from trajgap.nlp.optimum import near_newton, near_optimal, solve, stopping_after
from trajgap.nlp.optimum.near_newton import applies, reached
from trajgap.problem import Array, Limits, Problem, check, load_case, piecewise, rest_to_rest


def puma(reading: str) -> Problem:
    return load_case("puma560-mnam-pso-353").problem(reading_id=reading)


@pytest.mark.parametrize(
    "reading",
    ["durations-at-least-0.3", pytest.param("durations-positive", marks=pytest.mark.slow)],
)
def test_the_procedure_is_the_longest_of_each_joints_own_optimum(reading: str) -> None:
    problem = puma(reading)
    answer = solve_per_joint(problem, slacks=(5e-4, 1e-6))
    own = [solve(problem.joint(j)) for j in range(6)]
    assert answer.status is Status.CONVERGED
    assert answer.durations == pytest.approx(np.max([s.durations for s in own], axis=0))
    wide, narrow = answer.ranges
    assert wide.lowest <= narrow.lowest <= answer.total_time <= narrow.highest <= wide.highest
    assert answer.total_time >= solve(problem).total_time


def test_the_range_contains_what_random_near_optima_give() -> None:
    """Sampled near-optimal vectors, found without the optimiser, lie inside the range."""
    from trajgap.problem import evaluate

    problem = puma("durations-at-least-0.3")
    slack = 5e-4
    answer = solve_per_joint(problem, slacks=(slack,))
    rng = np.random.default_rng(7)
    near = []
    for j, s in enumerate(answer.joints):
        single = problem.joint(j)
        step = rng.normal(scale=0.02, size=(40000, 3)) * rng.uniform(0, 1, (40000, 1))
        h = np.maximum(s.durations + step, 0.3)
        h = h * np.maximum(1.0, evaluate(single, h).stretch)[:, None]
        near.append(h[h.sum(axis=1) <= s.total_time + slack])
        assert len(near[-1]) > 20
    picks = [h[rng.integers(len(h), size=4000)] for h in near]
    totals = np.max(picks, axis=0).sum(axis=1)
    assert answer.ranges[0].lowest <= totals.min()
    assert totals.max() <= answer.ranges[0].highest


def test_a_curve_with_free_derivatives_has_joint_optima_but_no_longest_motion() -> None:
    q = np.array([[0.2, -1.0], [0.9, 0.3], [0.4, 1.1], [1.3, 0.6]])
    answer = solve_per_joint(Problem(q, Limits(1.5, 4.0, joints=2), piecewise((5, 5, 5), 2)))
    assert answer.durations is None
    assert all(s.durations is not None for s in answer.joints)
    assert "leaves 4 derivatives of each joint free" in answer.why


def test_a_joint_without_answer_leaves_the_procedure_without_one() -> None:
    q = np.array([[0.0, 0.0], [1.0, 1.0]])
    answer = solve_per_joint(Problem(q, Limits([1.0, 0.0], 2.0), rest_to_rest(1, 5)))
    assert answer.status is Status.INFEASIBLE
    assert answer.durations is None
    assert "joint 2" in answer.why
    assert "joint 2" in str(answer)


def test_the_longest_of_searches_that_did_not_converge_is_not_called_best_known() -> None:
    problem = puma("durations-at-least-0.3")
    with stopping_after(0.0):
        stopped = solve_per_joint(problem)
    assert {s.evidence for s in stopped.joints} == {Evidence.UNCONVERGED}
    assert stopped.durations is not None
    assert stopped.evidence is Evidence.UNCONVERGED
    assert solve_per_joint(problem).evidence is Evidence.BEST_KNOWN


SAME = 1e-7
"""Relative to the total: how much longer a range by IPOPT may be, whose limits are kept to 1e-10
and whose last pass moves by 1e-8 at most."""


def joints_and_optima(family: str, seed: int) -> tuple[list[Problem], list[Array]]:
    """Up to two joints of a random problem, each with its own optimum; none if one has none."""
    problem = small_problem(family, seed)
    singles = [problem.joint(j) for j in range(min(2, len(problem.joints)))]
    answers = [solve(single) for single in singles]
    if not all(one.status is Status.CONVERGED for one in answers):
        return [], []
    return singles, [one.durations for one in answers if one.durations is not None]


def compare(family: str, seed: int, slack: float) -> int:
    """Compare both ways for some objectives; how many of them the Newton steps settled."""
    singles, optima = joints_and_optima(family, seed)
    if not singles or not applies(singles):
        return 0
    caps = [h.sum() * (1.0 + slack) for h in optima]
    n, settled = singles[0].segments, 0
    asked: list[tuple[int, Array | None]] = [(len(singles), None)]
    asked += [(1, -np.eye(n)[k]) for k in range(n)]
    asked += [(1, np.eye(n)[0] - 1.0)]
    for count, weights in asked:
        given = singles[:count], optima[:count], caps[:count], weights
        found = reached(*given)
        if found is None:
            continue
        settled += 1
        for one, h, cap in zip(singles, found, caps, strict=False):
            assert check(one, h).stretch <= 1.0 + 1e-9
            assert h.sum() <= cap * (1.0 + 1e-9)
            assert (h >= one.duration_lower * (1.0 - 1e-12)).all()
        other = [
            near_optimal._kept(one, h)
            for one, h in zip(singles, near_optimal._improve(*given), strict=False)
        ]
        if all(h.sum() <= cap * (1.0 + 1e-8) for h, cap in zip(other, caps, strict=False)):
            mine, theirs = (
                float(np.max(hs, axis=0).sum() if weights is None else weights @ hs[0])
                for hs in (found, other)
            )
            assert mine <= theirs + SAME * caps[0], (family, seed, weights)
    return settled


@pytest.mark.parametrize("family", FAMILIES)
def test_ranges_reach_as_far_as_those_of_ipopt(family: str) -> None:
    assert sum(compare(family, seed, slack) for seed, slack in ((0, 1e-3), (1, 1e-6))) >= 4


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_ranges_of_many_problems_reach_as_far(family: str) -> None:
    assert (
        sum(compare(family, seed, slack) for seed in range(20, 32) for slack in (1e-3, 1e-6)) > 50
    )


def test_a_range_that_is_known_in_closed_form() -> None:
    # Rest to rest, h_k ≥ its own least duration and nothing else: what the slack leaves goes to
    # any one segment, or is shared.
    q = np.array([[0.3], [1.1], [0.4], [2.0]])
    problem = Problem(q, Limits(2.0, 3.0, joints=1), rest_to_rest(3, 5))
    least = solve(problem).durations
    cap = float(least.sum()) + 0.01
    for k in range(3):
        found = reached([problem], [least], [cap], -np.eye(3)[k])
        assert found[0] == pytest.approx(least + 0.01 * np.eye(3)[k], abs=1e-9)


def test_bounds_of_durations_hold() -> None:
    problem = Problem(
        np.array([[0.3], [1.1], [0.4]]), Limits(2.0, 3.0, joints=1), rest_to_rest(2, 5)
    )
    least = solve(problem).durations
    bounded = replace(problem, duration_upper=least + np.array([0.004, 1.0]))
    found = reached([bounded], [least], [float(least.sum()) + 0.01], np.array([-1.0, 0.0]))
    assert found[0][0] == pytest.approx(least[0] + 0.004, abs=1e-9)


def test_what_does_not_settle_goes_to_ipopt(monkeypatch: pytest.MonkeyPatch) -> None:
    singles, optima = joints_and_optima("3-5-3", 0)
    both = near_optimal.longest_per_segment_range(singles, optima, 1e-3)
    asked = []
    monkeypatch.setattr(near_newton, "STEPS", 1)
    improve = near_optimal._improve
    monkeypatch.setattr(near_optimal, "_improve", lambda *a: asked.append(a) or improve(*a))
    again = near_optimal.longest_per_segment_range(singles, optima, 1e-3)
    assert asked
    assert again == pytest.approx(both, rel=1e-6)


def test_a_curve_with_a_moving_end_is_left_to_ipopt() -> None:
    problem = Problem([[0.0], [1.0]], Limits(2.0), piecewise((3,), ends=((1, 0.5),)))
    assert not applies([problem])
