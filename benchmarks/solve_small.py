"""`solve` on three segments and six joints beside plain CasADi Opti and SLSQP, in one run.

    python benchmarks/solve_small.py [--rounds N]

Opti is what a user would write (`plain_opti.py`), SLSQP what an expert would write for this very
problem (`slsqp_small.py`): one start each, no evidence. `solve` starts from several places, checks
its answer for all t and states the optimality conditions. Processor time of the
second of two calls, the median of rounds in which the ways take turns, all kernels compiled.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
import plain_opti
import slsqp_small
from trajgap.nlp import optimum, solve as solve_with_certificate
from trajgap.nlp.optimum.solver import solve
from trajgap.problem import check, load_case

CASE = "puma560-mnam-pso-353"


def main() -> int:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rounds", type=int, default=15)
    given = parser.parse_args()
    problem = load_case(CASE).problem()
    question = (problem.waypoints, 6.0, 8.0, 0.3)

    def ours() -> np.ndarray:
        answer = solve(problem)
        assert answer.status == optimum.Status.CONVERGED
        return answer.durations

    def certified() -> np.ndarray:
        answer = solve_with_certificate(problem)
        return answer.durations

    ways = {
        "solve, without a certificate": ours,
        "solve, with its certificate": certified,
        "SLSQP for 3-5-3": lambda: slsqp_small.solve(*question),
        "plain Opti": lambda: plain_opti.solve(*question),
    }
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    answers = {name: way() for name, way in ways.items()}
    for _ in range(given.rounds):
        for name, way in ways.items():
            way()  # what another way has left in the processor's caches is not timed
            began = time.process_time()
            way()
            seconds[name].append(time.process_time() - began)
    unit = statistics.median(seconds["solve, without a certificate"])
    print("| code | ms | times `solve` | total, s | by `check` | largest excess |")
    print("|---|---|---|---|---|---|")
    for name in ways:
        own = statistics.median(seconds[name])
        judged = check(problem, answers[name])
        shown = f"{1e3 * own:.1f}", f"{own / unit:.2f}", f"{answers[name].sum():.9f}"
        print(f"| {name} | {' | '.join(shown)} | {judged.verdict} | {judged.max_violation:.1e} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
