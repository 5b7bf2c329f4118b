"""The death penalty: judged by dense sampling, by scaling, and at every edge of its domain."""

import numpy as np
import pytest
from support.two_joints import WITH_JERK, two_joints
from trajgap.heuristics import (
    PSO,
    Counted,
    DeathPenalty,
    Stretch,
    run,
    run_per_joint,
    uniform_rescaling,
)
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    check,
    cubic_spline,
    evaluate,
    piecewise,
    three_five_three,
)
from trajgap.problem.checker import TOLERANCE


def problem_with(**changes: object) -> Problem:
    bounds = {"duration_lower": [0.2, 0.3, 0.1], "duration_upper": [2.0, 3.0, 2.5]}
    return two_joints(**{"limits": WITH_JERK, **bounds, **changes})


def test_an_answer_at_the_edge_of_the_tolerance_passes_the_checker() -> None:
    problem = problem_with(limits=Limits(5.0, 8.0, joints=2))
    h = np.array([[0.9, 1.2, 0.7]])
    tight = h * evaluate(problem, h).stretch[0]
    # Acceleration scales with the inverse square: half of the tolerance is a quarter in time.
    at_edge = tight * (1 - TOLERANCE / 4 * (1 - 1e-4))
    assert np.isfinite(DeathPenalty(problem)(at_edge)[0])
    assert check(problem, at_edge[0]).verdict == "pass"
    assert DeathPenalty(problem)(tight * (1 - TOLERANCE))[0] == np.inf


@pytest.mark.parametrize(
    "durations",
    [
        [0.19, 1.5, 1.5],
        [1.5, 0.29, 1.5],
        [1.5, 1.5, 2.51],
        [0.0, 1.5, 1.5],
        [-1.5, 1.5, 1.5],
        [np.nan, 1.5, 1.5],
        [1.5, np.inf, 1.5],
        [1.5, 1.5, -np.inf],
    ],
)
@pytest.mark.parametrize("penalty", [np.inf, 1e6])
def test_outside_the_bounds_is_infeasible(durations: list[float], penalty: float) -> None:
    fitness = DeathPenalty(problem_with(), penalty)(np.array([durations, [1.9, 1.9, 1.9]]))
    np.testing.assert_array_equal(fitness, [penalty, 1.9 + 1.9 + 1.9])


def test_bounds_themselves_are_feasible() -> None:
    problem = problem_with(duration_lower=[1.5, 1.5, 1.5], duration_upper=[1.5, 2.0, 2.5])
    batch = np.array([[1.5, 1.5, 1.5], [1.5, 2.0, 2.5]])
    np.testing.assert_array_equal(DeathPenalty(problem)(batch), [4.5, 6.0])


def test_a_lower_bound_of_zero_excludes_zero() -> None:
    still = Problem(np.zeros((4, 1)), Limits(1.0), three_five_three())
    batch = np.array([[0.0, 1.0, 1.0], [1e-3, 1.0, 1.0]])
    np.testing.assert_array_equal(DeathPenalty(still)(batch), [np.inf, 2.001])


def test_a_batch_is_its_members() -> None:
    objective = DeathPenalty(problem_with())
    batch = np.random.default_rng(8).uniform(-0.2, 2.2, (40, 3))
    alone = np.array([objective(row[None])[0] for row in batch])
    np.testing.assert_array_equal(objective(batch), alone)
    assert 0 < np.isfinite(alone).sum() < 40


def test_counts_every_position() -> None:
    counted = Counted(DeathPenalty(problem_with()))
    counted(np.full((7, 3), 1.5))
    counted(np.full((2, 3), -1.0))
    assert counted.evaluations == 9


@pytest.mark.parametrize("judge", [DeathPenalty, Stretch])
@pytest.mark.parametrize(
    ("penalty", "said"),
    [
        (0.0, r"penalty: must be positive, got .*inf is allowed"),
        (-1.0, r"penalty: must be positive, got .*inf is allowed"),
        (np.nan, r"penalty: must be positive, got .*inf is allowed"),
        (7.5, r"penalty: 7.5 does not exceed .* of 7.5 s; raise it"),
    ],
)
def test_a_penalty_is_above_every_admissible_total(judge: type, penalty: float, said: str) -> None:
    with pytest.raises(TrajgapError, match=said):
        judge(problem_with(), penalty)
    judge(problem_with(), 7.6)
    free = piecewise((5, 5, 5), 2, ((1, 0.0), (2, 0.0)))
    with pytest.raises(TrajgapError, match=r"leaves 4 derivatives per joint free.*prescribe them"):
        judge(problem_with(curve=free))


@pytest.mark.parametrize(("values", "shape"), [([1.0], r"\(1,\)"), ([[1.0], [2.0]], r"\(2, 1\)")])
def test_objective_must_return_one_value_each(values: list[object], shape: str) -> None:
    counted = Counted(lambda _: np.array(values))
    with pytest.raises(TrajgapError, match=rf"expected 2 values .* got shape {shape}"):
        counted(np.ones((2, 3)))


def test_objective_must_not_return_nan() -> None:
    counted = Counted(lambda _: np.array([1.0, np.nan]))
    with pytest.raises(TrajgapError, match="returned NaN; return inf for what is infeasible"):
        counted(np.ones((2, 3)))


def test_fixed_ratios_leave_nothing_to_search() -> None:
    problem = Problem([[0.0], [0.5], [1.5]], Limits(1.0), cubic_spline(2), ratios="equal")
    said = "ratios: the durations have fixed ratios, so that the total is the one unknown"
    for refused in (
        lambda: DeathPenalty(problem),
        lambda: Stretch(problem),
        lambda: run(PSO(), problem, seed=1),
        lambda: run_per_joint(PSO(), problem, seed=1),
    ):
        with pytest.raises(TrajgapError, match=said):
            refused()
    with pytest.raises(TrajgapError, match="uniform rescaling: the durations have fixed ratios"):
        uniform_rescaling(problem)
