"""How surely and how fast the twenty quintic problems are solved: single starts, and the default.

``python benchmarks/quintic_starts.py [--starts 20] [--only 0 7]``. Starts are log-uniform in
[0.1, 10] times the rescaled equal durations. Timed: a whole `solve` from each start separately, and
the default `solve`. The best is *best known*: nothing here proves it.
"""

import argparse
import time

import numpy as np
from quintic_instances import instances
from trajgap.nlp import random_starts
from trajgap.nlp.optimum import solve
from trajgap.problem import Verdict

SAME, SEED = 1e-6, 20260302
COLUMNS = (
    "problem",
    "active limits",
    "best known (s)",
    "single starts",
    "totals",
    "default",
    "s a start",
)


def timed(problem, **options):
    """Total of an answer, infinite if it breaks a limit; the answer; processor seconds."""
    began = time.process_time()
    answer = solve(problem, **options)
    kept = answer.check is not None and answer.check.verdict is Verdict.PASS
    total = answer.total_time if kept else float("inf")
    return total, answer, time.process_time() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--only", type=int, nargs="*")
    options = parser.parse_args()
    problems = instances()
    print(f"| {' | '.join(COLUMNS)} |")
    print("|---|---|---|---|---|---|---|")
    for number in range(len(problems)) if options.only is None else options.only:
        problem = problems[number]
        generator = np.random.default_rng([SEED, number])
        starts = random_starts(problem, options.starts, generator)
        usual, answer, _ = timed(problem)
        singles = [timed(problem, initial=start[None]) for start in starts]
        totals = np.sort([usual, *(total for total, _, _ in singles)])
        best, finite = totals[0], totals[np.isfinite(totals)]
        kinds = 1 + int((np.diff(np.log(finite)) > SAME).sum())
        hits = sum(total <= best * (1 + SAME) for total, _, _ in singles)
        active = ", ".join(sorted({a.quantity for a in answer.active}))
        print(
            f"| {problem.name} | {active} | {best:.6f} | {hits} of {len(singles)} | {kinds} "
            f"| {'yes' if usual <= best * (1 + SAME) else 'no'} "
            f"| {np.median([seconds for *_, seconds in singles]):.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
