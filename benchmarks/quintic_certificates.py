"""Certified intervals of the twenty C4 quintic problems: boxes, seconds, bytes.

``python benchmarks/quintic_certificates.py [--gap G] [--seconds S] [--every N] [--first F]
[--workers N] [--write FILE.csv]`` prints a line per problem, and writes the table of
docs/explanation/certificates-quintic.md. Seconds of the clock hold everything that `certify` does:
the search for the answer, the proof, and proving the result again; processor seconds are those of
all processes.
"""

from __future__ import annotations

import argparse
import csv
import json
import time
from pathlib import Path

from on_cores import processor
from quintic_instances import instances
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate_text
from trajgap.problem import Problem
from trajgap.verify import verify_certificate

COLUMNS = ("problem", "interval (s)", "boxes", "processor s", "clock s", "bytes", "proved again, s")


def measured(problem: Problem, gap: float, seconds: float, workers: int) -> tuple[str, ...]:
    """Certify one problem: a row of the table."""
    began, clock = processor(), time.perf_counter()
    found = certify(problem, gap=gap, seconds=seconds, workers=workers)
    spent, passed = processor() - began, time.perf_counter() - clock
    assert found.upper is not None
    assert found.gap <= gap, (problem.name, found.gap)
    text = certificate_text(found)
    began = time.process_time()
    verdict = verify_certificate(json.loads(text), seconds=600.0)
    assert verdict.proves, verdict
    again = time.process_time() - began
    interval = f"[{float(found.lower):.6f}, {float(found.upper):.6f}]"
    boxes, size = str(found.nodes), str(len(text))
    return problem.name, interval, boxes, f"{spent:.1f}", f"{passed:.1f}", size, f"{again:.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gap", type=float, default=0.01)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    certify(instances()[0], gap=0.3)  # compile
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    rows = []
    for problem in instances()[given.first :: given.every]:
        rows.append(measured(problem, given.gap, given.seconds, given.workers))
        print(f"| {' | '.join(map(str, rows[-1]))} |", flush=True)
    if given.write is not None:
        with given.write.open("w", encoding="utf-8", newline="") as file:
            command = f"--gap {given.gap:g} --workers {given.workers}"
            file.write(f"# python benchmarks/quintic_certificates.py {command}\n")
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
