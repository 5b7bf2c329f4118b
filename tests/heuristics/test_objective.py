"""The death penalty: judged by dense sampling, by scaling, and at every edge of its domain."""

import numpy as np
import pytest
from trajgap.heuristics import (
    PSO,
    Bounds,
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
    fit,
    piecewise,
    three_five_three,
)
from trajgap.problem.checker import TOLERANCE

WAYPOINTS = np.array([[0.19, -1.63], [0.82, -2.01], [0.13, -1.07], [-0.88, -1.31]])
LIMITS = Limits([5.0, 3.0], [8.0, 11.0], [np.inf, 90.0])


def problem_with(**changes: object) -> Problem:
    given = {
        "waypoints": WAYPOINTS,
        "limits": LIMITS,
        "curve": three_five_three(),
        "duration_lower": [0.2, 0.3, 0.1],
        "duration_upper": [2.0, 3.0, 2.5],
    }
    return Problem(**{**given, **changes})


def sampled_ratio(problem: Problem, durations: np.ndarray) -> float:
    """Largest |derivative|/limit at 4,000 points: what an author's program would look at."""
    curve = fit(problem.curve, problem.waypoints, durations)
    worst = 0.0
    t = np.linspace(0.0, durations.sum(), 4000)
    for j in range(len(problem.joints)):
        for order in (1, 2, 3):
            limit = problem.limits.derivatives[j, order - 1]
            if np.isfinite(limit):
                worst = max(worst, float(np.abs(curve(t, order)[:, j]).max()) / limit)
    return worst


def test_agrees_with_dense_sampling() -> None:
    problem = problem_with()
    rng = np.random.default_rng(5)
    batch = rng.uniform(0.35, 1.9, (300, 3))
    fitness = DeathPenalty(problem)(batch)
    worst = np.array([sampled_ratio(problem, h) for h in batch])
    clear = abs(worst - 1) > 2e-3
    assert 30 < np.isfinite(fitness).sum() < 270
    np.testing.assert_array_equal(np.isfinite(fitness)[clear], (worst <= 1)[clear])
    kept = np.isfinite(fitness)
    np.testing.assert_allclose(fitness[kept], batch[kept] @ np.ones(3), rtol=1e-15)


def test_stretch_to_the_limit_is_the_edge() -> None:
    problem = problem_with()
    h = np.array([[0.9, 1.2, 0.7]])
    tight = h * evaluate(problem, h).stretch[0]
    objective = DeathPenalty(problem)
    assert objective(tight)[0] == tight.sum()
    assert objective(tight * (1 - 1e-8))[0] == np.inf


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


def test_bounds_of_a_problem() -> None:
    bounds = Bounds.of(problem_with())
    np.testing.assert_array_equal(bounds.lower, [0.2, 0.3, 0.1])
    np.testing.assert_array_equal(bounds.upper, [2.0, 3.0, 2.5])


def test_counts_every_position() -> None:
    counted = Counted(DeathPenalty(problem_with()))
    counted(np.full((7, 3), 1.5))
    counted(np.full((2, 3), -1.0))
    assert counted.evaluations == 9


@pytest.mark.parametrize("penalty", [0.0, -1.0, np.nan])
def test_penalty_must_be_positive(penalty: float) -> None:
    with pytest.raises(TrajgapError, match=r"penalty: must be positive, got .*inf is allowed"):
        DeathPenalty(problem_with(), penalty)


def test_penalty_must_exceed_every_admissible_total() -> None:
    with pytest.raises(TrajgapError, match=r"penalty: 7.5 does not exceed .* of 7.5 s; raise it"):
        DeathPenalty(problem_with(), 7.5)
    DeathPenalty(problem_with(), 7.6)


def test_free_derivatives_are_not_searched() -> None:
    free = piecewise((5, 5, 5), 2, ((1, 0.0), (2, 0.0)))
    with pytest.raises(TrajgapError, match=r"leaves 4 derivatives per joint free.*prescribe them"):
        DeathPenalty(problem_with(curve=free))


def test_other_interpolants() -> None:
    problem = Problem(np.array([[0.2], [1.0], [0.7], [1.9], [1.1]]), Limits(2.0), cubic_spline(4))
    fitness = DeathPenalty(problem)(np.array([[1.0, 1.0, 1.0, 1.0], [0.2, 0.2, 0.2, 0.2]]))
    np.testing.assert_array_equal(fitness, [4.0, np.inf])


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
