"""Attacks on certificates of cubic splines, and runs that are stopped and taken up again."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from support.alterations import changed, get, places, put
from support.checkout import ROOT
from support.cubic_problems import NATURAL, base, base_problem, both, dense_best
from support.unjudged import unjudged
from support.unlucky import answering
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import (
    certifier as cubic_certify,
)
from trajgap.nlp.proofs.cubic import (
    ranges as cubic_ranges,
)
from trajgap.nlp.proofs.cubic import (
    tree as cubic_tree,
)
from trajgap.nlp.proofs.cubic.ranges import a_priori, narrowed
from trajgap.nlp.proofs.cubic.system import CubicSystem
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    load_case,
)
from trajgap.verify import MOST_INTEGER, TICKS
from trajgap.verify import verify_certificate as verify
from trajgap.verify.cubic.box import Box
from trajgap.verify.reading import Clock

EXAMPLE = ROOT / "docs" / "examples" / "gasparetto-zanotto2008.toml"


# --- attacks --------------------------------------------------------------------------------------


def unlucky(monkeypatch: pytest.MonkeyPatch, seconds: float) -> tuple[float, Certified]:
    """Certify with an answer 10 % above the best known and no search for a better one."""
    best = base()
    assert best.durations is not None
    worse = tuple(h * Fraction(11, 10) for h in best.durations)

    answering(monkeypatch, lambda call, initial: worse)
    monkeypatch.setattr(cubic_certify._Watch, "improve", lambda *_: None)
    return float(best.upper or 0), certify(base_problem(), gap=0.02, seconds=seconds)


def test_an_answer_that_is_not_optimal_is_never_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    optimum, found = unlucky(monkeypatch, 4.0)
    assert found.outcome is Outcome.INTERVAL
    assert 0.5 * optimum < found.lower <= optimum


def test_a_broken_relaxation_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    true = cubic_ranges.implied
    base()

    def broken(system: CubicSystem, cap: Fraction) -> list[tuple[float, float]]:
        return [(0.7 * v, 0.7 * a) for v, a in true(system, cap)]

    for module in (cubic_ranges, cubic_tree, cubic_certify):
        monkeypatch.setattr(module, "implied", broken)
    raw = unjudged(monkeypatch)
    optimum, found = unlucky(monkeypatch, 20.0)
    assert raw[-1].lower > optimum, "the attack above would not have seen it"
    assert not verify(certificate(raw[-1])).proves
    assert (found.outcome, found.lower, found.proof) == (Outcome.OPEN, 0, None)


def test_a_worse_local_answer_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    best = base()
    assert best.durations is not None
    double = tuple(h * 2 for h in best.durations)
    calls = answering(monkeypatch, lambda call, initial: double if call == 1 else True)
    found = certify(base_problem(), gap=0.02)
    assert len(calls) > 1
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.upper or 0) == pytest.approx(float(best.upper or 0), rel=1e-6)
    assert verify(certificate(found)).proves


@lru_cache(maxsize=1)
def interrupted() -> Certified:
    def report(progress: Progress) -> None:
        if progress.nodes >= 12 and progress.open_boxes >= 3:
            raise KeyboardInterrupt

    return certify(base_problem(), gap=1e-3, report=report)


def test_a_stopped_run_goes_on_where_it_stopped() -> None:
    first = interrupted()
    assert first.outcome is Outcome.INTERVAL
    assert first.proposals is not None
    assert first.open_boxes > 0
    assert 1e-3 < first.gap < 1
    assert verify(certificate(first)).proves
    state = json.loads(json.dumps(state_document(first)))
    assert verify(state).lower == first.lower
    second = certify(base_problem(), gap=5e-3, resume=state)
    assert second.outcome is Outcome.CERTIFIED
    assert verify(certificate(second)).proves
    whole = certify(base_problem(), gap=5e-3)
    assert second.nodes < whole.nodes


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
                found = certify(base_problem(), gap=1e-3, resume=wrong, report=stop)
            except TrajgapError as error:
                refused += "resume" in str(error)
                continue
            assert found.lower <= (base().upper or 0)
        # The root of a proposal is not read: it is computed.
        assert refused > 0 or key == "root"

    def wrong_in(part: str, **change: Any) -> dict[str, Any]:
        return {**document, part: {**document[part], **change}}

    with pytest.raises(TrajgapError, match="kind"):
        certify(base_problem(), resume=wrong_in("proposals", kind="declared"))
    with pytest.raises(TrajgapError, match="malformed"):
        certify(base_problem(), resume={**document, "proposals": {"kind": "cubic"}})
    # As a power of ten it would fill the memory.
    with pytest.raises(TrajgapError, match="malformed"):
        certify(base_problem(), resume=wrong_in("claim", durations=["1e999999999"] * 2))


def test_no_time_gives_what_mean_velocities_say() -> None:
    found = certify(base_problem(), seconds=0.0)
    assert found.outcome is Outcome.INTERVAL
    assert float(found.lower) == pytest.approx(1.1 / 1.1 + 0.7 / 0.9, rel=1e-6)
    assert verify(certificate(found)).proves


def test_durations_that_no_trajectory_keeps_are_proved_infeasible() -> None:
    p = base_problem()
    best = base()
    assert best.durations is not None
    upper = [float(h) * 0.9 for h in best.durations]
    found = certify(Problem(p.waypoints, p.limits, p.curve, 0.0, upper))
    assert found.outcome is Outcome.INFEASIBLE
    document = certificate(found)
    verdict = verify(document)
    assert verdict.proves
    assert verdict.infeasible
    document["problem"]["duration_upper"] = [str(h * 2) for h in best.durations]
    assert not verify(document).proves


def test_durations_far_too_short_are_proved_infeasible_within_the_range_of_a_proof() -> None:
    # Mean speeds alone ask for 100 s each: more ticks than the integers of a proof may have.
    problem = Problem([[0.0], [1.0], [2.0], [3.0]], Limits(0.01, 1.0), cubic_spline(3), 0.0, 5.0)
    found = certify(problem)
    assert found.outcome is Outcome.INFEASIBLE
    assert found.verdict is not None
    assert found.verdict.infeasible
    document = certificate(found)
    assert max(document["proof"]["root"]) <= document["proof"]["cap"] <= MOST_INTEGER


def test_a_spline_that_is_too_long_for_a_certificate_is_not_covered() -> None:
    many = Problem(np.arange(66.0)[:, None], Limits(1.0, 1.0), cubic_spline(65))
    with pytest.raises(TrajgapError, match="more than 64 segments"):
        certify(many)


def test_what_is_not_covered_is_said() -> None:
    q = [[0.2], [1.1], [-0.4]]
    with pytest.raises(TrajgapError, match="nothing limits"):
        certify(Problem(q, Limits(np.inf, 2.0), cubic_spline(2, NATURAL)))
    with pytest.raises(TrajgapError, match="segment 1: no limit of a joint that moves in it"):
        certify(Problem(q[:2], Limits(1.0), cubic_spline_virtual(2)))


@lru_cache(maxsize=1)
def small() -> str:
    """A certificate with few steps and every kind of number in it, as JSON."""
    q = [[0.25], [1.0], [-0.375]]
    limits = Limits([1.0], [2.0], [8.0])
    problem = Problem(q, limits, cubic_spline(2), (0.5, 0.25), (6.0, 5.0))
    return json.dumps(certificate(certify(problem, gap=0.0005)))


def stated(data: dict[str, Any]) -> Problem:
    """The problem in a certificate, by a second route."""
    p = data["problem"]

    def numbers(row: list[Any], absent: float) -> list[float]:
        return [absent if x is None else float(Fraction(x)) for x in row]

    v, a, j = np.array([numbers(row, np.inf) for row in p["limits"]]).T
    return Problem(
        np.array([numbers(row, 0.0) for row in p["waypoints"]]),
        Limits(v, a, j),
        cubic_spline(2),
        numbers(p["duration_lower"], 0.0),
        numbers(p["duration_upper"], np.inf),
    )


def mutate_all(per_place: int, seed: int) -> dict[str, int]:
    rng = np.random.default_rng(seed)
    counts = {"refused": 0, "still proves": 0}
    for path in places(json.loads(small())):
        for _ in range(per_place):
            data = json.loads(small())
            put(data, path, changed(get(data, path), rng))
            verdict = verify(data)
            counts["still proves" if verdict.proves else "refused"] += 1
            if verdict.proves:
                assert verdict.lower is not None
                best = dense_best(stated(data), 2000)
                assert float(verdict.lower) <= best * (1 + 1e-9), path
                assert verdict.infeasible <= (best == np.inf)
    return counts


def test_no_altered_number_proves_a_false_statement() -> None:
    counts = mutate_all(1, 0)
    assert counts["refused"] > counts["still proves"] > 0


@pytest.mark.slow
def test_no_altered_number_proves_a_false_statement_many_times() -> None:
    counts = mutate_all(40, 1)
    assert min(counts.values()) > 100


def test_the_example_s_certificate_is_fresh_and_proves() -> None:
    case = load_case(EXAMPLE)
    exact = printed_problem(case.statement(case.problems[0].id, case.readings[0].id))
    document = json.loads(EXAMPLE.with_suffix(".certificate.json").read_text("utf-8"))
    assert document["problem"] == problem_document(exact), "run benchmarks/cubic_certificates.py"
    verdict = verify(document)
    assert verdict.proves
    assert not verdict.altered
    assert verdict.lower is not None
    assert verdict.upper is not None
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


@pytest.mark.parametrize("seed", range(6))
def test_ranges_of_a_span_that_almost_vanishes_are_the_same_on_both_sides(seed: int) -> None:
    # Coincident way-points and a velocity limit alone: nothing keeps the span from 0.
    rng = np.random.default_rng([44, seed])
    q = np.array([[-0.3], [-0.3], [0.8], [0.4]]) if seed % 2 else np.array([[-0.3], [0.8], [0.8]])
    first = seed % 2 == 1
    problem = Problem(q, Limits([1.0]), cubic_spline_virtual(len(q)))
    prover, cubic = both(problem, 11 * TICKS)
    spans, root = prover.system.spans, prover.root()
    y = rng.uniform(1.0, 3.0, prover.system.free)
    k, h = (0, spans) if first else (spans - 1, spans + 1)
    y[k] = rng.uniform(1e-6, 4e-6)
    y[spans], y[spans + 1] = 0.4 * y[0], 0.6 * y[spans - 1]
    y[h] = 0.7 * y[k]
    root.low = [int(z * (1 - 1e-3) * TICKS) for z in y]
    root.high = [int(z * (1 + 1e-3) * TICKS) + 1 for z in y]
    prover.trim(root)
    side = prover.side(root)
    found = narrowed(prover.system, side, *a_priori(prover.system, side, prover.total))
    assert found is not None
    box = Box(cubic, list(root.low), list(root.high), [[None] * cubic.size], 0)
    box.narrow(Clock(60.0))
    for v, bounds in enumerate(box.x[0]):
        assert bounds is not None
        slack = 1e-9 * (1.0 + abs(found[1][v, 0]))
        assert float(bounds[0]) >= found[0][v, 0] - slack
        assert float(bounds[1]) <= found[1][v, 0] + slack
