"""How far answers come after their time limit: `solve` and `certify` of larger problems.

    python benchmarks/time_limits.py           the table, from runs now (a quarter of an hour)
    python benchmarks/time_limits.py --only "certify quintic"    rows with all these words
    python benchmarks/time_limits.py --each    every run by itself, as it ends

Each run is a process of its own, after imports, after a small problem of its kind, and with one
thread for linear algebra. Two numbers are taken: seconds from the limit to the answer, and the
processor seconds that the process took in them, read from the system by another process. The first
grows with whatever else the machine does, the second does not. With ``--first`` there are two other
rows, without compiled code at hand, as after an installation.
"""

from __future__ import annotations

import argparse
import os
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SECONDS = (1.0, 3.0, 10.0)
POINTS = (8, 25, 40)
PATIENCE = 60.0
"""Seconds beyond the limit after which a run is ended: it counts as that much or more."""
JOINTS = 6
LIMITS = (2.0, 10.0, 60.0)
CURVES = {
    "cubic": "C2 cubic",
    "quintic": "C4 quintic",
    "timed": "uniform B-spline, timed",
    "clamped": "clamped quintic B-spline",
}
ROWS = [
    *(
        ("solve", curve, n, "")
        for curve in ("cubic", "quintic", "timed", "clamped")
        for n in POINTS
    ),
    *(("certify", "cubic", n, "") for n in POINTS),
    *(("certify", "quintic", n, "") for n in POINTS if n <= 27),
]
FIRST = [("solve", "cubic", 8, "first"), ("certify", "quintic", 8, "first")]


def problem_of(curve, count):
    """A random walk of six joints on a curve."""
    import numpy as np
    from trajgap.problem import (
        ClampedBSpline,
        Knots,
        Limits,
        Parameters,
        Problem,
        cubic_spline,
        quintic_spline,
        uniform_cubic_b_spline,
    )

    q = np.cumsum(0.5 * np.random.default_rng(5).normal(size=(count, JOINTS)), axis=0)
    kinds = {
        "cubic": lambda: cubic_spline(count - 1),
        "quintic": lambda: quintic_spline(count - 1),
        "timed": lambda: uniform_cubic_b_spline(count, "timed"),
        "clamped": lambda: ClampedBSpline(count, 5, Knots.CONTINUED, Parameters.TIMES),
    }
    return Problem(q, Limits(*LIMITS, joints=JOINTS), kinds[curve]())


def work(what, curve, count, seconds, first):
    """One run; says when it begins, and how it ended."""
    from trajgap.nlp import certify, solve

    def run(count, seconds):
        problem = problem_of(curve, count)
        if what == "solve":
            return str(solve(problem, seconds=seconds).status)
        return str(certify(problem, seconds=seconds, gap=1e-6).outcome)

    if not first:
        run(4, 5.0)
    print("begin", flush=True)
    sys.stdin.readline()
    told = run(count, seconds)
    print("end", told, flush=True)
    sys.stdin.readline()


def processor(pid):
    """Processor seconds of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(row, seconds):
    """One run in its own process: word, seconds and processor seconds beyond the limit."""
    what, curve, count, first = row
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    with tempfile.TemporaryDirectory() as folder:
        if first:
            environment["NUMBA_CACHE_DIR"] = folder
        command = [sys.executable, __file__, "--run", what, curve, str(count), str(seconds), first]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment
        ) as child:
            assert child.stdin is not None
            assert child.stdout is not None
            assert child.stdout.readline().startswith(b"begin"), row
            began = time.monotonic()
            child.stdin.write(b"\n")
            child.stdin.flush()
            at_limit = None
            if not select.select([child.stdout], [], [], seconds)[0]:
                at_limit = processor(child.pid)
            ended = bool(select.select([child.stdout], [], [], PATIENCE)[0])
            told = child.stdout.readline().decode().removeprefix("end ").strip() if ended else ""
            took, total = time.monotonic() - began, processor(child.pid)
            if not ended:
                child.kill()
                told = "no answer"
            child.stdin.close()  # it waits, so that its times can be read
    assert told, row
    beyond = 0.0 if at_limit is None else total - at_limit
    return told, took, max(0.0, took - seconds), beyond


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", nargs=5)
    parser.add_argument("--only", default="")
    parser.add_argument("--each", action="store_true")
    parser.add_argument("--first", action="store_true")
    parser.add_argument("--seconds", type=float, nargs="*", default=SECONDS)
    asked = parser.parse_args()
    if asked.run:
        what, curve, count, seconds, first = asked.run
        work(what, curve, int(count), float(seconds), first)
        return
    print("| what | curve | way-points | " + " | ".join(f"{s:g} s" for s in asked.seconds) + " |")
    print("|---" * (3 + len(asked.seconds)) + "|")
    for row in FIRST if asked.first else ROWS:
        what, curve, count, first = row
        named = [what, curve, str(count), *([first] if first else [])]
        if not all(word in " ".join(named).split() for word in asked.only.split()):
            continue
        cells = []
        for seconds in asked.seconds:
            told, took, late, busy = measured(row, seconds)
            cells.append("in time" if late == 0.0 else f"{late:.2f} ({busy:.2f})")
            if asked.each:
                said = f"{seconds:g} s: {told} after {took:.2f}"
                print("  ", *named, said, cells[-1], flush=True)
        head = [f"{what}{', ' + first if first else ''}", CURVES[curve], str(count)]
        print("| " + " | ".join([*head, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
