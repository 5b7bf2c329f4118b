"""Many more instances of the whale paper's family than an audit has time for.

``python benchmarks/workspace_family.py [--instances 20] [--csv FILE]`` draws the design of
the shipped case anew with so many instances of each of its three steps, runs both
procedures under every reading of the design, and writes one row per run, reading and objective.
``--summary`` reads the rows back. Instances are resampled, not runs: pairs of runs on one instance
depend on each other. Totals of the printed procedures stand beside the printed ones, so it
shows under which readings such a total is usual at all.
"""

import argparse
import csv
import sys
from collections import defaultdict
from functools import partial

import numpy as np
from trajgap.compare.audits.instances import examined
from trajgap.compare.audits.study import Study
from trajgap.problem import load_case

CASE = "z1-woa-bspline"
PRINTED = {"slower": 13.08, "faster": 11.71}
"""Totals that the paper prints, s."""
RESAMPLED = 10_000
"""Samples of instances behind an interval: its ends then move by less than a tenth of a percent."""
TIMES = ("slower", "slower_algorithm", "faster", "slower_best", "faster_best")
COLUMNS = ("reading", "step", "instance", "objective", "run", *TIMES)


def rows(instances, workers):
    """One row per reading, instance, objective and run; totals in s, empty without an answer."""
    said = partial(print, file=sys.stderr, flush=True)
    study = Study(load_case(CASE), workers=workers, certify_seconds=0, progress=said)
    block = study.case.instances[0].model_copy(update={"instances": instances})
    result = examined(study, block)
    for sample in result.samples:
        for at, objective in enumerate(block.objectives):
            for r in range(block.runs):
                times = (*sample.totals[at, :, r], sample.slower.total, sample.faster.total)
                totals = (f"{t:.6f}" if np.isfinite(t) else "" for t in times)
                yield (sample.reading, f"{sample.step:g}", sample.index, objective, r, *totals)


def summary(path):
    """Median reduction with a 95 % interval over instances, and where printed totals lie."""
    found = defaultdict(lambda: defaultdict(list))
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            times = [float(row[name] or "inf") for name in TIMES]
            found[row["reading"], row["objective"]][row["step"], row["instance"]].append(times)
    rng = np.random.default_rng(0)
    slower_at, faster_at = (f"{side} total, s; printed {PRINTED[side]}" for side in PRINTED)
    head = ("reading", "objective", "instances", "both, %", "algorithm, %", slower_at, faster_at)
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for (reading, objective), own in found.items():
        runs = np.array([own[key] for key in sorted(own)])
        whole = np.where(np.isfinite(runs).all(axis=(1, 2)))[0]
        slower, alone, faster = runs[whole, :, 0], runs[whole, :, 1], runs[whole, :, 2]
        cells = [f"`{reading}`", objective, f"{len(whole)} of {len(runs)}"]
        for before in (slower, alone):
            pairs = 1.0 - faster[:, None, :] / before[:, :, None]
            each = np.median(pairs.reshape(len(whole), -1), axis=1)
            drawn = np.median(each[rng.integers(0, each.size, (RESAMPLED, each.size))], axis=1)
            low, high = np.quantile(drawn, [0.025, 0.975])
            cells.append(f"{100 * np.median(each):.1f} ({100 * low:.1f} to {100 * high:.1f})")
        for totals in (slower, faster):
            low, middle, high = np.quantile(totals, [0.05, 0.5, 0.95])
            cells.append(f"{middle:.2f} ({low:.2f} to {high:.2f})")
        print(f"| {' | '.join(cells)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--instances", type=int, default=20, help="of each step length")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--csv", default="docs/measurements/families.csv")
    parser.add_argument("--summary", action="store_true", help="only read the rows back")
    given = parser.parse_args()
    if not given.summary:
        with open(given.csv, "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(COLUMNS)
            writer.writerows(rows(given.instances, given.workers))
    summary(given.csv)


if __name__ == "__main__":
    main()
