"""How long the command line takes to its answer: the first time, and when it has run before.

    python benchmarks/first_answer.py [--only WORDS]

Each command runs in a process of its own with a home folder of its own, so nothing is compiled
and no proof is kept when it runs for the first time; then it runs again. Processor seconds are
those of the process and all that it started, user and system; beside them what the clock says. An
audit is run a third time with what it has kept, the second time without. The last command audits
the four papers together, as README does: it compiles and imports once.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from trajgap.nlp.proofs.kept_files import VARIABLE

PAPERS = (
    "puma560-mnam-pso-353",
    "irb460-pso-353",
    "irb1600-ga-cubic-bspline",
    "z1-woa-bspline",
)
"""The four papers that trajgap began with."""
COMMANDS = (
    ("--help",),
    ("show", PAPERS[0]),
    ("check", PAPERS[0], "--durations", "1,1.3,1.2"),
    ("solve", PAPERS[0]),
    *(("audit", paper) for paper in PAPERS),
    ("audit",),
)


def timed(arguments: tuple[str, ...], environment: dict[str, str]) -> tuple[float, float]:
    """Processor seconds and seconds on the clock of one command."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    run = subprocess.run(
        [str(Path(sys.executable).with_name("trajgap")), *arguments],
        env=environment, capture_output=True, text=True,
    )  # fmt: skip
    took = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    # An audit that finds errors in a paper says so by its exit code; 2 and more are failures.
    if run.returncode not in (0, 1):
        raise SystemExit(f"trajgap {' '.join(arguments)}: {run.stderr[-500:]}")
    user, system = after.ru_utime - before.ru_utime, after.ru_stime - before.ru_stime
    return user + system, took


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", default="", help="commands that begin like this")
    only = parser.parse_args().only
    print("| `trajgap` | first, processor s | clock s | again, processor s | clock s | kept |")
    print("|---|---|---|---|---|---|")
    totals: list[list[float]] = []
    for command in COMMANDS:
        if not " ".join(command).startswith(only):
            continue
        with tempfile.TemporaryDirectory() as folder:
            home = Path(folder)
            environment = {
                **os.environ,
                "HOME": folder,
                "NUMBA_CACHE_DIR": str(home / "compiled"),
                VARIABLE: str(home / "kept"),
            }
            found = []
            audits = command[0] == "audit"
            for k in range(3 if audits else 2):
                out = home / f"out-{k}"
                tail = ("--out", str(out)) if audits else ()
                if k == 1 and audits:
                    tail += ("--no-cache",)
                found.append(timed((*command, *tail), environment))
                shutil.rmtree(out, ignore_errors=True)
        # Of what is kept the clock says the same as the processor.
        values = [value for pair in found for value in pair][: 5 if audits else 4]
        if command[1:] and audits:
            totals.append(values)
        cells = [f"{value:.1f}" for value in values] + [""] * (5 - len(values))
        print(f"| `{' '.join(command)}` | {' | '.join(cells)} |", flush=True)
    if len(totals) > 1:
        sums = " | ".join(f"{sum(column):.1f}" for column in zip(*totals, strict=True))
        print(f"| the {len(totals)} audits | {sums} |")


if __name__ == "__main__":
    main()
