"""Bounds over all motions for the shipped cases: the table of docs/certificates-any-curve.md.

Without options each problem is certified and its certificate written beside the others; problems
that differ in the declared curve alone share one. With --convergence the effort for several gaps
is printed instead.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction

from trajgap.nlp import certify
from trajgap.nlp.proofs.any_curve.exact import missing
from trajgap.nlp.proofs.document import (
    problem_document,
    question,
    shipped_folder,
    write_certificate,
)
from trajgap.nlp.proofs.exact import ExactProblem, printed_problem
from trajgap.problem import load_case, published_ids
from trajgap.verify import CertifiedQuestion, Subject, verify_certificate

GAPS = {"irb1600-ga-cubic-bspline": 1e-5}
GAP = 1e-9
HEAD = "| problem | lower (s) | upper (s) | gap | boxes | seconds | bytes | check (s) |"


def problems() -> Iterator[tuple[CertifiedQuestion, ExactProblem, float]]:
    """Every different question of the shipped cases, and the gap to reach."""
    seen = set()
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                if not statement.complete:
                    continue
                exact = printed_problem(statement)
                stated = question(problem_document(exact), Subject.ANY)
                asked = json.dumps(stated, sort_keys=True, default=str)
                if missing(exact) is None and asked not in seen:
                    seen.add(asked)
                    ids = CertifiedQuestion(case_id, problem.id, reading.id)
                    yield ids, exact, GAPS.get(case_id, GAP)


def nine(value: Fraction, rounding: Callable[[Fraction], int]) -> str:
    """Nine decimals, rounded outwards."""
    return f"{Decimal(rounding(value * 10**9)).scaleb(-9):.9f}"


def line(asked: CertifiedQuestion, exact: ExactProblem, gap: float, seconds: float) -> str:
    """Certify, write, and prove again."""
    name = f"{asked.case}.{asked.problem}.{asked.reading}"
    path = shipped_folder() / f"{name}.any-curve.json"
    found = certify(exact, subject=Subject.ANY, gap=gap, seconds=seconds)
    size = write_certificate(found, path, asked)
    began = time.perf_counter()
    verdict = verify_certificate(path)
    check = time.perf_counter() - began
    assert verdict.proves, verdict
    assert found.upper is not None
    return (
        f"| `{path.stem}` | {nine(found.lower, math.floor)} | {nine(found.upper, math.ceil)} "
        f"| {found.gap:.1e} | {found.nodes} | {found.seconds:.1f} | {size} | {check:.1f} |"
    )


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
        print("|---" * (HEAD.count("|") - 1) + "|")
    for asked, exact, gap in problems():
        name = f"{asked.case}.{asked.problem}.{asked.reading}"
        if options.only and not name.startswith(tuple(options.only)):
            continue
        if not options.convergence:
            print(line(asked, exact, gap, options.seconds), flush=True)
            continue
        print(f"\n{name}\n\n| asked | outcome | gap | boxes | seconds |\n|---|---|---|---|---|")
        for wanted in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9):
            print(convergence(exact, wanted, options.seconds), flush=True)


if __name__ == "__main__":
    main()
