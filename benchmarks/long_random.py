"""How surely and how fast `solve` ends on random splines of many segments.

    python benchmarks/long_random.py             the table, some minutes
    python benchmarks/long_random.py --count 5   fewer problems of each kind

Way-points are random walks of 1 to 4 joints, every fifth walk monotonic, so some joints run at
their velocity limit over several segments. Every fifth problem has no limits on jerk, every fifth
has position limits near its way-points, every fifth a least duration. Seconds are processor seconds
of one process, everything compiled. An answer that is not *converged* is printed with its problem.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
from trajgap.nlp import Solution, Status, solve
from trajgap.problem import Limits, Problem, cubic_spline, quintic_spline

CURVES = {"C2 cubic": cubic_spline, "C4 quintic": quintic_spline}
SIZES = ((25, 60), (60, 200), (200, 400))
SECONDS = 60.0
"""Time limit of one problem."""


def random_problem(curve: str, sizes: tuple[int, int], seed: int) -> Problem:
    """The problem of a seed."""
    rng = np.random.default_rng([seed, *sizes, list(CURVES).index(curve)])
    n, joints, kind = int(rng.integers(*sizes)), int(rng.integers(1, 5)), seed % 5
    steps = rng.uniform(0.0 if kind == 1 else -1.0, 1.0, (n + 1, joints))
    q = np.cumsum(steps, axis=0)
    limits = {
        name: np.exp(rng.uniform(np.log(low), np.log(high), joints))
        for name, low, high in (
            ("velocity", 0.5, 3.0),
            ("acceleration", 1.0, 10.0),
            ("jerk", 5.0, 80.0),
        )
        if not (name == "jerk" and kind == 2)
    }
    if kind == 3:
        limits["position_upper"] = q.max(axis=0) + rng.uniform(0.02, 0.3, joints)
        limits["position_lower"] = q.min(axis=0) - rng.uniform(0.02, 0.3, joints)
    least = float(rng.uniform(0.1, 1.0)) if kind == 4 else 0.0
    return Problem(q, Limits(**limits), CURVES[curve](n), duration_lower=np.array(least))


def timed(problem: Problem) -> tuple[Solution, float]:
    """The answer, and its processor seconds."""
    began = time.process_time()
    answer = solve(problem, seconds=SECONDS)
    return answer, time.process_time() - began


def main() -> None:
    """Solve and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=40, help="problems of each row")
    count = parser.parse_args().count
    for curve in CURVES:
        solve(random_problem(curve, SIZES[0], 0))
    print("| spline | segments | problems | converged | median s | longest s |")
    print("|---|---|---|---|---|---|")
    for curve in CURVES:
        for sizes in SIZES:
            converged, seconds, others = 0, [], []
            for seed in range(count):
                problem = random_problem(curve, sizes, seed)
                answer, took = timed(problem)
                seconds.append(took)
                if answer.status is Status.CONVERGED and took < SECONDS:
                    converged += 1
                else:
                    others.append(f"seed {seed}: {answer.status}, {answer.why}")
            cells = (curve, f"{sizes[0]} to {sizes[1] - 1}", count, converged)
            times = (f"{statistics.median(seconds):.2f}", f"{max(seconds):.2f}")
            print("|", " | ".join(map(str, (*cells, *times))), "|", flush=True)
            print(*others, sep="\n", end="\n" if others else "", flush=True)


if __name__ == "__main__":
    main()
