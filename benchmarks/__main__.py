"""Every table of the page on speed, measured now and in one run.

    python benchmarks                      all of them, on an idle machine
    python benchmarks solve-small          one or more by name
    python benchmarks --list               their names, and the file that measures each
    python benchmarks --write              into docs/measurements and its page

Each table is measured by a file of its own, which prints it; the files of `TABLES` run alone too.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
FILLER = HERE.parent / "docs" / "tables.py"
"""Puts a table that was printed into its CSV and its page."""
TABLES = {
    "scale": ("scale.py",),
    "long-random": ("long_random.py",),
    "solve-small": ("solve_small.py",),
    "batch-evaluation": ("batch_evaluation.py",),
    "loop-overhead": ("harness.py", "overhead"),
    "first-answer": ("first_answer.py",),
    "quintic-hundredth": ("quintic_certificates.py", "--gap", "0.01", "--workers", "2"),
}
"""What measures each table."""


def measured(command: tuple[str, ...]) -> str:
    """Run a file, show what it prints as it comes, and return it."""
    process = subprocess.Popen(
        [sys.executable, str(HERE / command[0]), *command[1:]],
        stdout=subprocess.PIPE, text=True, encoding="utf-8",
    )  # fmt: skip
    assert process.stdout is not None
    lines = []
    for line in process.stdout:
        print(line, end="", flush=True)
        lines.append(line)
    if process.wait() != 0:
        raise SystemExit(f"{command[0]}: exit code {process.returncode}")
    return "".join(lines)


def main() -> None:
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="TABLE", help=", ".join(TABLES))
    parser.add_argument("--list", action="store_true", help="names and files, nothing measured")
    parser.add_argument("--write", action="store_true", help="into docs/measurements and its page")
    given = parser.parse_args()
    unknown = sorted(set(given.names) - set(TABLES))
    if unknown:
        parser.error(f"no table {', '.join(unknown)}; there are {', '.join(TABLES)}")
    for name, command in TABLES.items():
        if given.names and name not in given.names:
            continue
        print(f"{name}: python benchmarks/{' '.join(command)}", flush=True)
        if given.list:
            continue
        if name == "scale":
            # Rows of peers and sizes with a CSV of their own, from which growth is fitted.
            measured((*command, "--write") if given.write else command)
            continue
        printed = measured(command)
        if given.write:
            subprocess.run(
                [sys.executable, str(FILLER), name], input=printed, text=True, check=True
            )
        print(flush=True)


if __name__ == "__main__":
    main()
