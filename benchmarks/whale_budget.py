"""The whale paper's budget: a population of 30 for 500 iterations, 7 durations, 6 joints.

``python benchmarks/whale_budget.py [--repeats N]``. Eight seeded random way-points stand for the
unprinted ones; the interpolant is the C4 quintic spline with v = a = 0 at both ends. Timed: every
algorithm at 30 × 501 evaluations, under the death penalty and under the stretch; and the usual way
to write the objective (scipy's spline for one vector, 50 samples a segment), by itself and, where
mealpy is installed, under its whale algorithm, on a part of the budget and scaled. Wanted: each
below 3 s.
"""

import argparse
import importlib.util
import os
import statistics
import time
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline
from trajgap.heuristics import (
    GA,
    PSO,
    WOA,
    ImprovedGA,
    ImprovedWOA,
    find_optimizer,
    run,
    uniform_rescaling,
)
from trajgap.problem import Limits, Problem, evaluate, quintic_spline

MEMBERS, ITERATIONS, SPAN = 30, 500, (0.0, 5.0)
WANTED = 3.0
SAMPLES, PART, EPOCHS = 50, 150, 5
VELOCITY = np.deg2rad([120.0, 120.0, 100.0, 180.0, 145.0, 180.0])
ACCELERATION = np.deg2rad(np.full(6, 100.0))
ENDS = [(1, np.zeros(6)), (2, np.zeros(6))]


def question(seed):
    """Eight way-points in joint space, rad; the limits of the paper read as degrees."""
    waypoints = np.random.default_rng(seed).uniform(-1.0, 1.0, (8, 6))
    limits = Limits(VELOCITY, ACCELERATION)
    return Problem(waypoints, limits, quintic_spline(7), *SPAN, name=f"whale problem {seed}")


def usual_fitness(waypoints, durations):
    """Total time if no sample of velocity or acceleration exceeds its limit, else inf."""
    if (durations <= 0).any():
        return np.inf
    t = np.concatenate([[0.0], np.cumsum(durations)])
    spline = make_interp_spline(t, waypoints, k=5, bc_type=(ENDS, ENDS))
    at = np.concatenate([np.linspace(a, b, SAMPLES) for a, b in pairwise(t)])
    v, a = spline(at, 1), spline(at, 2)
    kept = (np.abs(v) <= VELOCITY).all() and (np.abs(a) <= ACCELERATION).all()
    return durations.sum() if kept else np.inf


def agreement(problem):
    """Samples never exceed true peaks, and miss few of them."""
    batch = np.random.default_rng(3).uniform(1.0, 5.0, (200, 7))
    usual = np.array([usual_fitness(problem.waypoints, h) for h in batch])
    exact = (evaluate(problem, batch).ratios <= 1).all(axis=(1, 2))
    assert not (exact & np.isinf(usual)).any(), "a sample exceeds the exact peak"
    return int((~exact & np.isfinite(usual)).sum()), int(exact.sum())


def with_mealpy(problem, seed):
    """Seconds of mealpy's OriginalWOA with the usual objective, scaled to the whole budget."""
    from mealpy import FloatVar
    from mealpy.swarm_based.WOA import OriginalWOA

    bounds = FloatVar(lb=(SPAN[0],) * 7, ub=(SPAN[1],) * 7)
    penalised = {
        "bounds": bounds,
        "minmax": "min",
        "obj_func": lambda h: min(1e6, usual_fitness(problem.waypoints, h)),
        "log_to": None,
    }
    model = OriginalWOA(epoch=EPOCHS, pop_size=MEMBERS)
    spent, _ = seconds(lambda: model.solve(penalised, seed=seed))
    return spent * (ITERATIONS + 1) / (EPOCHS + 1)


def seconds(function):
    start = time.perf_counter()
    found = function()
    return time.perf_counter() - start, found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    problem = question(0)
    evaluations = MEMBERS * (ITERATIONS + 1)
    missed, kept = agreement(problem)
    print(f"of 200 vectors {kept} keep the limits; samples pass {missed} more that do not")
    part = np.random.default_rng(1).uniform(0.5, 5.0, (PART, 7))
    generations = evaluations // 32 - 1  # a population that four divides
    algorithms = (
        WOA(),
        ImprovedWOA(),
        PSO(iterations=ITERATIONS, position_initial=SPAN),
        replace(GA(), population=32, iterations=generations, position_range=SPAN),
        replace(ImprovedGA(), population=32, iterations=generations, position_range=SPAN),
        replace(
            find_optimizer(
                "scipy:differential_evolution", tol=0.0, vectorized=True, updating="deferred"
            ),
            iterations=ITERATIONS,
            per_iteration=MEMBERS,
        ),
    )
    run(WOA(iterations=1), problem, 0)
    usual, theirs, ours = [], [], {}
    optional = importlib.util.find_spec("mealpy") is not None
    for repeat in range(repeats):
        spent, _ = seconds(lambda: [usual_fitness(problem.waypoints, h) for h in part])
        usual.append(spent * evaluations / PART)
        if optional:
            theirs.append(with_mealpy(problem, repeat))
        for algorithm in algorithms:
            for handling in ("death-penalty", "stretch"):
                timed = seconds(
                    lambda a=algorithm, s=repeat, h=handling: run(a, problem, s, None, h)
                )
                ours.setdefault((algorithm.kind, handling), []).append(timed)
    written = statistics.median(usual)
    print(
        f"\nmedian of {repeats} alternating repeats, {os.cpu_count()} cores; 30 × 501 evaluations"
    )
    print(f"usual objective alone {written:.1f} s ({PART} vectors, scaled)")
    if theirs:
        spent = statistics.median(theirs)
        ratio = statistics.median(
            t / o for t, (o, _) in zip(theirs, ours["woa", "death-penalty"], strict=True)
        )
        print(
            f"mealpy's OriginalWOA on it {spent:.1f} s ({EPOCHS} epochs, scaled), "
            f"{ratio:.0f} times woa here"
        )
    print(f"without any search: equal durations, {uniform_rescaling(problem).sum():.4f} s\n")
    print(f"{'algorithm':<30}{'objective':<15}{'time':>9}{'ratio':>7}{'wanted':>9}  median total")
    for (kind, handling), timed in ours.items():
        spent = statistics.median(t for t, _ in timed)
        total = statistics.median(found.reported_time for _, found in timed)
        ratio = statistics.median(u / t for u, (t, _) in zip(usual, timed, strict=True))
        print(
            f"{kind:<30}{handling:<15}{spent:>7.3f} s{ratio:>7.0f}{WANTED:>7.1f} s  {total:.4f} s"
        )


if __name__ == "__main__":
    main()
