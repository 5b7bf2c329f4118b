"""C4 quintic intervals: bounds against sampled curves, dense search, broken limits, stops."""

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from support.benchmarks import benchmark
from support.checkout import ROOT
from support.proof_problems import QUINTIC
from support.proof_runs import unjudged
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import Real, exact_problem
from trajgap.nlp.proofs.outcome import Outcome, Request
from trajgap.nlp.proofs.quintic.windows import excluding_windows, window
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Limits, Problem, TrajgapError, evaluate, quintic_spline
from trajgap.verify import seal, verify_certificate as verify
from trajgap.verify.quintic import QuinticSpline

module = import_module("trajgap.nlp.proofs.quintic.certifier")


@pytest.mark.parametrize("limited", [(1.0, 2.0), (np.inf, 2.0), (1.0, np.inf)])
def test_a_window_never_excludes_a_feasible_motion(limited: tuple[float, float]) -> None:
    rng = np.random.default_rng(5)
    for _ in range(6):
        q = rng.uniform(-1.0, 1.0, (5, 1))
        problem = Problem(q, Limits(*limited), quintic_spline(4))
        shares = rng.dirichlet(3.0 * np.ones(4), 60)
        feasible = shares * evaluate(problem, shares).stretch[:, None]
        (found,) = window(np.diff(q, axis=0), feasible[0][:, None] * 0.6, np.array([limited]))
        session = Session(exact_problem(problem), Request())
        session.durations = tuple(Fraction(float(x)) for x in feasible[0])
        stages = module.QuinticStages(session)
        stages._windows = [[0, *found]]
        kind = stages.curves(stages.rounded(Fraction(1)))[0].kind
        one = np.zeros(len(feasible), int)
        total = feasible.sum(axis=1)
        # With no multiplier the total plays no part.
        assert (kind.over_windows(one, 0.0 * total, feasible, feasible) <= 0.0).all()
        low, high, tau = 0.8 * feasible, feasible, 0.3 + 0.0 * total
        middle = [kind.over_windows(one, tau, x, x) for x in (low, high, 0.9 * feasible)]
        assert (kind.over_windows(one, tau, low, high) <= np.min(middle, axis=0)).all()
        near = 0.3 * feasible
        assert (kind.over_windows(one, 0.0 * total, near, near) > 0.0).any()
        which, taus = excluding_windows(kind, near, near)
        assert (which >= 0).any()
        excluded = kind.over_windows(which, taus, near, near)[which >= 0]
        assert (excluded > 0.0).all()
        for h in feasible[:3]:  # of the total that the boxes are about
            kind = stages.curves(stages.rounded(Fraction(float(h.sum() * 1.001))))[0].kind
            which, _ = excluding_windows(kind, 0.9 * h[None], h[None] / 0.9)
            assert which == -1


@pytest.mark.slow
def test_a_row_of_the_docs_is_proved_again() -> None:
    page = (ROOT / "docs/explanation/certificates-quintic.md").read_text("utf-8")
    problems = benchmark("quintic_instances")["instances"]()
    assert sum(f"| {problem.name} | [" in page for problem in problems) == 20
    problem = next(p for p in problems if p.name == "step 3.0 rad, number 2")
    found = certify(problem, gap=0.01, seconds=600.0)
    interval = f"[{float(found.lower):.6f}, {float(found.upper):.6f}]"
    assert f"| {problem.name} | {interval} |" in page
    assert verify(json.loads(json.dumps(certificate(found)))).proves


def test_falsified_limits_prove_too_much_and_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    truth = certify(QUINTIC, gap=0.01)
    stated: Callable[[Any], Any] = module.stated_problem

    def tighter(problem: Any) -> Any:
        limits = [[x and Real(x.rational * Fraction(9, 10)) for x in row] for row in problem.limits]
        return stated(replace(problem, limits=tuple(map(tuple, limits))))

    monkeypatch.setattr(module, "stated_problem", tighter)
    false = unjudged(monkeypatch)
    judged = certify(QUINTIC, gap=0.01)
    assert (judged.outcome, judged.proof) == (Outcome.OPEN, None)
    own = module.OwnUnits(exact_problem(QUINTIC))
    assert (own.powers, own.second) == ([0, 0], 0)
    session = Session(exact_problem(QUINTIC), Request())
    session.durations = truth.durations
    stages = module.QuinticStages(session)
    too_much = stages.stage(stages.rounded(truth.upper * Fraction(101, 100)))
    assert too_much.total > truth.upper
    document = certificate(false[0])
    document["proof"], document["claim"]["lower"] = too_much.document(), str(truth.upper)
    document["seal"] = seal({key: x for key, x in document.items() if key != "seal"})
    verdict = verify(document)
    assert not verdict.proves
    assert "not proved" in verdict.reason


def test_a_proof_that_contradicts_the_answer_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    found = certify(QUINTIC, gap=0.1)
    document = certificate(found)
    monkeypatch.setattr(QuinticSpline, "leaf", lambda *_: None)
    document["proof"]["total"] = "100"
    state = state_document(certify(QUINTIC, gap=0.1, seconds=0.0))
    state["claim"] |= {"durations": None, "upper": None, "lower": "100"}
    state["proof"] = document["proof"]
    with pytest.raises(TrajgapError, match="contradicts"):
        certify(QUINTIC, gap=0.1, resume=state)


FAST = np.array([[0.0], [0.01], [0.005], [-0.01]])
"""Way-points, rad, that take about 1 ms at limits of 200 rad/s and 1.2e6 rad/s²."""


def test_motions_of_a_millisecond_are_proved_in_units_of_their_own() -> None:
    problem = Problem(FAST, Limits(200.0, 1.2e6), quintic_spline(3))
    found = certify(problem, gap=0.03, seconds=20.0)
    assert found.outcome is Outcome.CERTIFIED
    assert found.verdict.lower == found.lower
    proof = found.proof.document()
    assert proof["second"] < -8
    # The same motion in units of 2⁻¹⁰ s, which are powers of two and so spoil no digit.
    slow = Problem(FAST, Limits(200.0 / 2**10, 1.2e6 / 2**20), quintic_spline(3))
    again = certify(slow, gap=0.03, seconds=20.0)
    assert float(again.lower) == pytest.approx(float(found.lower) * 2**10, rel=1e-6)
