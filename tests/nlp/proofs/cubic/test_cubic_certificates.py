"""Certificates of C2 cubic splines: closed forms, identities, both systems, and altered states."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from support.alterations import places, put
from support.checkout import ROOT
from support.proof_problems import NATURAL, cubic_problem, random_cubic
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic.bound import TOTAL, Target, Weights
from trajgap.nlp.proofs.cubic.certifier import CUBIC
from trajgap.nlp.proofs.cubic.ranges import a_priori, narrowed
from trajgap.nlp.proofs.cubic.relaxation import Relaxation
from trajgap.nlp.proofs.cubic.system import CubicSystem, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover, TickBox, _floats
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    load_case,
)
from trajgap.verify import MOST_INTEGER, TICKS, Refused, read_problem
from trajgap.verify import verify_certificate as verify
from trajgap.verify.cubic.box import Box
from trajgap.verify.cubic.weights import least
from trajgap.verify.reading import Clock

# --- closed forms and identities ------------------------------------------------------------------


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


# --- solver and verifier --------------------------------------------------------------------------


def prover_of(problem: Problem, total: Fraction | None = None) -> Prover:
    """What carries out steps below a total; of 11 units of time by default."""
    stated = read_problem(problem_document(exact_problem(problem)))
    if total is not None:
        return Prover(cubic_system(stated, total))
    system = cubic_system(stated, Fraction(11))
    return Prover(CubicSystem(stated, system.powers, system.second, 11 * TICKS))


@pytest.mark.parametrize("seed", range(8))
def test_floats_are_the_verifier_s_equations_and_conditions(seed: int) -> None:
    system, rng = prover_of(random_cubic(seed)).system, np.random.default_rng(seed)
    y, x = rng.normal(size=system.coordinates), rng.normal(size=system.exact.size)

    def value(terms: dict[Any, Fraction]) -> float:
        pairs = ((key, float(a)) for key, a in terms.items())
        return sum(a * (x[k] if isinstance(k, int) else y[k[0]] * x[k[1]]) for k, a in pairs)

    own = (system.fixed + np.tensordot(y, system.linear, 1)) @ x
    assert own == pytest.approx([value(row) for row in system.exact.equations], rel=1e-12)
    for row in system.starting_rows():
        _, terms, along, constant = system.exact.condition(list(row))
        expected = value(terms) + sum(float(a) * y[k] for k, a in along.items()) + float(constant)
        dense = system.terms(row)
        found = dense.alone @ x + y @ dense.product @ x + dense.along @ y + dense.constant
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_weights_without_the_target_prove_nothing_about_it() -> None:
    prover = prover_of(cubic_problem())
    box = prover.root()
    prover.narrow(box)
    relaxation = Relaxation(prover.system, prover.system.starting_rows())
    found = relaxation.over(prover.side(box), box.ranges).bound(Target(0, -1))
    assert prover.bound(box, Target(0, -1), found.weights) is not None
    assert prover.bound(box, Target(0, -1), replace(found.weights, scale=0)) is None


EXAMPLE = ROOT / "docs" / "examples" / "gasparetto-zanotto2008.toml"


# --- attacks --------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def interrupted() -> Certified:
    def report(progress: Progress) -> None:
        if progress.nodes >= 12 and progress.open_boxes >= 3:
            raise KeyboardInterrupt

    return certify(cubic_problem(), gap=1e-3, report=report)


def test_an_altered_state_is_refused() -> None:
    def stop(_: Progress) -> None:
        raise KeyboardInterrupt

    document = json.loads(json.dumps(state_document(interrupted())))
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
    # The paper's compromise between time and jerk is no least time, and lies above.
    assert verdict.upper < Fraction("9.05")
    assert len(json.dumps(document)) < 200_000
    page = (ROOT / "docs" / "explanation" / "certificates-cubic.md").read_text("utf-8")
    line = next(x for x in page.splitlines() if x.startswith(f"| `{EXAMPLE.stem}` | 5 |"))
    printed = [Fraction(cell.strip()) for cell in line.split("|")[3:5]]
    assert [float(x) for x in printed] == pytest.approx(
        [float(verdict.lower), float(verdict.upper)], abs=6e-5
    )


def around(prover: Prover, y: np.ndarray, width: float) -> TickBox:
    """A box around some coordinates."""
    root = prover.root()
    root.low = [int(z * (1 - width) * TICKS) for z in y]
    root.high = [int(z * (1 + width) * TICKS) + 1 for z in y]
    prover.trim(root)
    return root


def _nothing(system: CubicSystem) -> list[list[Any]]:
    return [[None] * system.exact.size for _ in range(system.exact.joints)]


def verifier_is_as_strong(prover: Prover, root: TickBox, slack: float) -> None:
    """The verifier's ranges are those that the search relied on, or narrower."""
    side = prover.side(root)
    found = narrowed(prover.system, side, *a_priori(prover.system, side))
    assert found is not None
    box = Box(prover.system.exact, list(root.low), list(root.high), _nothing(prover.system), 0)
    box.narrow(Clock(60.0))
    for j, row in enumerate(box.x):
        for v, bounds in enumerate(row):
            low, high = found[0][v, j], found[1][v, j]
            if bounds is None:
                assert not np.isfinite(high)
                continue
            assert float(bounds[0]) >= low - slack * (1.0 + abs(low))
            assert float(bounds[1]) <= high + slack * (1.0 + abs(low))


def near_feasible(seed: int) -> tuple[Prover, np.ndarray, np.random.Generator]:
    """A random problem without bounds of durations, and coordinates of feasible ones."""
    problem, rng = random_cubic(seed), np.random.default_rng(seed)
    problem = replace(problem, duration_lower=0.0, duration_upper=np.inf)
    h = rng.uniform(0.5, 2.0, problem.segments)
    h *= float(evaluate(problem, h[None]).stretch[0]) * 1.001
    prover = prover_of(problem, Fraction(float(1.2 * h.sum())))
    ends = np.concatenate([[0.0], np.cumsum(h)])[prover.system.exact.breaks]
    virtual = prover.system.exact.virtual
    y = np.append(np.diff(ends), [h[0], h[-1]] if virtual else [])
    return prover, y / 2.0**prover.system.second, rng


@pytest.mark.parametrize("seed", range(8))
def test_ranges_of_the_verifier_are_those_of_the_search(seed: int) -> None:
    """Boxes around feasible durations; tests/verify has the splines that lie within."""
    prover, y, _ = near_feasible(seed)
    for width in (0.02, 0.2, 0.6):
        verifier_is_as_strong(prover, around(prover, y, width), 1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_stated_is_below_what_the_verifier_proves(seed: int) -> None:
    """Random weights over boxes: rounding is on the safe side, and by little."""
    prover, y, rng = near_feasible(seed)
    system, box = prover.system, around(prover, y, 0.2)
    assert not box.closed
    own = Box(system.exact, list(box.low), list(box.high), _nothing(system), 0)
    own.narrow(Clock(60.0))
    box.ranges = _floats(own)
    rows, size = system.starting_rows(), system.exact.size
    equations = [(j, i) for j in range(system.exact.joints) for i in range(size)]
    for _ in range(6):
        held = {rows[i]: int(w) for i, w in enumerate(rng.integers(0, 2**22, len(rows))) if w % 3}
        pulled = {pair: int(w) for pair, w in zip(
            equations, rng.integers(-(2**22), 2**22, len(equations)), strict=True)}  # fmt: skip
        shape = (system.exact.joints, system.coordinates, size)
        weights = Weights(2**20, held, pulled, rng.integers(0, 33, shape))
        found = prover.bound(box, TOTAL, weights)
        head, equal, mix = prover._stated(weights)
        known = [system.exact.condition(list(row)) for row in head[::2]]
        numbered = [x for i, w in enumerate(head[1::2]) for x in (i, w)]
        total = dict.fromkeys(range(system.exact.m), 2**20)
        try:
            exact = least(own, total, [numbered, equal, mix], known) * TICKS / 2**20
        except Refused:
            assert found is None
            continue
        assert found is not None
        assert found <= exact
        # The verifier tries more tangents of ρ, where there is one.
        near = float(exact - found) <= 1e-9 * (1.0 + abs(float(exact)))
        assert system.exact.virtual or near


@pytest.mark.parametrize("seed", range(6))
def test_ranges_of_a_span_that_almost_vanishes_are_the_same_on_both_sides(seed: int) -> None:
    # Coincident way-points and a velocity limit alone: nothing keeps the span from 0.
    rng = np.random.default_rng([44, seed])
    q = np.array([[-0.3], [-0.3], [0.8], [0.4]]) if seed % 2 else np.array([[-0.3], [0.8], [0.8]])
    prover = prover_of(Problem(q, Limits([1.0]), cubic_spline_virtual(len(q))))
    spans = prover.system.exact.m
    y = rng.uniform(1.0, 3.0, prover.system.free)
    k, h = (0, spans) if seed % 2 else (spans - 1, spans + 1)
    y[k] = rng.uniform(1e-6, 4e-6)
    y[spans], y[spans + 1] = 0.4 * y[0], 0.6 * y[spans - 1]
    y[h] = 0.7 * y[k]
    verifier_is_as_strong(prover, around(prover, y, 1e-3), 1e-9)
