"""Write the certificates of the shipped cases and print their table.

The table stands in docs/explanation/certificates.md.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import shipped_folder, write_certificate
from trajgap.nlp.proofs.evidence import printed_problem_or_none
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.nlp.proofs.outcome import Certified
from trajgap.problem import Coupling, load_case, published_ids
from trajgap.problem.cases import Statement
from trajgap.verify import CertifiedQuestion, verify_certificate

HEAD = (
    "| problem | lower (s) | upper (s) | gap | boxes | seconds | bytes | check (s) |\n"
    "|---|---|---|---|---|---|---|---|"
)


def statements() -> Iterator[tuple[CertifiedQuestion, Statement, ExactProblem]]:
    """Every shipped problem under every reading that has way-points."""
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                exact = printed_problem_or_none(statement) if statement.complete else None
                if exact is not None:
                    yield CertifiedQuestion(case_id, problem.id, reading.id), statement, exact


def named(asked: CertifiedQuestion) -> str:
    joint = "" if asked.joint is None else f".joint-{asked.joint}"
    return f"{asked.case}.{asked.problem}.{asked.reading}{joint}"


def problems() -> Iterator[tuple[CertifiedQuestion, ExactProblem]]:
    """Every shipped problem that is covered; each joint too where joints are optimised alone."""
    for asked, statement, exact in statements():
        if covered(exact) is not None:
            continue
        yield asked, exact
        if len(exact.joints) > 1 and statement.coupling is Coupling.PER_JOINT:
            for j, label in enumerate(exact.joints):
                yield replace(asked, joint=label), exact.joint(j)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of names; all by default")
    only = tuple(parser.parse_args().only)
    shipped_folder().mkdir(exist_ok=True)
    print(HEAD)
    for asked, exact in problems():
        if not only or named(asked).startswith(only):
            print(line(named(asked), asked, certify(exact)), flush=True)


def nine(value: Fraction, rounding: Callable[[Fraction], int]) -> str:
    """Nine decimals, rounded outwards."""
    return f"{Decimal(rounding(value * 10**9)).scaleb(-9):.9f}"


def line(name: str, asked: CertifiedQuestion, found: Certified) -> str:
    """Write what was found, and prove it again."""
    path = shipped_folder() / f"{name}.json"
    size = write_certificate(found, path, asked)
    began = time.perf_counter()
    verdict = verify_certificate(path)
    seconds = time.perf_counter() - began
    assert verdict.proves, verdict
    assert found.upper is not None
    return (
        f"| `{name}` | {nine(found.lower, math.floor)} | {nine(found.upper, math.ceil)} "
        f"| {found.gap:.1e} | {found.nodes} | {found.seconds:.1f} | {size} | {seconds:.1f} |"
    )


if __name__ == "__main__":
    main()
