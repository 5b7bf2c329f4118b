"""Certified C2 cubic splines: tables, and the example's file.

The tables stand in docs/explanation/certificates-cubic.md.
Without arguments all tables but "cores"; with names of problems only their lines of the first; with
"widths" only the last. With "cores", which wants an idle machine, long proofs on one core and on
two: in seconds of the clock, and in processor seconds of all processes.
"""

from __future__ import annotations

import argparse
import json
import time
from functools import partial
from pathlib import Path

import numpy as np
from on_cores import CORES, on_cores
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import CUBIC
from trajgap.nlp.proofs.cubic.guide import peaks
from trajgap.nlp.proofs.cubic.relaxation import BoxProgram, Relaxation
from trajgap.nlp.proofs.cubic.system import CubicSystem, capped, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import certificate, stated_problem, write_certificate
from trajgap.nlp.proofs.exact import ExactProblem, exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    cubic_spline_virtual,
    load_case,
)
from trajgap.verify import TICKS, CertifiedQuestion, verify_certificate

EXAMPLE = Path(__file__).parents[1] / "docs" / "examples" / "gasparetto-zanotto2008.toml"
SECONDS = 300.0
GAPS = (0.1, 0.03, 0.01, 0.003, 0.001)
CHOSEN = ("gasparetto-zanotto2008", "clamped-8-seed-0", "virtual-6-seed-0")
LONG = ("virtual-6-seed-1", "virtual-8-seed-0", "clamped-6-only-j", "virtual-6-only-vj")
"""Whose proofs at 1 % take about ten processor seconds or more."""
WIDTHS = (0.2, 0.1, 0.05, 0.025, 0.0125)


def seeded(
    waypoints: int, kind: str, seed: int = 0, joints: int = 6, limits: str = "vaj"
) -> Problem:
    """Unequal joints through random way-points (rad), with the limits named."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.5, 1.5, (waypoints, joints))
    scale = rng.uniform(0.7, 1.3, (3, joints)) * [[1.5], [2.0], [6.0]]
    v, a, j = (row if name in limits else np.inf for row, name in zip(scale, "vaj", strict=True))
    curve = {
        "virtual": lambda: cubic_spline_virtual(waypoints),
        "clamped": lambda: cubic_spline(waypoints - 1),
        "natural": lambda: cubic_spline(waypoints - 1, ((2, 0.0),)),
    }[kind]()
    return Problem(q, Limits(v, a, j), curve)


def example() -> ExactProblem:
    case = load_case(EXAMPLE)
    return printed_problem(case.statement(case.problems[0].id, case.readings[0].id))


def problems() -> dict[str, ExactProblem]:
    found = {"gasparetto-zanotto2008": example()}
    for waypoints in (6, 7, 8):
        for kind in ("clamped", "natural", "virtual"):
            for seed in (0, 1):
                name = f"{kind}-{waypoints}-seed-{seed}"
                found[name] = exact_problem(seeded(waypoints, kind, seed))
    found["virtual-7-one-joint"] = exact_problem(seeded(7, "virtual", 3, 1))
    for kind, limits in (
        ("clamped", "v"),
        ("clamped", "a"),
        ("clamped", "j"),
        ("virtual", "va"),
        ("virtual", "vj"),
    ):
        found[f"{kind}-6-only-{limits}"] = exact_problem(seeded(6, kind, 0, 6, limits))
    return found


def line(name: str, exact: ExactProblem) -> str:
    found = certify(exact, gap=0.01, seconds=SECONDS, certifier=CUBIC)
    head = f"| `{name}` | {exact.segments} | {float(found.lower):.4f} "
    upper = "none" if found.upper is None else f"{float(found.upper):.4f}"
    head += f"| {upper} | {found.gap:.2%} | {found.nodes} | {found.seconds:.0f} "
    if found.proof is None:
        return head + "| | |"
    document = certificate(found)
    if name == "gasparetto-zanotto2008":
        case = load_case(EXAMPLE)
        asked = CertifiedQuestion(case.id, case.problems[0].id, case.readings[0].id)
        write_certificate(found, EXAMPLE.with_suffix(".certificate.json"), asked)
    size = len(json.dumps(document, separators=(",", ":")).encode())
    began = time.perf_counter()
    verdict = verify_certificate(document)
    assert verdict.proves, verdict
    return head + f"| {size / 1000:.0f} | {time.perf_counter() - began:.1f} |"


def by_gap(name: str, exact: ExactProblem) -> str:
    cells = []
    for gap in GAPS:
        found = certify(exact, gap=gap, seconds=SECONDS, certifier=CUBIC)
        reached = "" if found.gap <= gap else f" ({found.gap:.1%} reached)"
        cells.append(f"{found.nodes}, {found.seconds:.0f} s{reached}")
    return f"| `{name}` | " + " | ".join(cells) + " |"


def by_width(name: str, found: Certified) -> str:
    """Gap that one relaxation proves over a box of relative half-width w around the answer."""
    assert found.upper is not None
    stated = stated_problem(found.problem)
    near = cubic_system(stated, found.upper)
    unit = float(near.exact.second)
    h = np.array([float(x) for x in found.durations]) / unit
    cap = int(float(found.upper) / unit * 1.5 * TICKS)
    system = CubicSystem(stated, capped(stated, near.units["powers"], near.units["second"], cap))
    prover, exact = Prover(system), system.exact
    at = [
        sum(h[k] for k in range(exact.n) if exact.lengths[k].get(t, 0) > 0)
        for t in range(exact.free)
    ]
    for end, (first, _, _) in zip((0, exact.n - 1), exact.rho, strict=False):
        at[0 if end == 0 else exact.m - 1] += h[end]
        at[first] = h[end]
    gaps = []
    for width in WIDTHS:
        box = prover.root()
        box.own.low = [int(x * (1 - width) * TICKS) for x in at]
        box.own.high = [int(x * (1 + width) * TICKS) for x in at]
        prover.narrow(box)
        rows = system.starting_rows()
        for _ in range(10):
            program = BoxProgram(Relaxation(system, rows), box.own)
            proposal = program.bound(system.total, capped=False)
            assert proposal is not None
            new = [x for x in peaks(system, proposal.point[: exact.free]) if x not in rows]
            if not new:
                break
            rows += new
        bound = prover.bound(box, proposal)
        assert bound is not None
        gaps.append(1 - float(bound[0]) / TICKS * unit / float(found.upper))
    order = np.polyfit(np.log(WIDTHS[:4]), np.log(gaps[:4]), 1)[0]
    return f"| `{name}` | " + " | ".join(f"{g:.2e}" for g in gaps) + f" | {order:.1f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help="names of problems")
    only = parser.parse_args().only
    known = problems()
    if only == ["widths"]:
        return widths(known)
    if only == ["cores"]:
        return cores(known)
    print("| problem | pieces | lower (s) | upper (s) | gap | boxes | seconds | kB | check (s) |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, exact in known.items():
        if not only or name in only:
            print(line(name, exact), flush=True)
    if only:
        return
    print("\n| problem | " + " | ".join(f"gap {g:g}" for g in GAPS) + " |")
    print("|---" * (len(GAPS) + 1) + "|")
    for name in CHOSEN:
        print(by_gap(name, known[name]), flush=True)
    widths(known)


def cores(known: dict[str, ExactProblem]) -> None:
    certify(known["clamped-8-seed-0"], gap=0.1)  # compiles, imports
    print(CORES)
    for name in LONG:
        ask = partial(certify, known[name], gap=0.01, seconds=SECONDS, certifier=CUBIC)
        print(on_cores(f"`{name}`", ask), flush=True)


def widths(known: dict[str, ExactProblem]) -> None:
    print("\n| problem | " + " | ".join(f"w = {w:g}" for w in WIDTHS) + " | order |")
    print("|---" * (len(WIDTHS) + 2) + "|")
    for name in CHOSEN:
        print(by_width(name, certify(known[name], gap=0.1, certifier=CUBIC)), flush=True)


if __name__ == "__main__":
    main()
