"""`solve` on three segments and six joints beside plain CasADi Opti and SLSQP, in one run.

    python benchmarks/solve_small.py [--rounds N] [--write benchmarks/solve_small.csv]

Opti is what a user would write (`plain_opti.py`), SLSQP what an expert would write for this very
problem (`slsqp_small.py`): one start each, no evidence. `solve` starts from twelve places, checks
its answer for all t and states the optimality conditions. Processor seconds, the median of rounds
in which the ways take turns, all kernels compiled.
"""

from __future__ import annotations

import argparse
import csv
import os
import platform
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import casadi
import numpy as np
import plain_opti
import scipy
import slsqp_small
from trajgap.nlp import optimum
from trajgap.nlp import solve as solve_with_certificate
from trajgap.nlp.optimum import newton, newton_kernel
from trajgap.nlp.optimum.solver import solve
from trajgap.problem import check, load_case
from trajgap.problem.curves import Deferred

CASE = "puma560-mnam-pso-353"
GOALS = {"plain Opti": ">= 100", "SLSQP for 3-5-3": ">= 0.33"}
"""What the ratio to `solve` should be."""


def machine() -> str:
    """Processor and versions, for the table."""
    names = {"python": platform.python_version(), "numpy": np.__version__}
    names |= {"scipy": scipy.__version__, "casadi": casadi.__version__}
    model = platform.processor() or platform.machine()
    for line in Path("/proc/cpuinfo").read_text("utf-8").splitlines() if _told() else ():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    versions = " ".join(f"{name} {version}" for name, version in names.items())
    return f"{model}; {os.cpu_count()} cores; {versions}"


def _told() -> bool:
    return Path("/proc/cpuinfo").exists()


def main() -> int:
    """Measure, print the table, write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--write", type=Path, metavar="CSV")
    given = parser.parse_args()
    problem = load_case(CASE).problem()
    question = (problem.waypoints, 6.0, 8.0, 0.3)
    newton._descents = Deferred(newton_kernel.descents, 0.0)  # compiled from the first call on

    def ours() -> np.ndarray:
        answer = solve(problem)
        assert answer.status == optimum.Status.OPTIMAL
        assert answer.durations is not None
        return answer.durations

    def certified() -> np.ndarray:
        answer = solve_with_certificate(problem)
        assert answer.durations is not None
        return answer.durations

    ways = {
        "solve": ours,
        "solve, with its certificate": certified,
        "SLSQP for 3-5-3": lambda: slsqp_small.solve(*question),
        "plain Opti": lambda: plain_opti.solve(*question),
    }
    seconds: dict[str, list[float]] = {name: [] for name in ways}
    answers = {name: way() for name, way in ways.items()}  # imports, compiles
    for _ in range(given.rounds):
        for name, way in ways.items():
            began = time.process_time()
            way()
            seconds[name].append(time.process_time() - began)
    unit = statistics.median(seconds["solve"])
    rows = []
    for name in ways:
        own = statistics.median(seconds[name])
        judged = check(problem, answers[name])
        rows.append(
            {
                "way": name,
                "milliseconds": f"{1e3 * own:.2f}",
                "ratio": f"{own / unit:.2f}",
                "goal": GOALS.get(name, ""),
                "total_s": f"{answers[name].sum():.9f}",
                "check": str(judged.verdict),
                "largest_excess": f"{judged.max_violation:.1e}",
                "machine": machine(),
            }
        )
    for row in rows:
        print(
            f"{row['way']:<28} {row['milliseconds']:>9} ms  ratio {row['ratio']:>7} "
            f"{row['goal']:<8} {row['total_s']} s  {row['check']}, "
            f"largest excess {row['largest_excess']}"
        )
    print(rows[0]["machine"])
    if given.write is not None:
        with given.write.open("w", encoding="utf-8", newline="") as stream:
            writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
