"""Certificates of C2 cubic splines: closed forms, identities, both systems, and altered states."""

import json
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from support.alterations import places, put
from support.checkout import ROOT
from support.proof_problems import NATURAL, cubic_problem, random_cubic
from support.proof_runs import state_of, stopped
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic.certifier import CUBIC
from trajgap.nlp.proofs.cubic.relaxation import BoxProgram, Relaxation
from trajgap.nlp.proofs.cubic.system import CubicSystem, capped, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Request
from trajgap.problem import Limits, Problem, TrajgapError, cubic_spline, load_case
from trajgap.verify import MOST_INTEGER, TICKS, read_problem, verify_certificate as verify


@pytest.mark.parametrize(
    ("limits", "total"),
    [
        (Limits(1.25), 1.5 * 3 / 1.25),
        (Limits(np.inf, 2.5), np.sqrt(6 * 3 / 2.5)),
        (Limits(np.inf, np.inf, 1.75), np.cbrt(12 * 3 / 1.75)),
    ],
)
def test_one_clamped_piece_has_a_closed_form(limits: Limits, total: float) -> None:
    problem = Problem([[-1.0], [2.0]], limits, cubic_spline(1))
    # `certify` prefers the closed form of rest-to-rest polynomials.
    found = CUBIC.run(exact_problem(problem), Request(gap=1e-3))
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.lower) <= total * (1 + 1e-12)
    assert float(found.upper or 0) == pytest.approx(total, rel=1e-7)
    assert verify(certificate(found)).proves


def test_a_natural_spline_along_a_line_has_constant_speed() -> None:
    problem = Problem([[0.5], [1.5], [4.5], [5.0]], Limits(1.5, 0.5), cubic_spline(3, NATURAL))
    found = certify(problem, gap=1e-4)
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.lower) <= 4.5 / 1.5 <= float(found.upper or 0) * (1 + 1e-12)


def prover_of(problem: Problem, total: Fraction | None = None) -> Prover:
    """What carries out steps below a total; of 11 units of time by default."""
    stated = read_problem(problem_document(exact_problem(problem)))
    if total is not None:
        return Prover(cubic_system(stated, total))
    units = cubic_system(stated, Fraction(11)).units
    return Prover(CubicSystem(stated, capped(stated, units["powers"], units["second"], 11 * TICKS)))


@pytest.mark.parametrize("seed", range(8))
def test_floats_are_the_verifier_s_equations_and_conditions(seed: int) -> None:
    system, rng = prover_of(random_cubic(seed)).system, np.random.default_rng(seed)
    y, x = rng.normal(size=system.exact.coordinates), rng.normal(size=system.exact.size)

    def value(terms: dict[Any, Fraction]) -> float:
        pairs = ((key, float(a)) for key, a in terms.items())
        return sum(a * (x[k] if isinstance(k, int) else y[k[0]] * x[k[1]]) for k, a in pairs)

    own = (system.fixed + np.tensordot(y, system.linear, 1)) @ x
    assert own == pytest.approx([value(row) for row in system.exact.equations], rel=1e-12)
    for row in system.starting_rows():
        _, terms, along, constant = system.exact.condition(list(row))
        expected = value(terms) + sum(float(a) * y[k] for k, a in along.items()) + float(constant)
        dense = system.terms(row)[1]
        found = dense.alone @ x + y @ dense.product @ x + dense.along @ y + dense.constant
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_weights_without_the_target_prove_nothing_about_it() -> None:
    prover = prover_of(cubic_problem())
    box = prover.root()
    prover.narrow(box)
    relaxation = Relaxation(prover.system, prover.system.starting_rows())
    found = BoxProgram(relaxation, box.own).bound({0: -1})
    assert prover.bound(box, found) is not None
    assert prover.bound(box, replace(found, target={0: 0})) is None


EXAMPLE = ROOT / "docs/examples/gasparetto-zanotto2008.toml"


@lru_cache(maxsize=1)
def interrupted() -> Certified:
    return stopped(cubic_problem(), lambda now: now.nodes >= 12 and now.open_boxes >= 3, gap=1e-3)


def test_an_altered_state_is_refused() -> None:
    stop = Mock(side_effect=KeyboardInterrupt)
    document = state_of(interrupted())
    rng = np.random.default_rng(0)
    for part, key in (("proposals", "tree"), ("proposals", "root"), ("proof", "tree")):
        found_places = [p for p in places({"proof": document[part]}) if p[1] == key]
        refused = 0
        for path in [found_places[i] for i in rng.integers(0, len(found_places), 2)]:
            wrong = json.loads(json.dumps(document))
            put({"proof": wrong[part]}, path, 2**27 + int(rng.integers(0, 2**20)))
            try:
                found = certify(cubic_problem(), gap=1e-3, resume=wrong, report=stop)
            except TrajgapError as error:
                refused += "resume" in str(error)
                continue
            assert found.lower <= (interrupted().upper or 0)
        # The root of a proposal is not read: it is computed.
        assert refused > 0 or key == "root"

    def wrong_in(part: str, **change: Any) -> dict[str, Any]:
        return {**document, part: {**document[part], **change}}

    with pytest.raises(TrajgapError, match="kind"):
        certify(cubic_problem(), resume=wrong_in("proposals", kind="declared"))
    with pytest.raises(TrajgapError, match="malformed"):
        certify(cubic_problem(), resume={**document, "proposals": {"kind": "cubic"}})
    # As a power of ten it would fill the memory.
    with pytest.raises(TrajgapError, match="malformed"):
        certify(cubic_problem(), resume=wrong_in("claim", durations=["1e999999999"] * 2))


def test_no_time_gives_what_mean_velocities_say() -> None:
    found = certify(cubic_problem(), seconds=0.0)
    assert found.outcome is Outcome.INTERVAL
    assert float(found.lower) == pytest.approx(1.1 / 1.1 + 0.7 / 0.9, rel=1e-6)
    assert verify(certificate(found)).proves


def test_durations_far_too_short_are_proved_infeasible_within_the_range_of_a_proof() -> None:
    # Mean speeds alone ask for 100 s each: more ticks than the integers of a proof may have.
    problem = Problem([[0.0], [1.0], [2.0], [3.0]], Limits(0.01, 1.0), cubic_spline(3), 0.0, 5.0)
    found = certify(problem)
    assert found.outcome is Outcome.INFEASIBLE
    assert found.verdict.infeasible
    document = certificate(found)
    assert max(document["proof"]["root"]) <= document["proof"]["cap"] <= MOST_INTEGER


def test_the_example_s_certificate_is_fresh_and_proves() -> None:
    case = load_case(EXAMPLE)
    exact = printed_problem(case.statement(case.problems[0].id, case.readings[0].id))
    document = json.loads(EXAMPLE.with_suffix(".certificate.json").read_text("utf-8"))
    assert document["problem"] == problem_document(exact), "run benchmarks/cubic_certificates.py"
    verdict = verify(document)
    assert verdict.proves
    assert not verdict.altered
    assert verdict.upper - verdict.lower <= verdict.upper / 100
    # The paper's compromise between time and jerk is not the least time, and lies above.
    assert verdict.upper < Fraction("9.05")
    assert len(json.dumps(document)) < 200_000
    page = (ROOT / "docs/explanation/certificates-cubic.md").read_text("utf-8")
    line = next(x for x in page.splitlines() if x.startswith(f"| `{EXAMPLE.stem}` | 5 |"))
    printed = [Fraction(cell.strip()) for cell in line.split("|")[3:5]]
    bounds = [float(verdict.lower), float(verdict.upper)]
    assert [float(x) for x in printed] == pytest.approx(bounds, abs=6e-5)
