"""Gap of the certified interval against boxes and seconds on the twenty C4 quintic problems.

``python benchmarks/quintic_certificates.py [--gap G] [--seconds S] [--every N] [--first F]
[--verify] [--workers N]``: one line per problem and complete stage. Boxes are
cumulative; seconds are of the processor, with the time on the clock behind them.
"""

from __future__ import annotations

import argparse
import json
import time

from quintic_instances import instances
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Progress
from trajgap.problem import Problem
from trajgap.verify import verify_certificate


def line(problem: Problem, gap: float, seconds: float, check: bool, workers: int) -> None:
    """Certify one problem and print what each stage reached."""
    began, clock = time.process_time(), time.perf_counter()
    stages: list[tuple[float, int, float, float]] = []
    last, spent = Progress(0.0, 0.0, 1.0, 0, 0, 0.0), (0.0, 0.0)

    def report(progress: Progress) -> None:
        nonlocal last, spent
        spent = time.process_time() - began, time.perf_counter() - clock
        if progress.lower > last.lower:
            stages.append((progress.gap, progress.nodes, *spent))
        last = progress

    found = certify(problem, gap=gap, seconds=seconds, report=report, workers=workers)
    # Without the check of the proof, which ends `certify`.
    stages.append((found.gap, found.nodes, *spent))
    for reached, nodes, processor, wall in stages:
        print(f"| {problem.name} | {reached:.4f} | {nodes} | {processor:.1f} | {wall:.0f} |")
    assert found.upper is not None
    proved = ""
    if check and found.proof is not None:
        text = json.dumps(certificate(found))
        began = time.process_time()
        verdict = verify_certificate(json.loads(text), seconds=600.0)
        assert verdict.proves, verdict
        proved = f" {len(text)} bytes, proved again in {time.process_time() - began:.1f} s"
    interval = f"[{float(found.lower):.6f}, {float(found.upper):.6f}]"
    print(f"  {problem.name}: {interval} s, {found.outcome};{proved}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gap", type=float, default=0.01)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--verify", action="store_true")
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    certify(instances()[0], gap=0.3)  # compile
    print("| problem | gap | boxes | processor s | clock s |\n|---|---|---|---|---|")
    for problem in instances()[given.first :: given.every]:
        line(problem, given.gap, given.seconds, given.verify, given.workers)


if __name__ == "__main__":
    main()
