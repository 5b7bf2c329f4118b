"""Write the certificates of the shipped cases and print the table of docs/certificates.md."""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction

from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import shipped_folder, write_certificate
from trajgap.nlp.proofs.exact import ExactProblem, printed_problem
from trajgap.problem import Coupling, load_case, published_ids
from trajgap.verify import CertifiedQuestion, verify_certificate

HEAD = "| problem | lower (s) | upper (s) | gap | boxes | seconds | bytes | check (s) |"


def problems() -> Iterator[tuple[str, CertifiedQuestion, ExactProblem]]:
    """Every shipped problem that is covered; each joint too where joints are optimised alone."""
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                if not statement.complete:
                    continue
                exact = printed_problem(statement)
                if covered(exact) is not None:
                    continue
                name = f"{case_id}.{problem.id}.{reading.id}"
                ids = (case_id, problem.id, reading.id)
                yield name, CertifiedQuestion(*ids), exact
                if len(exact.joints) > 1 and statement.coupling is Coupling.PER_JOINT:
                    for j, label in enumerate(exact.joints):
                        asked = CertifiedQuestion(*ids, label)
                        yield f"{name}.joint-{label}", asked, exact.joint(j)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of names; all by default")
    only = tuple(parser.parse_args().only)
    shipped_folder().mkdir(exist_ok=True)
    print(HEAD)
    print("|---" * (HEAD.count("|") - 1) + "|")
    for name, asked, exact in problems():
        if not only or name.startswith(only):
            print(line(name, asked, exact), flush=True)


def nine(value: Fraction, rounding: Callable[[Fraction], int]) -> str:
    """Nine decimals, rounded outwards."""
    return f"{Decimal(rounding(value * 10**9)).scaleb(-9):.9f}"


def line(name: str, asked: CertifiedQuestion, exact: ExactProblem) -> str:
    path = shipped_folder() / f"{name}.json"
    found = certify(exact)
    size = write_certificate(found, path, asked)
    began = time.perf_counter()
    verdict = verify_certificate(path)
    seconds = time.perf_counter() - began
    assert verdict.proves, verdict
    assert found.upper is not None
    return (
        f"| `{name}` | {nine(found.lower, math.floor)} | {nine(found.upper, math.ceil)} "
        f"| {found.gap:.1e} "
        f"| {found.nodes} | {found.seconds:.1f} | {size} | {seconds:.1f} |"
    )


if __name__ == "__main__":
    main()
