import numpy as np
import pytest
from trajgap.nlp import Evidence, Status, solve, solve_per_joint
from trajgap.nlp.optimum import stopping_after
from trajgap.problem import Limits, Problem, load_case, piecewise, rest_to_rest


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
