"""`solve` on three segments and six joints beside plain CasADi Opti and SLSQP, in one run.

    python benchmarks/solve_small.py [--rounds N]

Opti is what a user would write (`plain_opti.py`), SLSQP what an expert would write for this very
problem (`slsqp_small.py`): one start each, no evidence. `solve` is called as the guides call it, on
the published problem, whose certificate ships, and on one that nobody has solved before: its
way-points lie 1 % closer. Processor time of the second of two calls, the median of rounds in which
the ways take turns.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import plain_opti
import slsqp_small
from trajgap.nlp import solve
from trajgap.problem import check, load_case

CASE = "puma560-mnam-pso-353"
PUBLISHED = "`solve(problem)`, published"


def main() -> int:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rounds", type=int, default=15)
    given = parser.parse_args()
    problem = load_case(CASE).problem()
    fresh = replace(problem, waypoints=0.99 * problem.waypoints)
    question = (problem.waypoints, 6.0, 8.0, 0.3)
    ways = {
        PUBLISHED: lambda: solve(problem).durations,
        "`solve(problem, prove=0)`, published": lambda: solve(problem, prove=0).durations,
        "`solve(problem)`, fresh": lambda: solve(fresh).durations,
        "`solve(problem, prove=0)`, fresh": lambda: solve(fresh, prove=0).durations,
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
    unit = statistics.median(seconds[PUBLISHED])
    print("| code | ms | times `solve` | total, s | by `check` | largest excess |")
    print("|---|---|---|---|---|---|")
    for name in ways:
        own = statistics.median(seconds[name])
        judged = check(fresh if "fresh" in name else problem, answers[name])
        shown = f"{1e3 * own:.1f}", f"{own / unit:.2f}", f"{answers[name].sum():.9f}"
        print(f"| {name} | {' | '.join(shown)} | {judged.verdict} | {judged.max_violation:.1e} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
