"""Write the certificates of the shipped 3-5-3 cases and print the table of docs/certificates.md."""

from __future__ import annotations

import time
from pathlib import Path

from trajgap.nlp.certificate import shipped_folder, write_certificate
from trajgap.nlp.certify import certify, covered
from trajgap.nlp.exact import ExactProblem, printed_problem
from trajgap.nlp.verify import verify
from trajgap.problem import Interpolant, load_case, published_ids


def main() -> None:
    folder = shipped_folder()
    folder.mkdir(exist_ok=True)
    print("| problem | lower (s) | upper (s) | gap | boxes | seconds | bytes | check (s) |")
    print("|---|---|---|---|---|---|---|---|")
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                posing = case.posing(problem.id, reading.id)
                if not (posing.posed and isinstance(posing.interpolant(), Interpolant)):
                    continue
                exact = printed_problem(posing)
                if covered(exact) is not None:
                    continue
                name = f"{case_id}.{problem.id}.{reading.id}"
                line(name, exact, folder)
                if len(exact.joints) > 1:
                    for j, label in enumerate(exact.joints):
                        line(f"{name}.joint-{label}", exact.joint(j), folder)


def line(name: str, exact: ExactProblem, folder: Path) -> None:
    found = certify(exact)
    size = write_certificate(found, folder / f"{name}.json")
    began = time.perf_counter()
    verdict = verify(folder / f"{name}.json")
    seconds = time.perf_counter() - began
    assert verdict.proves, verdict
    assert found.upper is not None
    print(
        f"| `{name}` | {float(found.lower):.9f} | {float(found.upper):.9f} | {found.gap:.1e} "
        f"| {found.nodes} | {found.seconds:.1f} | {size} | {seconds:.1f} |",
        flush=True,
    )


if __name__ == "__main__":
    main()
