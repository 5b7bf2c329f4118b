"""How often `solve` says a wrong word, or an optimum that brute force improves.

    RATES=docs/measurements/solver-errors.csv
    python benchmarks/solver_errors.py --count 1000 --seed 0 --write $RATES
    python benchmarks/solver_errors.py --kind each --count 400 --block 20 --write $RATES

The first takes random problems that are hard on purpose: bounds on the durations, position limits,
way-points that coincide or nearly do, joints that stand still, angles and limits over many powers
of ten. Brute force is differential evolution over the logarithms of the durations, then the simplex
method. It shares no code with `solve`; every motion counts only once `check` has passed it.

The second takes those of every kind of `proved_problems.py`, most of which `solve` proves. A block
of seeds that the file holds is left out: the same command continues where it ended.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, minimize
from trajgap.nlp import Solution, Status, solve
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)

IMPROVABLE = 1e-4
"""Relative gain of brute force from which an answer counts as improvable."""
PROVED = 1e-6
"""The same of an answer that is called optimal."""
TOLERATED = 1e-9
"""By how much, relative, `check` lets a motion be shorter than limits that are kept exactly."""
WIDEST_LOG = (-14.0, 4.0)
"""Natural logarithms of the durations that brute force tries, over the usual one of the problem."""
MEMBERS, GENERATIONS = 15, 100
"""Of differential evolution: members a segment, generations."""
TRIES, EVALUATIONS = 2, 150
"""Members of the last generation from which the simplex method starts; its evaluations for each
segment."""
SCALES = (-4.0, 4.0)
"""Powers of ten over which angles and limits are spread."""


def random_curve(generator: np.random.Generator) -> Interpolant:
    """One of the curves that papers use, with 2 to 4 segments."""
    n = int(generator.integers(2, 5))
    kinds = (
        lambda: three_five_three(),
        lambda: cubic_spline(n),
        lambda: cubic_spline(n, ends=((2, 0.0),)),
        lambda: quintic_spline(n),
        lambda: rest_to_rest(n, int(generator.choice([3, 5]))),
    )
    return kinds[int(generator.integers(len(kinds)))]()


def random_problem(generator: np.random.Generator) -> Problem:
    """A problem that may have every trait that made solvers fail."""
    curve = random_curve(generator)
    jumps = max(curve.degrees) == 3 and curve.continuity[0] == 0
    joints, points = int(generator.integers(1, 4)), len(curve.waypoint_breaks)
    q = generator.normal(size=(points, joints)) + generator.normal(size=joints)
    if generator.random() < 0.3:
        w = int(generator.integers(1, points))
        q[w] = q[w - 1]
        if generator.random() < 0.5:
            q[w] += 10.0 ** generator.uniform(-7, -2) * generator.normal(size=joints)
    if joints > 1 and generator.random() < 0.2:
        q[:, int(generator.integers(joints))] = generator.normal()
    unit = 10.0 ** generator.uniform(*SCALES)
    pace = 10.0 ** generator.uniform(*SCALES)
    rates = generator.uniform(0.3, 3.0, (3, joints)) * unit * pace ** np.arange(1, 4)[:, None]
    kept = generator.random(3) < 0.6
    kept[int(generator.integers(3))] = True
    if jumps:
        kept[2], kept[0] = False, True  # their acceleration jumps: no jerk limit is ever kept
    rates[~kept] = np.inf
    low, high = -np.inf, np.inf
    if generator.random() < 0.3:
        span = np.ptp(q, axis=0)
        low = (q.min(axis=0) - generator.uniform(0, 0.4) * span) * unit
        high = (q.max(axis=0) + generator.uniform(0, 0.4) * span) * unit
    problem = Problem(q * unit, Limits(*rates, low, high, joints=joints), curve)
    if generator.random() < 0.5:
        h = np.exp(0.7 * generator.normal(size=curve.segments))
        stretch = float(evaluate(problem, h[None]).stretch[0])
        if np.isfinite(stretch) and stretch > 0:
            h *= stretch * generator.choice([0.9, 1.0, 1.0, 1.2])
            problem = replace(
                problem,
                duration_lower=h * generator.uniform(0.3, 1.0, h.size),
                duration_upper=h * generator.uniform(1.0, 2.0, h.size),
            )
    return problem


@dataclass(frozen=True, eq=False)
class Brute:
    """The shortest motion that brute force found and `check` passed, if any."""

    total: float
    durations: NDArray[np.float64] | None


def objective(problem: Problem, h: NDArray[np.float64]) -> NDArray[np.float64]:
    """Totals of duration vectors once stretched to be tight; more where that keeps no limit."""
    h = _decoded(problem, h)
    found = evaluate(problem, h)
    reach = np.maximum(found.stretch, found.positions.max(axis=1))
    over = np.where(np.isfinite(reach), np.maximum(reach - 1.0 - 1e-10, 0.0), 1e3)
    total = h.sum(axis=1)
    return np.asarray(np.where(over > 0, total * (10.0 + 100.0 * over), total))


def _decoded(problem: Problem, h: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors stretched to be tight, each stretch put back between the bounds."""
    for _ in range(4):
        stretch = evaluate(problem, h).stretch
        factor = np.where(np.isfinite(stretch) & (stretch > 0), stretch, 1.0)
        h = np.clip(h * factor[:, None], problem.duration_lower, problem.duration_upper)
    return np.asarray(h)


def brute_force(problem: Problem, seed: int) -> Brute:
    """Shortest motion that differential evolution and the simplex method find."""
    n = problem.segments
    usual = np.ones(n)
    stretch = float(evaluate(problem, usual[None]).stretch[0])
    if np.isfinite(stretch) and stretch > 0:
        usual *= stretch
    low = np.log(np.maximum(problem.duration_lower, usual * np.exp(WIDEST_LOG[0])))
    high = np.log(np.minimum(problem.duration_upper, usual * np.exp(WIDEST_LOG[1])))
    low, high = np.minimum(low, high - 1e-9), np.maximum(high, low + 1e-9)

    def many(z: NDArray[np.float64]) -> NDArray[np.float64]:
        return objective(problem, np.exp(np.clip(z.T, low, high)))

    def one(z: NDArray[np.float64]) -> float:
        return float(objective(problem, np.exp(np.clip(z, low, high))[None])[0])

    found = differential_evolution(
        many,
        list(zip(low, high, strict=True)),
        popsize=MEMBERS,
        maxiter=GENERATIONS,
        tol=1e-9,
        polish=False,
        rng=seed,
        vectorized=True,
        updating="deferred",
    )
    order = np.argsort(found.population_energies)[:TRIES]
    best = Brute(np.inf, None)
    for z in found.population[order]:
        options = {"xatol": 1e-7, "fatol": 0, "maxfev": EVALUATIONS * n}
        ended = minimize(one, z, method="Nelder-Mead", options=options).x
        for w in (ended, z):
            h = _decoded(problem, np.exp(np.clip(w, low, high))[None])[0]
            if h.sum() < best.total and check(problem, h).verdict is Verdict.PASS:
                best = Brute(float(h.sum()), h)
    return best


def judged(solution: Solution, brute: Brute) -> str:
    """What is wrong with an answer, in a word; empty if nothing is."""
    if not solution.found:
        return f"wrong {solution.status}" if brute.durations is not None else ""
    kept = check(solution.problem, solution.durations, solution.nodal).verdict
    if kept is not Verdict.PASS:
        return "answer does not pass"
    if brute.total < (solution.lower_bound or 0.0) * (1 - TOLERATED):
        return "wrong bound"
    allowed = PROVED if solution.status is Status.OPTIMAL else IMPROVABLE
    return "improvable" if brute.total < solution.best * (1 - allowed) else ""


def tried(kind: str, seed: int) -> tuple[Solution, Brute]:
    """The answer to a problem, and what brute force finds."""
    if kind == "hard":
        problem = random_problem(np.random.default_rng(seed))
        return solve(problem), brute_force(problem, seed)
    others = _beside("proved_problems")
    problem, known = others.known_problem(kind, seed)
    solution = solve(problem)
    h = others.attacked(problem, known, solution, seed)
    return solution, Brute(float(h.sum()), h)


def _beside(name: str) -> ModuleType:
    """A module beside this one, however this one was loaded."""
    sys.path.insert(0, str(Path(__file__).parent))
    try:
        return importlib.import_module(name)
    finally:
        del sys.path[0]


def counted(kind: str, seeds: range, code: str) -> list[Any]:
    """Rows of a block; every fault is printed."""
    words: Counter[str] = Counter()
    faults: list[tuple[int, str, str]] = []
    began = time.process_time()
    for seed in seeds:
        solution, brute = tried(kind, seed)
        words[str(solution.status)] += 1
        fault = judged(solution, brute)
        if fault:
            faults.append((seed, fault, str(solution.status)))
            name, gain = solution.problem.curve.name, 1 - brute.total / solution.best
            print(f"{seed}: {fault}, {solution.status}, {name}, gain {gain:.3g}", flush=True)
    said = ", ".join(f"{count} {word}" for word, count in words.most_common())
    print(
        f"{kind}, seeds {seeds[0]} to {seeds[-1]}: {said}; {len(faults)} faults, "
        f"{time.process_time() - began:.0f} s",
        flush=True,
    )
    rows: list[Any] = _beside("error_rates").rows_of(code, kind, seeds[0], words, faults)
    return rows


def main() -> int:
    """Count wrong words and improvable answers; 1 if `infeasible` is wrong somewhere."""
    kinds = ("hard", *_beside("proved_problems").KINDS)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--kind", choices=("each", *kinds), default="hard", help="of problems")
    parser.add_argument("--count", type=int, default=1000, help="problems of a kind")
    parser.add_argument("--seed", type=int, default=0, help="the first one")
    parser.add_argument("--block", type=int, default=1000, help="problems of a row")
    parser.add_argument(
        "--write", type=Path, metavar="CSV", help="enter the counts; that of docs/ with its page"
    )
    given = parser.parse_args()
    rates, wrong = _beside("error_rates"), 0
    done = set(map(rates.block, rates.entered(given.write))) if given.write else set()
    code = rates.described()
    end = given.seed + given.count
    for first in range(given.seed, end, given.block):
        seeds = range(first, min(first + given.block, end))
        for kind in kinds[1:] if given.kind == "each" else (given.kind,):
            if (kind, first, len(seeds)) in done:
                continue
            rows = counted(kind, seeds, code)
            wrong += sum(row.wrong for row in rows if row.status == Status.INFEASIBLE)
            if given.write:
                rates.enter(given.write, rows)
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
