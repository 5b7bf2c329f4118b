"""C4 quintic intervals: bounds against sampled curves, dense search, broken limits, stops."""

from __future__ import annotations

import json
import runpy
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from support.checkout import ROOT
from support.unjudged import unjudged
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.quintic.bound import bound
from trajgap.nlp.proofs.quintic.nodal import centre
from trajgap.nlp.proofs.quintic.rows import row_shape
from trajgap.nlp.proofs.quintic.windows import window, window_bound, window_terms
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Limits, Problem, TrajgapError, evaluate, quintic_spline
from trajgap.verify import QUINTIC_PLACES, seal
from trajgap.verify import verify_certificate as verify
from trajgap.verify.quintic import QuinticSpline
from trajgap.verify.quintic_bound import Bound, Task

module = import_module("trajgap.nlp.proofs.quintic.certifier")


@pytest.mark.parametrize("seed", range(16))
def test_the_bound_of_a_box_is_that_of_the_verifier(seed: int) -> None:
    """Which tests/verify compares with sampled curves."""
    rng = np.random.default_rng(seed)
    n, joints, count = int(rng.integers(2, 6)), 3, 5
    h0, width = np.exp(rng.uniform(-0.5, 0.5, n)), [0.01, 0.04, 0.08, 0.15][seed % 4]
    q = rng.uniform(-1.0, 1.0, (n + 1, joints))
    low, high = 1.0 / (h0 * np.exp(width)), 1.0 / (h0 * np.exp(-width))
    r, e = 0.5 * (low + high), 0.5 * (high - low)
    size = 2 * (n - 1)
    matrix, inverse = np.empty((size, size)), np.empty((size, size))
    x0, slope = np.empty((joints, size)), np.empty((joints, n, size))
    step = np.diff(q, axis=0)
    assert centre(n, joints, r, step, matrix, inverse, x0, slope)
    segment, joint = rng.integers(0, n, count), rng.integers(0, joints, count)
    order, spot = np.array([1, 2, 3, 1, 2]), rng.integers(0, QUINTIC_PLACES + 1, count)
    limits = rng.uniform(0.5, 3.0, (joints, 3))
    sign, limit = rng.choice([-1, 1], count), limits[joint, order - 1]
    weight, shape = rng.integers(1, 10, count).astype(float), np.empty((count, 5))
    for i in range(count):
        row_shape(order[i], float(sign[i]), spot[i], shape[i])
    tau, total = float(rng.integers(-9, 10)), float(h0.sum())

    centred = (n, joints, r, e, step, total, matrix, inverse, x0, slope)
    rows = (segment, joint, 2 - order, limit, shape, weight)
    least = float(bound(*centred, *rows, tau, np.empty(n)))
    task = Task(step, limits, total, np.stack([segment, joint, order, sign, spot], axis=1))
    leaf = np.array([tau]), np.arange(count)[None], weight[None]
    proved = Bound(task, (1 / high)[None], (1 / low)[None], *leaf).least()[0]
    assert proved == pytest.approx(least, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("limited", [(1.0, 2.0), (np.inf, 2.0), (1.0, np.inf)])
def test_a_window_never_excludes_a_feasible_motion(limited: tuple[float, float]) -> None:
    rng = np.random.default_rng(5)
    velocity, acceleration = limited
    for _ in range(6):
        q = rng.uniform(-1.0, 1.0, (5, 1))
        problem = Problem(q, Limits(velocity, acceleration), quintic_spline(4))
        shares = rng.dirichlet(3.0 * np.ones(4), 60)
        feasible = shares * evaluate(problem, shares).stretch[:, None]
        step = np.diff(q[:, 0])
        found = window(step, feasible[0] * 0.6, velocity, acceleration)
        assert found is not None
        terms = window_terms(*found, step, velocity, acceleration)
        excluded = 0
        for h in feasible:
            assert window_bound(4, terms, h, h, 0.0, h.sum()) <= 0.0
            low, high = 0.8 * h, h
            middle = [window_bound(4, terms, x, x, 0.3, 1.0) for x in (low, high, 0.9 * h)]
            assert window_bound(4, terms, low, high, 0.3, 1.0) <= min(middle)
            excluded += window_bound(4, terms, 0.3 * h, 0.3 * h, 0.0, 1.0) > 0.0
        assert excluded > 0


@pytest.mark.slow
def test_a_row_of_the_docs_is_proved_again() -> None:
    page = (ROOT / "docs" / "explanation" / "certificates-quintic.md").read_text("utf-8")
    problems = runpy.run_path(str(ROOT / "benchmarks" / "quintic_instances.py"))["instances"]()
    assert sum(f"| {problem.name} | [" in page for problem in problems) == 20
    problem = next(p for p in problems if p.name == "step 3.0 rad, number 2")
    found = certify(problem, gap=0.01, seconds=600.0)
    interval = f"[{float(found.lower):.6f}, {float(found.upper):.6f}]"
    assert f"| {problem.name} | {interval} |" in page
    assert verify(json.loads(json.dumps(certificate(found)))).proves


def small() -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    return Problem(q, Limits([1.0, 0.9], [2.0, 1.5]), quintic_spline(3))


def test_limits_falsified_on_purpose_prove_too_much_and_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    truth = certify(small(), gap=0.01)
    limits: Callable[[Any], np.ndarray] = module._limits
    monkeypatch.setattr(module, "_limits", lambda problem: 0.9 * limits(problem))
    false = unjudged(monkeypatch)
    judged = certify(small(), gap=0.01)
    assert (judged.outcome, judged.proof) == (Outcome.OPEN, None)
    own = module.OwnUnits(exact_problem(small()))
    assert (own.powers, own.second) == ([0, 0], 0)
    session = Session(exact_problem(small()), Request())
    session.durations = truth.durations
    stages = module.Stages(session)
    too_much = stages.stage(stages.rounded(truth.upper * Fraction(101, 100)))
    assert too_much.total > truth.upper
    document = certificate(false[0])
    document["proof"], document["claim"]["lower"] = too_much.document(), str(truth.upper)
    document["seal"] = seal({key: x for key, x in document.items() if key != "seal"})
    verdict = verify(document)
    assert not verdict.proves
    assert "not proved" in verdict.reason


def stopped(after: int) -> Certified:
    """A run that is interrupted at a certain report."""
    count = 0

    def report(progress: Progress) -> None:
        nonlocal count
        count += 1
        if count == after:
            raise KeyboardInterrupt

    return certify(small(), gap=1e-3, report=report)


def test_a_proof_that_contradicts_the_answer_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    found = certify(small(), gap=0.1)
    document = certificate(found)
    monkeypatch.setattr(QuinticSpline, "leaf", lambda *_: None)
    assert verify(document).proves
    document["proof"]["total"] = "100"
    reason = "the proof contradicts the answer: one of them is wrong"
    assert verify(document).reason == reason
    # The solver says so, too.
    state = state_document(certify(small(), gap=0.1, seconds=0.0))
    state["claim"] |= {"durations": None, "upper": None, "lower": "100"}
    state["proof"] = document["proof"]
    with pytest.raises(TrajgapError, match="contradicts"):
        certify(small(), gap=0.1, resume=state)


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


def test_what_is_not_covered_is_said() -> None:
    problem = small()
    assert covered(exact_problem(problem)) is None
    free = replace(problem, limits=Limits([np.inf] * 2, [np.inf] * 2))
    assert "nothing limits" in str(covered(exact_problem(free)))
    jerk = replace(problem, limits=Limits([np.inf] * 2, [np.inf] * 2, [9.0] * 2))
    assert "no joint that moves" in str(covered(exact_problem(jerk)))
    assert covered(exact_problem(replace(jerk, duration_lower=np.full(3, 0.1)))) is None
    huge = replace(problem, waypoints=problem.waypoints * 1e61)
    assert "unusual size" in str(covered(exact_problem(huge)))
    many = Problem(np.zeros((30, 1)), Limits(1.0, 1.0), quintic_spline(29))
    assert "segments" in str(covered(exact_problem(many)))
