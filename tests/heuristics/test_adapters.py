"""Searches that own their loop: same objective, same account, same budget."""

from collections.abc import Callable

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


def test_a_range_of_its_own() -> None:
    found = run(differential_evolution(position_range=(0.2, 4.0)), OPEN, 0)
    assert ((found.durations >= 0.2) & (found.durations <= 4.0)).all()
    seen = []
    search = External("look", lambda o, bounds, r: seen.append(bounds) or o(np.ones((1, 3))))
    run(External("look", search.searching, position_range=(0.05, 1.0)), PROBLEM, 0)
    np.testing.assert_array_equal([seen[0].lower, seen[0].upper], [[0.1] * 3, [1.0] * 3])


def given(**changes: object) -> External:
    return External(**{"kind": "x", "searching": drawing, **changes})


def asking(shape: tuple[int, ...]) -> External:
    return given(searching=lambda objective, *_: objective(np.ones(shape)))


REFUSED = [
    (lambda: given(iterations=-1), "^x: iterations: expected a whole number of 0 or more, got -1"),
    (lambda: given(per_iteration=0), "^x: per_iteration: expected a whole number of 1 or more, g"),
    (lambda: given(penalty=0), "^x: penalty: expected a positive number, got 0"),
    (lambda: given(position_range=(2.0, 1.0)), "^x: position_range: give two numbers, the smaller"),
    (lambda: given(searching=3), "^x: searching: expected a callable"),
    (
        lambda: run(given(position_range=(4.0, 5.0)), PROBLEM, 0),
        "^x: position_range: lies outside the duration",
    ),
    *(
        (lambda s=s: run(s, OPEN, 0), f"^{s.kind}: needs finite duration bounds; give")
        for s in SCIPY
    ),
    *(
        (
            lambda name=name: differential_evolution(**{name: 1}),
            f"^diff.*: {name}: is set by the run",
        )
        for name in ("rng", "seed", "workers")
    ),
    (
        lambda: run(given(searching=lambda *_: None), PROBLEM, 0),
        "^x: judged no position; call the objective",
    ),
    *(
        (lambda s=shape: run(asking(s), PROBLEM, 0), r"^objective: .* \(batch, 3\).* as x\[None\]")
        for shape in ((3,), (2, 4), (1, 2, 3))
    ),
]


@pytest.mark.parametrize(("call", "message"), REFUSED)
def test_what_cannot_be_searched_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        call()


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
