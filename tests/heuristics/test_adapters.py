"""Searches that own their loop: same objective, same account, same budget."""

import numpy as np
import pytest
from scipy import optimize
from support.two_joints import OPEN, PROBLEM
from trajgap.heuristics import (
    DeathPenalty,
    External,
    differential_evolution,
    dual_annealing,
    one_by_one,
    run,
    shgo,
)
from trajgap.heuristics.budget import Budgeted, BudgetSpent
from trajgap.problem import TrajgapError

SCIPY = (differential_evolution(), dual_annealing(iterations=40), shgo())
each_scipy = pytest.mark.parametrize("search", SCIPY, ids=lambda s: s.kind)


def drawing(objective, bounds, rng):
    """Random search in batches of seven, for ever."""
    while True:
        objective(rng.uniform(bounds.lower, bounds.upper, (7, bounds.lower.size)))


def test_differential_evolution_is_scipys() -> None:
    """The same generator and objective, handed to scipy directly, give the same bits."""
    found = run(differential_evolution(maxiter=20, polish=False), PROBLEM, 5)
    judged = []

    def objective(x: np.ndarray) -> np.ndarray:
        judged.append(x.shape[1])
        return DeathPenalty(PROBLEM, 1e6)(x.T)

    rng = np.random.Generator(np.random.PCG64(5))
    result = optimize.differential_evolution(
        objective, [(0.1, 3.0)] * 3, rng=rng, maxiter=20, polish=False, vectorized=True,
        updating="deferred",
    )  # fmt: skip
    assert found.evaluations == sum(judged)
    np.testing.assert_array_equal(found.durations, result.x)
    assert found.reported_time == result.fun


def test_any_callable_and_its_budget() -> None:
    search = External("random", drawing, iterations=9, per_iteration=10)
    found = run(search, PROBLEM, 2)
    rng = np.random.Generator(np.random.PCG64(2))
    x = np.concatenate([rng.uniform(0.1, 3.0, (7, 3)) for _ in range(15)])[:100]
    totals = np.minimum.accumulate(DeathPenalty(PROBLEM)(x))
    np.testing.assert_array_equal(found.trace, totals[9::10])
    assert found.evaluations == 100
    assert (found.iterations, found.settings) == (9, search)


def test_a_search_that_ends_early_keeps_what_it_has() -> None:
    def twice(objective, bounds, rng):
        objective(np.full((5, 3), 2.9))
        objective(np.full((5, 3), 2.0))

    found = run(External("twice", twice, iterations=4, per_iteration=4), PROBLEM, 0)
    np.testing.assert_allclose(found.trace, [8.7, 6.0, 6.0, 6.0, 6.0])
    assert found.evaluations == 10


def test_an_answer_is_the_first_of_equally_good_ones() -> None:
    rows = np.array([[2.0, 1.5, 2.5], [2.5, 1.5, 2.0], [2.9, 2.9, 2.9]])
    found = run(External("three", lambda objective, *_: objective(rows)), PROBLEM, 0)
    np.testing.assert_array_equal(found.durations, rows[0])


def test_a_search_cannot_swallow_the_end_of_its_budget() -> None:
    def stubborn(objective, bounds, rng):
        while True:
            try:
                drawing(objective, bounds, rng)
            except Exception:
                continue

    assert run(External("stubborn", stubborn, iterations=3), PROBLEM, 0).evaluations == 120


def test_one_by_one() -> None:
    single = one_by_one(lambda x: x.sum(axis=1))
    assert single(np.array([1.0, 2.5])) == 3.5
    assert isinstance(single(np.array([1.0])), float)


@each_scipy
def test_infinite_bounds(search: External) -> None:
    with pytest.raises(TrajgapError, match=rf"^{search.kind}: needs finite duration bounds; give"):
        run(search, OPEN, 0)


def test_a_range_of_its_own() -> None:
    found = run(differential_evolution(position_range=(0.2, 4.0)), OPEN, 0)
    assert ((found.durations >= 0.2) & (found.durations <= 4.0)).all()
    seen = []
    search = External("look", lambda o, bounds, r: seen.append(bounds) or o(np.ones((1, 3))))
    run(External("look", search.searching, position_range=(0.05, 1.0)), PROBLEM, 0)
    np.testing.assert_array_equal([seen[0].lower, seen[0].upper], [[0.1] * 3, [1.0] * 3])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"iterations": -1}, "^x: iterations: expected a whole number of 0 or more, got -1"),
        ({"per_iteration": 0}, "^x: per_iteration: expected a whole number of 1 or more, got 0"),
        ({"penalty": 0}, "^x: penalty: expected a positive number, got 0"),
        ({"position_range": (2.0, 1.0)}, "^x: position_range: give two numbers, the smaller"),
        ({"searching": 3}, "^x: searching: expected a callable"),
    ],
)
def test_settings_out_of_range(changes: dict[str, object], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        External(**{"kind": "x", "searching": drawing, **changes})


def test_range_beside_the_bounds() -> None:
    search = External("x", drawing, position_range=(4.0, 5.0))
    with pytest.raises(TrajgapError, match=r"^x: position_range: lies outside the duration"):
        run(search, PROBLEM, 0)


@pytest.mark.parametrize("name", ["rng", "seed", "workers"])
def test_what_the_run_sets_itself(name: str) -> None:
    message = f"^differential-evolution: {name}: is set by the run; leave it out"
    with pytest.raises(TrajgapError, match=message):
        differential_evolution(**{name: 1})


def test_nothing_judged() -> None:
    with pytest.raises(TrajgapError, match=r"^idle: judged no position; call the objective"):
        run(External("idle", lambda *_: None), PROBLEM, 0)


@pytest.mark.parametrize("shape", [(3,), (2, 4), (1, 2, 3)])
def test_positions_come_in_batches(shape: tuple[int, ...]) -> None:
    search = External("x", lambda objective, *_: objective(np.ones(shape)))
    with pytest.raises(TrajgapError, match=r"^objective: expected .* \(batch, 3\).* as x\[None\]"):
        run(search, PROBLEM, 0)


def test_a_spent_budget_judges_nothing_more() -> None:
    calls = []

    def objective(x: np.ndarray) -> np.ndarray:
        calls.append(len(x))
        return x[:, 0]

    budgeted = Budgeted(objective, 1, 3)
    np.testing.assert_array_equal(budgeted(np.array([[5.0], [4.0]])), [5.0, 4.0])
    for _ in range(2):
        with pytest.raises(BudgetSpent):
            budgeted(np.array([[3.0], [2.0]]))
    assert calls == [2, 1]
    assert budgeted.totals.tolist() == [5.0, 4.0, 3.0]
    np.testing.assert_array_equal(budgeted.best, [3.0])
