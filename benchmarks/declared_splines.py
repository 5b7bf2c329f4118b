"""Cubic and quintic splines of few segments: boxes of durations beside their own kinds of proof.

The table stands in docs/explanation/certificates-declared.md. Each instance of the suite is proved
to the width of its row, from the answer in it; `--seconds` of the processor limit each proof.
"""

from __future__ import annotations

import argparse
import time

from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import CUBIC
from trajgap.nlp.proofs.declared import DECLARED
from trajgap.nlp.proofs.exact import ExactProblem, printed_problem
from trajgap.nlp.proofs.outcome import Outcome, Progress
from trajgap.nlp.proofs.quintic import QUINTIC
from trajgap.problem.suite import list_instances

KINDS = {"cubic": CUBIC, "natural": CUBIC, "virtual": CUBIC, "quintic": QUINTIC}
"""Own kinds, by the first word of a name."""
MOST = 7
"""Segments: beyond, boxes of durations are not asked."""


def measured(
    exact: ExactProblem, kind: Certifier, gap: float, known: tuple[float, ...], seconds: float
) -> str:
    """Boxes and processor seconds, and the width that was reached where it is not that asked for.

    Nothing, where the kind does not cover the problem.
    """
    if kind.missing(exact) is not None:
        return "not covered"
    began = time.process_time()

    def stop(now: Progress) -> None:
        if time.process_time() - began > seconds:
            raise KeyboardInterrupt

    found = certify(exact, gap=gap, seconds=36_000.0, known=known, certifier=kind, report=stop)
    spent = f"{found.nodes}, {time.process_time() - began:.1f}"
    return spent if found.outcome is Outcome.CERTIFIED else f"{spent}: {found.gap:.0e}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="of instances; all of these kinds by default")
    parser.add_argument("--seconds", type=float, default=15.0)
    asked = parser.parse_args()
    print("| instance | width | own kind | boxes of durations |\n|---|---|---|---|")
    for one in list_instances():
        kind = KINDS.get(one.name.partition("-")[0])
        if kind is None or (asked.names and one.name not in asked.names):
            continue
        case = one.case()
        exact = printed_problem(case.statement(*case.selections()[0]))
        if exact.segments > MOST:
            continue
        gap = 1.02 * one.width  # some room for what is rounded
        both = (measured(exact, k, gap, one.durations, asked.seconds) for k in (kind, DECLARED))
        print(f"| `{one.name}` | {one.width:.0e} | {' | '.join(both)} |", flush=True)


if __name__ == "__main__":
    main()
