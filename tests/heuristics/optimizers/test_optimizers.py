"""Optimisers by name: each under one objective and budget, and what it must not do."""

import sys
import threading
import time
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize
from support import optimizers
from support.refusals import Refusal, each_refusal
from support.two_joints import OPEN, PROBLEM, two_joints
from trajgap.heuristics import (
    KINDS,
    PSO,
    Borrowed,
    Bounds,
    DeathPenalty,
    evaluations_of,
    find_optimizer,
    optimizer_name,
    run,
    run_within,
    search_box,
    uniform_rescaling,
)
from trajgap.heuristics.budget import Budgeted, BudgetSpent
from trajgap.heuristics.time_limit import TimeSpent, time_limit
from trajgap.problem import Limits, TrajgapError, Verdict, check

LIBRARIES = (
    "mealpy:OriginalWOA", "mealpy:OriginalPSO", "pymoo:DE", "pymoo:NelderMead", "pygmo:sade",
    "pygmo:cmaes", "pygmo:compass_search", "cma",
)  # fmt: skip
OURS = (
    *KINDS, "random", "rescale", "multistart", "scipy:differential_evolution",
    "scipy:dual_annealing", "scipy:shgo", "scipy:direct", "scipy:basinhopping",
)  # fmt: skip


def generator(seed: int, *stream: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=stream)))


@pytest.mark.filterwarnings("ignore")  # libraries' own
@pytest.mark.parametrize("name", [*OURS, *LIBRARIES])
def test_each_within_its_budget(name: str) -> None:
    package = name.partition(":")[0]
    if package in ("mealpy", "pymoo", "pygmo", "cma"):
        pytest.importorskip(package)
    budget = 700
    found = run_within(find_optimizer(name, budget), PROBLEM, 5, budget, "stretch", seconds=100)
    again = run_within(find_optimizer(name, budget), PROBLEM, 5, budget, "stretch", seconds=100)
    assert found.evaluations <= budget
    assert (found.totals[1:] <= found.totals[:-1]).all()
    assert found.reported_time == found.totals[-1]
    assert found.durations.sum() == pytest.approx(found.reported_time, rel=1e-12)
    assert check(PROBLEM, found.durations).verdict is Verdict.PASS
    assert found.totals.tobytes() == again.totals.tobytes()
    assert found.durations.tobytes() == again.durations.tobytes()


def test_scipy_by_name_is_scipy_called_directly() -> None:
    judge = DeathPenalty(PROBLEM, 1e6)
    theirs = optimize.differential_evolution(
        lambda x: float(judge(x[None])[0]), [(0.1, 3.0)] * 3, maxiter=7, seed=generator(11, 4),
        polish=False,
    )  # fmt: skip
    method = find_optimizer("scipy:differential_evolution", 6000, maxiter=7, polish=False)
    ours = run_within(method, PROBLEM, 11, 6000, stream=(4,))
    assert ours.evaluations == theirs.nfev
    assert ours.reported_time == theirs.fun
    assert ours.durations.tobytes() == theirs.x.tobytes()


def test_an_algorithm_is_the_one_that_run_runs() -> None:
    ours = run_within(find_optimizer("pso", 930), PROBLEM, 3, 930)
    theirs = run(PSO(iterations=30), PROBLEM, 3)
    assert ours.evaluations == theirs.evaluations == 930
    assert ours.durations.tobytes() == theirs.durations.tobytes()
    assert ours.totals[29::30].tolist() == theirs.trace.tolist()


@pytest.mark.parametrize(
    ("kind", "budget", "iterations"),
    [("pso", 6000, 199), ("pso", 6029, 199), ("mnam-pso", 6000, 192), ("ga", 6000, 149),
     ("pso", 10, 0)],
)  # fmt: skip
def test_iterations_use_up_the_budget(kind: str, budget: int, iterations: int) -> None:
    method = find_optimizer(kind, budget)
    assert method.iterations == iterations
    assert run_within(method, PROBLEM, 0, budget).evaluations <= budget
    assert find_optimizer(kind, budget, iterations=4).iterations == 4


@pytest.mark.parametrize(
    ("kind", "iterations"),
    [("mnam-pso", 200), ("pso", 200), ("constrained-pso", 100), ("woa", 500), ("ga", 200)],
)
def test_without_a_budget_an_algorithm_makes_its_own_iterations(kind: str, iterations: int) -> None:
    method = find_optimizer(kind)
    assert method.iterations == iterations
    needed = evaluations_of(method)
    assert find_optimizer(kind, needed).iterations == iterations
    assert run_within(method, PROBLEM, 0, needed).evaluations == needed
    assert evaluations_of(find_optimizer("random")) == 6000


def test_one_shared_duration_is_uniform_rescaling() -> None:
    for handling in ("death-penalty", "stretch", "rescale"):
        found = run_within(find_optimizer("rescale", 200), PROBLEM, 0, 200, handling)
        assert found.durations == pytest.approx(uniform_rescaling(PROBLEM), rel=1e-9)


@each_refusal("optimizers")
def test_what_cannot_be_called_is_refused_before_it_runs(one: Refusal) -> None:
    package = one.name.partition(":")[0]
    if package in ("mealpy", "pymoo", "pygmo"):
        pytest.importorskip(package)
    with pytest.raises(TrajgapError) as caught:
        find_optimizer(one.name, 90, **tomllib.loads(one.new))
    assert one.is_said(str(caught.value))


def test_what_has_no_signature_or_takes_anything_is_left_to_itself() -> None:
    assert find_optimizer("support.optimizers:anything", 90, whatever=3).iterations == 89
    assert find_optimizer(dict, 90, whatever=3).iterations == 89
    for word in ("seed", "rng"):  # scipy takes both, and its signature names one
        assert find_optimizer("scipy:differential_evolution", 90, **{word: 1}).iterations == 89


def test_a_function_by_itself_and_by_its_name() -> None:
    given = run_within(find_optimizer(optimizers.fair, 90, members=9), PROBLEM, 2, 90)
    named = run_within(find_optimizer("support.optimizers:fair", 90, members=9), PROBLEM, 2, 90)
    assert given.totals.tobytes() == named.totals.tobytes()
    assert given.evaluations == 90
    with pytest.raises(TrajgapError, match=r"optimizers:fair: membres: unknown"):
        find_optimizer(optimizers.fair, 90, membres=9)
    drawn = generator(2).uniform(0.1, 3.0, (9, 3))
    assert given.totals[8] == np.min(DeathPenalty(PROBLEM, np.inf)(drawn))


def test_a_function_of_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine_here.py").write_text("def f(fun, bounds, budget, rng): fun(bounds[:, 1])\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [p for p in sys.path if p])
    found = run_within(find_optimizer("mine_here:f", 5), PROBLEM, 0, 5)
    assert found.durations.tolist() == [3.0, 3.0, 3.0]


@pytest.mark.parametrize(("function", "said"), optimizers.FAULTS.items())
def test_each_fault_has_its_message(function: object, said: str) -> None:
    with pytest.raises((TrajgapError, ZeroDivisionError), match=said):
        run_within(find_optimizer(function, 40), PROBLEM, 0, 40)


@pytest.mark.parametrize("function", [optimizers.sleeps, optimizers.spins])
def test_what_hangs_is_interrupted(function: object) -> None:
    began = time.monotonic()
    with pytest.raises(TrajgapError, match=r"took longer than 0.2 s; raise the time limit"):
        run_within(find_optimizer(function, 40), PROBLEM, 0, 40, seconds=0.2)
    assert time.monotonic() - began < 20


def test_what_hangs_in_another_thread_is_interrupted() -> None:
    caught: list[BaseException] = []

    def work() -> None:
        try:
            with time_limit(0.1):
                while True:
                    pass
        except BaseException as error:
            caught.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(60)
    assert [type(error) for error in caught] == [TimeSpent]


def test_what_ends_in_time_is_left_alone() -> None:
    with time_limit(0.05):
        pass
    time.sleep(0.1)  # an alarm that was not taken back would end this test


@pytest.mark.parametrize("name", ["mealpy:OriginalWOA", "pymoo:DE", "pygmo:sade", "cma"])
def test_a_missing_package_has_its_install_line(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    package = name.partition(":")[0]
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(TrajgapError, match=f"install it with `python -m pip install {package}`"):
        find_optimizer(name)


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("PSO", "pso"),
        ("MNAM_pso", "mnam-pso"),
        ("improvedGA", "improved-ga"),
        ("CMA", "cma"),
        ("Scipy:Differential-Evolution", "scipy:differential_evolution"),
        ("mealpy:OriginalWOA", "mealpy:OriginalWOA"),
        ("mine:PSO", "mine:PSO"),
        ("PSOO", "PSOO"),
    ],
)
def test_case_and_hyphens_of_a_name_do_not_matter(written: str, name: str) -> None:
    assert optimizer_name(written) == name


def test_a_name_in_any_case_names_the_optimiser_and_the_nearest_is_offered() -> None:
    assert find_optimizer("PSO") == find_optimizer("pso")
    with pytest.raises(TrajgapError, match="unknown; did you mean 'mnam-pso'"):
        find_optimizer("MNAMPSOO")


def test_the_budget_is_checked() -> None:
    with pytest.raises(TrajgapError, match="budget: expected a whole number of 1 or more"):
        find_optimizer("pso", 0)
    with pytest.raises(TrajgapError, match="budget: expected a whole number of 1 or more"):
        run_within(find_optimizer("pso"), PROBLEM, 0, 0)


def test_a_box_is_found_where_none_is_stated() -> None:
    box = search_box(OPEN)
    total = uniform_rescaling(OPEN).sum()
    assert (total <= box.upper).all()
    assert (box.upper <= 1.01 * total).all()
    found = run_within(find_optimizer("random", 100), OPEN, 0, 100)
    assert found.evaluations == 100
    assert search_box(PROBLEM).upper.tolist() == [3.0, 3.0, 3.0]


def test_the_box_bounds_where_is_searched_not_what_is_admissible() -> None:
    # A tiny duration stretches the others far beyond the box; that is a long motion, not none.
    box = search_box(OPEN)
    corner = np.array([1e-3, *box.upper[1:]])

    def tiny(fun: object, bounds: object, budget: int, rng: object) -> None:
        fun(corner)  # type: ignore[operator]

    tiny.__qualname__ = "tiny"
    found = run_within(find_optimizer(tiny, 1), OPEN, 0, 1, "stretch")
    assert found.durations.max() > box.upper.max()
    assert check(OPEN, found.durations).verdict is Verdict.PASS


def test_a_problem_whose_box_cannot_be_found() -> None:
    unlimited = two_joints(Limits(joints=2))
    with pytest.raises(TrajgapError, match="have no upper bound and none can be derived"):
        search_box(unlimited)
    bounds = Bounds(np.zeros(3), np.full(3, np.inf))
    with pytest.raises(TrajgapError, match="random: needs finite duration bounds"):
        find_optimizer("random", 10).search(bounds, generator(0), lambda x: x.sum(axis=1))


def drawing(fun, bounds, budget, rng):
    """Random search in batches of seven, for ever."""
    while True:
        fun(rng.uniform(*bounds.T, (7, len(bounds))))


def test_a_function_is_run_in_blocks_of_evaluations() -> None:
    search = replace(find_optimizer(drawing), iterations=9, per_iteration=10)
    found = run(search, PROBLEM, 2)
    rng = np.random.Generator(np.random.PCG64(2))
    x = np.concatenate([rng.uniform(0.1, 3.0, (7, 3)) for _ in range(15)])[:100]
    totals = np.minimum.accumulate(DeathPenalty(PROBLEM)(x))
    np.testing.assert_array_equal(found.trace, totals[9::10])
    assert found.evaluations == 100
    assert (found.iterations, found.settings) == (9, search)


def test_a_search_that_ends_early_keeps_what_it_has() -> None:
    def twice(fun, bounds, budget, rng):
        fun(np.full((5, 3), 2.9))
        fun(np.full((5, 3), 2.0))

    search = replace(find_optimizer(twice), iterations=4, per_iteration=4)
    found = run(search, PROBLEM, 0)
    np.testing.assert_allclose(found.trace, [8.7, 6.0, 6.0, 6.0, 6.0])
    assert found.evaluations == 10


def test_an_answer_is_the_first_of_equally_good_ones() -> None:
    rows = np.array([[2.0, 1.5, 2.5], [2.5, 1.5, 2.0], [2.9, 2.9, 2.9]])
    found = run(find_optimizer(lambda fun, *_: str(fun(rows))), PROBLEM, 0)
    np.testing.assert_array_equal(found.durations, rows[0])


def test_a_search_cannot_swallow_the_end_of_its_budget() -> None:
    def stubborn(fun, bounds, budget, rng):
        while True:
            try:
                drawing(fun, bounds, budget, rng)
            except Exception:
                continue

    assert run(find_optimizer(stubborn, 120), PROBLEM, 0).evaluations == 120


def test_without_an_upper_bound_a_search_looks_in_the_box_that_is_found() -> None:
    seen = []

    def look(fun, bounds, budget, rng):
        seen.append(bounds)
        fun(bounds.T)

    found = run(find_optimizer(look), OPEN, 0)
    box = search_box(OPEN)
    np.testing.assert_array_equal(seen[0], np.stack([box.lower, box.upper], axis=1))
    np.testing.assert_array_equal(found.durations, box.upper)


def given(**changes: object) -> Borrowed:
    return Borrowed(**{"kind": "x", "searching": lambda task: None, **changes})


REFUSED = [
    (lambda: given(iterations=-1), "^x: iterations: expected a whole number of 0 or more, got -1"),
    (lambda: given(per_iteration=0), "^x: per_iteration: expected a whole number of 1 or more, g"),
    (lambda: given(penalty=0), "^x: penalty: expected a positive number, got 0"),
    (lambda: run(given(), PROBLEM, 0), "^x: evaluated no position; call the objective"),
    *(
        (lambda s=s: Budgeted(len, 3, 9)(np.ones(s)), r"^objective: .* \(batch, 3\).* as x\[None\]")
        for s in ((3,), (2, 4), (1, 2, 3))
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
