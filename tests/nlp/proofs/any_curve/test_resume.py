"""Runs for any curve that go on from a state: the answer, its speeds, boxes under a lower cap."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
import pytest
from trajgap.nlp.proofs.any_curve import certifier as any_curve_certify
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.exact import question
from trajgap.nlp.proofs.any_curve.proof import restored
from trajgap.nlp.proofs.any_curve.search import Search
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Limits, Problem, cubic_spline
from trajgap.verify import Subject
from trajgap.verify import verify_certificate as verify

certify_any = partial(certify, subject=Subject.ANY)


def proved(found: Certified) -> None:
    """The certificate of a result says the same."""
    verdict = verify(certificate(found))
    assert verdict.proves, verdict
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)


def detour() -> Problem:
    """One box does not settle it."""
    q = np.random.default_rng(5).normal(0.0, 1.0, (4, 2)).round(2)
    limits = Limits(np.array([2.0, 1.5]), np.array([2.0, 3.0]))
    return Problem(q, limits, cubic_spline(3), duration_upper=np.array([20.0, 30.0, 40.0]))


def stretched_first_motion(monkeypatch: pytest.MonkeyPatch, factor: float | None) -> None:
    """Let the local solver find a motion that takes ``factor`` times as long, or none."""
    real = estimate_any_curve

    def found(problem: Problem, **options: Any) -> Any:
        known = real(problem, **options)
        if factor is None:
            return replace(known, durations=None)
        assert known.durations is not None
        assert known.nodal_velocities is not None
        slow = known.nodal_velocities / factor
        return replace(known, durations=known.durations * factor, nodal_velocities=slow)

    monkeypatch.setattr(any_curve_certify, "estimate_any_curve", found)
    monkeypatch.setattr(any_curve_certify, "_local_motion", lambda *_: None)


def stopped_state(problem: Problem, after: int = 1) -> dict[str, Any]:
    """The state of a run that was stopped after some boxes."""

    def stop(progress: Progress) -> None:
        if progress.nodes >= after:
            raise KeyboardInterrupt

    stopped = certify_any(problem, gap=1e-9, report=stop)
    return dict(json.loads(json.dumps(state_document(stopped))))


@pytest.mark.parametrize("factor", [1.5, None])
def test_a_resumed_run_keeps_the_shorter_answer_with_its_own_speeds(
    monkeypatch: pytest.MonkeyPatch, factor: float | None
) -> None:
    state = stopped_state(detour())
    stretched_first_motion(monkeypatch, factor)
    found = certify_any(detour(), gap=0.1, resume=state)
    assert found.upper == Fraction(state["claim"]["upper"])
    assert found.speeds is not None
    assert [list(map(str, row)) for row in found.speeds] == [
        [str(Fraction(v)) for v in row] for row in state["claim"]["speeds"]
    ]
    proved(found)


def test_a_resumed_run_takes_a_shorter_answer_that_it_finds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with monkeypatch.context() as patch:
        stretched_first_motion(patch, 1.5)
        state = stopped_state(detour())
    found = certify_any(detour(), gap=0.1, resume=state)
    assert found.upper is not None
    assert found.upper < Fraction(state["claim"]["upper"]) * Fraction(3, 4)
    proved(found)


def test_a_state_of_a_higher_cap_is_resumed_below_a_lower_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Boxes that were cut beyond the total of the answer that is found later.
    with monkeypatch.context() as patch:
        stretched_first_motion(patch, None)
        state = stopped_state(detour(), after=30)
    assert state["claim"]["upper"] is None
    proof = state["proof"]
    search = Search(question(exact_problem(detour())), Fraction(5))
    whole = search.whole()
    assert whole is not None
    cuts = [node for node in proof["tree"] if node[0] == "/"]
    assert any(Fraction(at) >= whole[k][1] for _, k, at in cuts), "no cut lies beyond"
    root = restored(search, proof, 1.0)
    assert all(low < high for leaf in root.leaves for low, high in leaf.box)
    found = certify_any(detour(), gap=1e-3, resume=state)
    assert found.outcome is Outcome.CERTIFIED
    proved(found)


def test_an_interrupt_between_answer_and_boxes_leaves_a_true_pair(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with monkeypatch.context() as patch:
        stretched_first_motion(patch, 1.5)
        state = stopped_state(detour())

    def stop(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(any_curve_certify, "restored", stop)
    found = certify_any(detour(), resume=state)
    assert found.upper is not None
    assert found.upper < Fraction(state["claim"]["upper"]) * Fraction(3, 4)
    assert found.outcome is Outcome.INTERVAL
    proved(found)
