"""Bounds over all motions for the shipped cases, and their table.

The table stands in docs/explanation/certificates-any-curve.md.
Without options each problem is certified and its certificate written beside the others; problems
that differ in the declared curve alone share one. With --convergence the effort for several gaps
is printed instead.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator

from certificates import HEAD, line, named, statements
from trajgap.nlp import certify
from trajgap.nlp.proofs.any_curve.exact import missing
from trajgap.nlp.proofs.document import problem_document, question
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.verify import CertifiedQuestion, Subject

GAPS = {"irb1600-ga-cubic-bspline": 1e-5}
GAP = 1e-9


def problems() -> Iterator[tuple[CertifiedQuestion, ExactProblem, float]]:
    """Every different question of the shipped cases, and the gap to reach."""
    seen = set()
    for asked, _, exact in statements():
        stated = question(problem_document(exact), Subject.ANY)
        same = json.dumps(stated, sort_keys=True, default=str)
        if missing(exact) is None and same not in seen:
            seen.add(same)
            yield asked, exact, GAPS.get(str(asked.case), GAP)


def convergence(exact: ExactProblem, gap: float, seconds: float) -> str:
    """Boxes and seconds for one gap."""
    found = certify(exact, subject=Subject.ANY, gap=gap, seconds=seconds)
    return (
        f"| {gap:.0e} | {found.outcome} | {found.gap:.1e} | {found.nodes} | {found.seconds:.1f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of names; all by default")
    parser.add_argument("--seconds", type=float, default=120.0, help="limit for each")
    parser.add_argument("--convergence", action="store_true")
    options = parser.parse_args()
    if not options.convergence:
        print(HEAD)
    for asked, exact, gap in problems():
        name = named(asked)
        if options.only and not name.startswith(tuple(options.only)):
            continue
        if not options.convergence:
            found = certify(exact, subject=Subject.ANY, gap=gap, seconds=options.seconds)
            print(line(f"{name}.any-curve", asked, found), flush=True)
            continue
        print(f"\n{name}\n\n| asked | outcome | gap | boxes | seconds |\n|---|---|---|---|---|")
        for wanted in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9):
            print(convergence(exact, wanted, options.seconds), flush=True)


if __name__ == "__main__":
    main()
