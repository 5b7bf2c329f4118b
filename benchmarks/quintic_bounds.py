"""Three lower bounds on the twenty C4 quintic problems with the same processor seconds each.

``python benchmarks/quintic_bounds.py METHOD [--seconds S] [--first F] [--every N]`` with METHOD
certificate, mccormick or scip (``pip install pyscipopt`` first) appends a line per problem to
``quintic_bounds.csv``; ``--table`` prints the tables of docs/explanation/certificates-quintic.md
from it. The seconds hold the local solver's search for the answer, whose total is the upper bound.
"""

from __future__ import annotations

import argparse
import csv
import statistics
import time
from pathlib import Path

FILE = Path(__file__).with_suffix(".csv")
COLUMNS = ("method", "problem", "limit_s", "lower", "upper", "nodes", "processor_s")
METHODS = {
    "certificate": "certified interval, `certify(gap=0.01)`",
    "mccormick": "McCormick LP, floating point",
    "scip": "SCIP on the lifted form, floating point",
}


def certificate(problem, seconds):
    """Certified lower bound, upper bound and boxes."""
    from trajgap.nlp.proofs.certifiers import certify

    end = time.process_time() + seconds

    def report(_):
        if time.process_time() > end:
            raise KeyboardInterrupt

    found = certify(problem, gap=0.01, seconds=1e6, report=report)
    return float(found.lower), float(found.upper), found.nodes


def mccormick(problem, seconds):
    """Lower bound of the linear programs, upper bound and boxes."""
    from quintic_mccormick import lower_bound
    from trajgap.nlp import solve

    end = time.process_time() + seconds
    upper = float(solve(problem, seed=0).total_time)
    lower, nodes = lower_bound(problem, upper, end - time.process_time(), 0.01)
    return lower, upper, nodes


def scip(problem, seconds):
    """SCIP's lower bound (0 if it has none), upper bound and nodes."""
    from quintic_scip import lower_bound
    from trajgap.nlp import solve

    end = time.process_time() + seconds
    upper = float(solve(problem, seed=0).total_time)
    lower, nodes = lower_bound(problem, upper, end - time.process_time())
    return max(lower, 0.0), upper, nodes


def rows():
    """Lines of the file, sorted as they are shown."""
    with FILE.open(newline="") as file:
        found = list(csv.DictReader(file))
    order = list(METHODS)
    return sorted(found, key=lambda row: (order.index(row["method"]), row["problem"]))


def gap(row):
    """Relative width of a line's interval."""
    return 1.0 - float(row["lower"]) / float(row["upper"])


def summary(found):
    """One line per method."""
    lines = [
        "| bound | problems | median gap | worst gap | median nodes | median s | most s |",
        "|---|---|---|---|---|---|---|",
    ]
    for method, name in METHODS.items():
        own = [row for row in found if row["method"] == method]
        gaps = [gap(row) for row in own]
        seconds = [float(row["processor_s"]) for row in own]
        lines.append(
            f"| {name} | {len(own)} | {statistics.median(gaps):.3f} | {max(gaps):.3f}"
            f" | {statistics.median(int(row['nodes']) for row in own):.0f}"
            f" | {statistics.median(seconds):.1f} | {max(seconds):.1f} |"
        )
    return lines


def each(found):
    """One line per problem: gap and nodes of every method."""
    cells = {(row["method"], row["problem"]): f"{gap(row):.3f} | {row['nodes']}" for row in found}
    lines = [
        "| problem | certified | boxes | McCormick | boxes | SCIP | nodes |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in sorted({row["problem"] for row in found}):
        lines.append(f"| {name} | {' | '.join(cells[method, name] for method in METHODS)} |")
    return lines


def run(method, seconds, problems):
    """Append one line per problem."""
    for problem in problems:
        began = time.process_time()
        lower, upper, nodes = globals()[method](problem, seconds)
        spent = time.process_time() - began
        numbers = (f"{lower:.6f}", f"{upper:.6f}", nodes, f"{spent:.1f}")
        line = (method, problem.name, f"{seconds:g}", *numbers)
        new = not FILE.exists()
        with FILE.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            if new:
                writer.writerow(COLUMNS)
            writer.writerow(line)
        print(*line, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("method", nargs="?", choices=METHODS)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    if given.method:
        from quintic_instances import instances

        problems = instances()[given.first :: given.every]
        if given.method == "certificate":
            from trajgap.nlp.proofs.certifiers import certify

            certify(problems[0], gap=0.3)  # compile
        run(given.method, given.seconds, problems)
    if given.table:
        print("\n".join([*summary(rows()), "", *each(rows())]))


if __name__ == "__main__":
    main()
