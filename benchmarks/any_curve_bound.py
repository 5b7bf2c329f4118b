"""Bounds over all motions for the shipped cases, and their table.

The table stands in docs/explanation/certificates-any-curve.md.
Without options each problem is certified and its certificate written beside the others; problems
that differ in the declared curve alone share one. With --convergence the effort for several gaps
is printed instead; with --cores, which wants an idle machine, long proofs on one core and on two.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from functools import partial

import numpy as np
from certificates import HEAD, line, named, statements
from on_cores import CORES, on_cores
from trajgap.nlp import certify
from trajgap.nlp.proofs.any_curve.question import missing
from trajgap.nlp.proofs.document import problem_document, question
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.problem import Limits, Problem, cubic_spline
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


def seeded(waypoints: int, seed: int) -> Problem:
    """Six joints through random way-points (rad)."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.0, 1.0, (waypoints, 6))
    limits = Limits(rng.uniform(1.0, 2.0, 6), rng.uniform(1.0, 2.0, 6))
    return Problem(q, limits, cubic_spline(waypoints - 1))


def cores() -> None:
    """Long proofs on one core and on two."""
    ask = partial(certify, subject=Subject.ANY, gap=1e-6, seconds=300.0)
    ask(seeded(6, 2))  # imports
    print(CORES)
    for waypoints, seed in ((12, 2), (16, 1)):
        name = f"{waypoints} way-points, six joints, seed {seed}"
        print(on_cores(name, partial(ask, seeded(waypoints, seed))), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of names; all by default")
    parser.add_argument("--seconds", type=float, default=120.0, help="limit for each")
    parser.add_argument("--convergence", action="store_true")
    parser.add_argument("--cores", action="store_true", help="one core and two, when it is idle")
    options = parser.parse_args()
    if options.cores:
        return cores()
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
