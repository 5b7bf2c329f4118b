"""The time limit of a certification: states, search and judging share it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from trajgap.nlp.proofs import judged, session, state
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import replay
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.session import OutOfTime, Session
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Limits, Problem, TrajgapError, cubic_spline, cubic_spline_virtual
from trajgap.verify import CertificateVerdict, Subject
from trajgap.verify import verify_certificate as verify

LATE = CertificateVerdict(False, False, "nothing was decided", out_of_time=True)
Q = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
QUICK = Problem(Q, Limits([1.1, 0.9], [1.9, 2.3]), cubic_spline(2))
LONG = Problem(Q[:, :1], Limits([1.1], [1.9], [7.0]), cubic_spline_virtual(3))


def interrupted(progress: Progress) -> None:
    if progress.nodes >= 4 and progress.open_boxes >= 2:
        raise KeyboardInterrupt


@lru_cache(maxsize=1)
def text() -> str:
    """The state of a run that was interrupted after some boxes."""
    return json.dumps(state_document(certify(LONG, gap=1e-3, report=interrupted)))


def stopped() -> dict[str, Any]:
    return dict(json.loads(text()))


def test_a_resumed_run_without_time_replays_nothing_and_loses_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = stopped()
    monkeypatch.setattr(state, "verify_certificate", lambda document, **_: verify(document))
    steps: list[Any] = []
    monkeypatch.setattr(replay, "_again", lambda *data: steps.append(data))
    found = certify(LONG, gap=1e-3, seconds=0.0, resume=given)
    assert not steps
    assert found.outcome is Outcome.INTERVAL
    assert (str(found.lower), str(found.upper)) == tuple(
        str(Fraction(given["claim"][side])) for side in ("lower", "upper")
    )
    again = state_document(found)
    assert again is not None
    assert again["proposals"] == given["proposals"]


@pytest.mark.parametrize("subject", list(Subject))
def test_what_is_not_judged_in_time_is_not_certified_and_can_be_resumed(
    monkeypatch: pytest.MonkeyPatch, subject: Subject
) -> None:
    asked: list[float] = []

    def late(_: Any, seconds: float, spread: Any = None) -> CertificateVerdict:
        asked.append(seconds)
        return LATE

    with monkeypatch.context() as patch:
        patch.setattr(judged, "verify_certificate", late)
        found = certify(QUICK, gap=0.01, seconds=50.0, subject=subject)
    (seconds,) = asked
    assert 0 < seconds < 50.0 + judged.SPARE
    assert found.outcome is Outcome.OPEN
    assert (found.lower, found.proof, found.verdict) == (0, None, LATE)
    assert found.upper is not None
    kept = json.loads(json.dumps(state_document(found)))
    assert kept["proof"] is None
    assert kept["proposals"] is not None
    assert verify(kept).proves
    finished = certify(QUICK, gap=0.01, resume=kept, subject=subject)
    assert finished.outcome is Outcome.CERTIFIED
    assert verify(certificate(finished)).proves


def test_what_a_state_proved_stays_if_the_rest_is_not_judged_in_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = stopped()
    monkeypatch.setattr(judged, "verify_certificate", lambda *_, **__: LATE)
    found = certify(LONG, gap=0.1, resume=given)
    assert found.lower == Fraction(given["claim"]["lower"]) > 0
    assert found.verdict is not None
    assert found.verdict.proves
    assert verify(certificate(found)).lower == found.lower
    assert found.proposals is not None
    monkeypatch.undo()
    again = certify(LONG, gap=0.1, resume=state_document(found))
    assert again.outcome is Outcome.CERTIFIED


def test_a_state_is_judged_within_the_time_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    given = stopped()
    asked: list[float] = []

    def late(_: Any, seconds: float, spread: Any = None) -> CertificateVerdict:
        asked.append(seconds)
        return LATE

    monkeypatch.setattr(state, "verify_certificate", late)
    with pytest.raises(TrajgapError, match="the state is not proved"):
        certify(LONG, seconds=7.0, resume=given)
    assert asked == [7.0 + judged.SPARE]


class Hands:
    """A clock that goes only when it is told to."""

    now = 0.0

    def perf_counter(self) -> float:
        return self.now


def waiting(monkeypatch: pytest.MonkeyPatch) -> tuple[Hands, Session]:
    hands = Hands()
    monkeypatch.setattr(session, "time", hands)
    return hands, Session(exact_problem(QUICK), Request(seconds=100.0))


def out_of_time(one: Session) -> bool:
    try:
        one.check_clock()
    except OutOfTime:
        return True
    return False


def test_a_search_leaves_time_for_judging(monkeypatch: pytest.MonkeyPatch) -> None:
    hands, one = waiting(monkeypatch)
    hands.now = 100.0 / (1.0 + session.JUDGING) - 0.01
    assert not out_of_time(one)
    hands.now += 0.02
    assert out_of_time(one)


def test_judging_is_measured_once_and_grows_with_the_proof(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hands, one = waiting(monkeypatch)
    proof = certify(QUICK, gap=0.1).proof
    assert proof is not None
    hands.now = 0.0
    calls: list[float] = []

    def slow(document: Any, seconds: float, spread: Any = None) -> CertificateVerdict:
        calls.append(seconds)
        assert document["proof"]["tree"]
        hands.now += 20.0
        return LATE

    monkeypatch.setattr(session, "verify_certificate", slow)
    weigh: Callable[[int], None] = lambda boxes: one.weigh(boxes, lambda: proof)  # noqa: E731
    hands.now = 100.0 * session.EARLY - 0.1
    weigh(10)
    assert not calls
    hands.now = 30.0
    weigh(0)
    assert not calls
    weigh(10)
    assert calls == [70.0]
    each = session.SAFE * 20.0 / 10.0
    weigh(int(50.0 / each))
    assert not out_of_time(one)
    weigh(int(50.0 / each) + 1)
    assert out_of_time(one)
    # A stage that begins anew has few boxes; the proof that is kept has as many as before.
    weigh(1)
    assert out_of_time(one)
    assert len(calls) == 1


def test_cubic_searches_say_how_large_their_proof_is(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes: list[int] = []
    real = Session.weigh

    def weigh(one: Session, boxes: int, proof: Callable[[], Any]) -> None:
        sizes.append(boxes)
        real(one, boxes, proof)

    monkeypatch.setattr(Session, "weigh", weigh)
    certify(LONG, gap=1e-3, report=interrupted)
    assert sizes[0] == 0
    assert max(sizes) >= 2
    given = stopped()
    sizes.clear()

    def stop(_: Progress) -> None:
        raise KeyboardInterrupt

    certify(LONG, gap=1e-3, resume=given, report=stop)
    assert sizes[0] >= 1, "a replayed tree counts"


def test_the_judge_has_a_second_even_if_the_time_is_over() -> None:
    found: Certified = certify(QUICK, gap=0.01)
    again = judged.judged(replace(found, verdict=None), judged.Deadline.after(-5.0))
    assert again.verdict is not None
    assert again.verdict.proves
    assert import_module("trajgap.nlp.proofs.judged").Deadline.after(-5.0).left == 0.0
