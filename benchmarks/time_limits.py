"""How far answers come after their time limit: `solve`, `certify`, `verify` and `audit`.

    python benchmarks/time_limits.py           the table, from runs now (half an hour)
    python benchmarks/time_limits.py --only "certify quintic"    rows with all these words
    python benchmarks/time_limits.py --each    every run by itself, as it ends

Each run is a process of its own, after imports, after a small problem of its kind, and with one
thread for linear algebra. `verify` is the command, with certificates that a run of `MAKING` seconds
left, a state of a long spline, and a file of nearly the largest size. `audit` has a case of
three problems, and what counts is the time in which it certifies them. Two numbers are taken:
seconds from the limit to the answer, and the processor seconds that the process took in them, read
from the system by another process. The first grows with whatever else the machine does, the second
does not. With ``--first`` there are other rows,
without compiled code at hand, as after an installation.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
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
MAKING = 40.0
"""Seconds for which a certificate is searched that `verify` then has to prove."""
LONG = 400
"""Segments of the spline whose exact elimination `verify` has to break off."""
JOINTS = 6
LIMITS = (2.0, 10.0, 60.0)
CURVES = {
    "cubic": "C2 cubic",
    "quintic": "C4 quintic",
    "timed": "uniform B-spline, timed",
    "clamped": "clamped quintic B-spline",
    "long": "C2 cubic, a state with an answer alone",
    "file": "none: 54 MB of JSON",
}
ROWS = [
    *(
        ("solve", curve, n, "")
        for curve in ("cubic", "quintic", "timed", "clamped")
        for n in POINTS
    ),
    *(("certify", "cubic", n, "") for n in POINTS),
    *(("certify", "quintic", n, "") for n in POINTS if n <= 27),
    *(("verify", "cubic", n, "") for n in POINTS if n <= 27),
    ("verify", "long", LONG + 1, ""),
    ("verify", "file", 0, ""),
    *(("audit", curve, n, "") for curve in ("cubic", "quintic") for n in POINTS if n <= 27),
]
FIRST = [
    *(("solve", curve, 8, "first") for curve in ("cubic", "quintic", "timed", "clamped")),
    ("solve", "clamped", 25, "first"),
    *(("certify", curve, 8, "first") for curve in ("cubic", "quintic")),
    ("certify", "quintic", 25, "first"),
]


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


def file_of(curve, count, path):
    """Write what `verify` gets: a certificate, a state or merely a large file."""
    from trajgap.nlp import certificate, certify
    from trajgap.nlp.proofs.document import problem_document
    from trajgap.nlp.proofs.exact import exact_problem
    from trajgap.verify import STATE_FORMAT, seal

    if curve == "file":
        leaves = ",".join(['["."]'] * 9_000_000)
        path.write_text(f"[{leaves}]")
        return
    found = certify(problem_of("cubic" if curve == "long" else curve, 8), seconds=5.0, gap=0.5)
    if curve != "long":
        found = certify(problem_of(curve, count), seconds=MAKING, gap=1e-6)
    document = certificate(found)
    if curve == "long":
        document["problem"] = problem_document(exact_problem(problem_of("cubic", count)))
        document |= {"format": STATE_FORMAT, "proof": None, "proposals": None}
        document["problem_hash"] = seal(document["problem"])
        times = ["1." + f"{k:03d}" * 10 for k in range(count - 1)]
        document["claim"] |= {"lower": "0", "upper": str(2 * count), "durations": times}
    path.write_text(json.dumps(document))


def case_of(curve, count):
    """The same problem as a case file, with three limits of velocity: three problems."""
    from trajgap.problem import parse_case

    q = problem_of(curve, count).waypoints
    rows = ", ".join("[" + ", ".join(f'"{x:.6f}"' for x in column) + "]" for column in q.T)
    problems = "".join(
        f'[[problems]]\nid = "p{k}"\nlimits = {{ velocity = {LIMITS[0] - 0.1 * k} }}\n'
        f'[[claims]]\nid = "c{k}"\nquantity = "total_time"\nwhere = "Table 1"\n'
        f'problem = "p{k}"\nvalue = "{10 * count}.0"\n'
        for k in range(3)
    )
    text = f"""format = 1
id = "timed"
title = "Timed"
coupling = "shared"
[source]
year = 2020
[robot]
name = "arm"
joints = {json.dumps([str(j) for j in range(JOINTS)])}
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
jerk = "rad/s^3"
time = "s"
[waypoints]
labels = {json.dumps([f"P{k}" for k in range(count)])}
joint_rows = [{rows}]
[limits]
velocity = {LIMITS[0]}
acceleration = {LIMITS[1]}
jerk = {LIMITS[2]}
[interpolant]
family = "{curve}-spline"
{problems}"""
    return parse_case(text, "timed.toml")


def report(word):
    """Tell the parent where the run is, and wait until it has looked at the clock."""
    print(word, flush=True)
    sys.stdin.readline()


def verified(path, seconds):
    """One run of the command `python -m trajgap.verify`."""
    from trajgap.verify.__main__ import main as verify

    sys.argv = ["verify", "--time", str(seconds), str(path)]
    with contextlib.redirect_stdout(io.StringIO()) as said:
        verify()
    return said.getvalue().partition(": ")[2].partition(":")[0]


def audited(curve, count, seconds):
    """One audit, which pauses the clock of the parent wherever it does not certify."""
    from trajgap.compare.audits import audit, intervals

    certify = intervals.certify

    def noted(*given, **named):
        report("begin")
        try:
            return certify(*given, **named)
        finally:
            report("pause")

    intervals.certify = noted
    audit(case_of(curve, count), seeds=2, certify_seconds=seconds)
    return "audited"


def work(what, curve, count, seconds, first, path):
    """One run; says when it begins, and how it ended."""
    from trajgap.nlp import certify, solve

    def run(count, seconds):
        problem = problem_of(curve, count)
        if what == "solve":
            return str(solve(problem, seconds=seconds).status)
        return str(certify(problem, seconds=seconds, gap=1e-6).outcome)

    if what == "audit":
        word = audited(curve, count, seconds)
    elif what == "verify":
        import trajgap.verify.__main__
        import trajgap.verify.quintic  # noqa: F401

        report("begin")
        word = verified(path, seconds)
    else:
        if not first:
            run(4, 5.0)
        report("begin")
        word = run(count, seconds)
    report(f"end {word}")


def processor(pid):
    """Processor seconds of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(row, seconds, path):
    """One run in its own process: word, seconds and processor seconds beyond the limit."""
    what, curve, count, first = row
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    took, beyond, word = 0.0, 0.0, ""
    with tempfile.TemporaryDirectory() as folder:
        if first:
            environment["NUMBA_CACHE_DIR"] = folder
        run = [what, curve, str(count), str(seconds), first, str(path)]
        with subprocess.Popen(
            [sys.executable, __file__, "--run", *run],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        ) as child:
            assert child.stdin is not None
            assert child.stdout is not None
            while not word:
                said = child.stdout.readline().decode().strip()
                if said == "begin":
                    late, busy, said = watched(child, seconds - took)
                    took, beyond = took + late, beyond + busy
                if not said:
                    child.kill()
                word = said.removeprefix("end ") if said.startswith("end ") else ""
                word = word or ("" if said else "no answer")
                child.stdin.write(b"\n")  # it waited, so its times could be read
                with contextlib.suppress(BrokenPipeError):
                    child.stdin.flush()
    return word, took, max(0.0, took - seconds), beyond


def watched(child, left):
    """From a beginning to the next word: seconds, processor seconds beyond the limit, the word."""
    began, at_limit = time.monotonic(), None
    child.stdin.write(b"\n")
    child.stdin.flush()
    if not select.select([child.stdout], [], [], max(0.0, left))[0]:
        at_limit = processor(child.pid)
    ended = bool(select.select([child.stdout], [], [], PATIENCE)[0])
    said = child.stdout.readline().decode().strip() if ended else ""
    busy = 0.0 if at_limit is None else processor(child.pid) - at_limit
    return time.monotonic() - began, busy, said


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", nargs=6)
    parser.add_argument("--only", default="")
    parser.add_argument("--each", action="store_true")
    parser.add_argument("--first", action="store_true")
    parser.add_argument("--seconds", type=float, nargs="*", default=SECONDS)
    asked = parser.parse_args()
    if asked.run:
        what, curve, count, seconds, first, path = asked.run
        work(what, curve, int(count), float(seconds), first, path)
        return
    print("| what | curve | way-points | " + " | ".join(f"{s:g} s" for s in asked.seconds) + " |")
    print("|---" * (3 + len(asked.seconds)) + "|")
    for row in FIRST if asked.first else ROWS:
        what, curve, count, first = row
        named = [what, curve, str(count), *([first] if first else [])]
        if not all(word in " ".join(named).split() for word in asked.only.split()):
            continue
        cells = []
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "certificate.json"
            if what == "verify":
                file_of(curve, count, path)
            for seconds in asked.seconds:
                word, took, late, busy = measured(row, seconds, path)
                cells.append("in time" if late == 0.0 else f"{late:.2f} ({busy:.2f})")
                if asked.each:
                    said = f"{seconds:g} s: {word} after {took:.2f}"
                    print("  ", *named, said, cells[-1], flush=True)
        head = [f"{what}{', ' + first if first else ''}", CURVES[curve], str(count)]
        print("| " + " | ".join([*head, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
