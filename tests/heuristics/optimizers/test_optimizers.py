"""Optimisers by name: each under one objective and budget, and what it must not do."""

import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import optimize
from support import optimizers
from support.two_joints import OPEN, PROBLEM, two_joints
from trajgap.heuristics import (
    KINDS,
    PSO,
    Bounds,
    DeathPenalty,
    evaluations_of,
    find_optimizer,
    run,
    run_within,
    search_box,
    uniform_rescaling,
)
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


@pytest.mark.parametrize(
    ("name", "settings", "said"),
    [
        ("support.optimizers:fair", {"membres": 9}, "membres: .*; did you mean 'members'"),
        ("support.optimizers:raises", {"step": 1}, "step: unknown setting; it has none"),
        (optimizers.fair, {"membres": 9}, "support.optimizers:fair: membres: unknown setting"),
        ("time:sleep_not", {}, "has no 'sleep_not'"),
        ("support.optimizers:generator_of", {}, "is called with fun, bounds, budget and rng"),
        ("scipy:direct", {"maxitr": 9}, "scipy:direct: maxitr: unknown setting; did you mean"),
        ("pso", {"particls": 3}, "pso: particls: unknown setting"),
        ("psoo", {}, "optimizer 'psoo': unknown; did you mean 'pso'"),
        ("scipy:diferential_evolution", {}, "did you mean 'scipy:differential_evolution'"),
        ("scipy:de", {}, "scipy:de: unknown; did you mean 'scipy:differential_evolution'"),
        ("de", {}, "did you mean 'scipy:differential_evolution'"),
        ("scipy:DA", {}, "did you mean 'scipy:dual_annealing'"),
        ("differential_evolution", {}, "did you mean 'scipy:differential_evolution'"),
        ("dual_anealing", {}, "did you mean 'scipy:dual_annealing'"),
        ("nowhere_at_all:f", {}, "module 'nowhere_at_all' cannot be imported"),
        ("mine.py:f", {}, "mine.py:f: names a file; write mine:f, in the folder that holds mine"),
        ("evolve", {}, "A function of yours is called module:function, such as mine:evolve"),
        ("support.optimizers:g", {}, "module 'support.optimizers' has no 'g'; check its name"),
        ("support.optimizers:FAULTS", {}, "is no function"),
        ("mealpy:OriginalWO", {}, "mealpy:OriginalWO: unknown; did you mean 'mealpy:OriginalWOA'"),
        ("pymoo:DEE", {}, "pymoo:DEE: unknown; did you mean 'pymoo:DE'"),
        ("pygmo:sad", {}, "pygmo:sad: unknown; did you mean 'pygmo:sade'"),
    ],
)
def test_what_cannot_be_called_is_refused_before_it_runs(
    name: Any, settings: dict[str, Any], said: str
) -> None:
    if str(name).partition(":")[0] in ("mealpy", "pymoo", "pygmo"):
        pytest.importorskip(name.partition(":")[0])
    with pytest.raises(TrajgapError, match=said):
        find_optimizer(name, 90, **settings)


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
    drawn = generator(2).uniform(0.1, 3.0, (9, 3))
    assert given.totals[8] == np.min(DeathPenalty(PROBLEM, np.inf)(drawn))


def test_a_function_of_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine_here.py").write_text("def f(fun, bounds, budget, rng): fun(bounds[:, 1])\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [p for p in sys.path if p])
    found = run_within(find_optimizer("mine_here:f", 5), PROBLEM, 0, 5)
    assert found.durations.tolist() == [3.0, 3.0, 3.0]


# --- what an optimiser must not do ----------------------------------------------------------------


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
def test_a_missing_package_is_named_with_its_install_line(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = name.partition(":")[0]
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(TrajgapError, match=f"install it with `python -m pip install {package}`"):
        find_optimizer(name)


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
