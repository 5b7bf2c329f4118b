"""What the harness of a bench costs, and runs per second beside the libraries' own loops.

    python benchmarks/harness.py [overhead | libraries] [--rounds N]

Prints two tables, or one of them, both on the six-joint problem of puma560-mnam-pso-353 under the
death penalty.

1. Overhead: PSO, 30 particles x 200 iterations, by the bare loop (`states`: init and steps, nothing
   kept but the best), the same with `check` of its answer, by `run_within` (budget and best-so-far
   after each evaluation), and by `run_trial` (a whole row: settings, key, `check`, gaps, trace).
2. Runs per second at 6,000 evaluations: mealpy's, pymoo's and scipy's own loop called directly
   with the same objective, and the same optimiser by its name through `run_trial`.

Each number is the least processor time of several rounds that take turns, so other work on the
machine hits all of them alike; everything runs in one thread.
"""

from __future__ import annotations

import argparse
import importlib.util
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from trajgap.compare.gaps import Bracket, Trial, plan_bench, run_trial
from trajgap.heuristics import PSO, Bounds, DeathPenalty, find_optimizer, run_within, states
from trajgap.problem import check, load_case

CASE = "puma560-mnam-pso-353"
BUDGET = 6000
CHECKS = 4000
"""Checks before anything is timed: enough for the checker to have compiled its search."""


def generator(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.PCG64(seed))


def taking_turns(ways: dict[str, Callable[[int], object]], rounds: int) -> dict[str, float]:
    """Least seconds of each, in rounds."""
    best = dict.fromkeys(ways, float("inf"))
    for name in ways:
        ways[name](0)  # compiles, imports
    for at in range(rounds):
        for name, way in ways.items():
            began = time.process_time()
            way(at)
            best[name] = min(best[name], time.process_time() - began)
    return best


def overhead(trial: Trial, rounds: int) -> None:
    problem, bounds = trial.problem, Bounds.of(trial.problem)
    swarm = PSO(iterations=199)

    def bare(seed: int) -> np.ndarray:
        for state in states(swarm, DeathPenalty(problem, np.inf), bounds, generator(seed)):
            best = state.best
        return best

    found = bare(0)
    for _ in range(CHECKS):
        check(problem, found)
    took = taking_turns(
        {
            "bare loop": bare,
            "bare loop, answer judged": lambda seed: check(problem, bare(seed)),
            "run_within": lambda seed: run_within(swarm, problem, seed, BUDGET),
            "run_trial": lambda seed: run_trial(replace(trial, optimizer="pso", seed=seed)),
        },
        rounds,
    )
    print(f"PSO, 30 particles x 200 iterations, best of {rounds} rounds\n")
    print("| by | ms a run | over the bare loop | µs an evaluation more |\n|---|---|---|---|")
    for name, seconds in took.items():
        more = seconds - took["bare loop"]
        share = f"{100 * more / took['bare loop']:+.1f} %"
        print(f"| {name} | {1000 * seconds:.2f} | {share} | {1e6 * more / BUDGET:+.2f} |")


def libraries(trial: Trial, rounds: int) -> None:
    problem = trial.problem
    judge = DeathPenalty(problem, 1e6)
    lower, upper = problem.duration_lower, problem.duration_upper

    def single(x: Any) -> float:
        return float(judge(np.asarray(x)[None])[0])

    def scipy_own(seed: int) -> None:
        from scipy.optimize import differential_evolution

        # 133 generations of 45 after the first: 6,030 evaluations; no convergence, no polishing.
        box = list(zip(lower, upper, strict=True))
        differential_evolution(
            single, box, maxiter=133, tol=0, polish=False, seed=generator(seed)
        )  # fmt: skip

    def mealpy_own(seed: int) -> None:
        import mealpy

        space = mealpy.FloatVar(lb=lower.tolist(), ub=upper.tolist())
        question = {"obj_func": single, "bounds": space, "minmax": "min", "log_to": None}
        mealpy.WOA.OriginalWOA(epoch=59, pop_size=100).solve(question, seed=seed)

    def pymoo_own(seed: int) -> None:
        from pymoo.algorithms.soo.nonconvex.pso import PSO as Swarm
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

        class Asked(Problem):
            def _evaluate(self, x: Any, out: dict[str, Any], *_: object, **__: object) -> None:
                out["F"] = judge(x)[:, None]

        asked = Asked(n_var=len(lower), n_obj=1, xl=lower, xu=upper)
        minimize(asked, Swarm(pop_size=30), ("n_eval", BUDGET), seed=seed)

    ways = {
        "scipy:differential_evolution": (scipy_own, '{"polish":false,"tol":0}'),
        "mealpy:OriginalWOA": (mealpy_own, '{"epoch":59,"pop_size":100}'),
        "pymoo:PSO": (pymoo_own, '{"pop_size":30}'),
    }
    print(f"\n{BUDGET} evaluations, best of {rounds} rounds\n")
    print("| optimiser | own loop, runs/s | run_trial, runs/s | overhead |\n|---|---|---|---|")
    for name, (own, settings) in ways.items():
        package = name.partition(":")[0]
        if importlib.util.find_spec(package) is None:
            print(f"| {name} | {package} is not installed | | |")
            continue
        find_optimizer(name)
        mine = replace(trial, optimizer=name, settings=settings)

        def through(seed: int, mine: Trial = mine) -> None:
            row = run_trial(replace(mine, seed=seed))
            assert not row.message, row.message

        took = taking_turns({"own": own, "trial": through}, rounds)
        extra = 100 * (took["trial"] / took["own"] - 1)
        print(f"| {name} | {1 / took['own']:.2f} | {1 / took['trial']:.2f} | {extra:+.1f} % |")
    for name in ("pso", "mnam-pso", "ga"):
        mine = replace(trial, optimizer=name, settings="{}")
        took = taking_turns(
            {name: lambda seed, one=mine: run_trial(replace(one, seed=seed))}, rounds
        )
        print(f"| {name} | | {1 / took[name]:.2f} | |")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("tables", nargs="*", metavar="overhead | libraries")
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args()
    rounds, wanted = given.rounds, given.tables or ["overhead", "libraries"]
    problem = load_case(CASE).problem(coupling="shared")
    (trial,) = plan_bench(problem, "pso", seeds=1, budget=BUDGET, baselines=False).trials
    trial = replace(trial, settings="{}", reference=Bracket(3.2966963, 3.2966934))
    if "overhead" in wanted:
        overhead(trial, rounds)
    if "libraries" in wanted:
        libraries(trial, max(2, rounds // 2))


if __name__ == "__main__":
    main()
