"""Runs that are stopped and taken up again, and states that were altered."""

from __future__ import annotations

import json
from typing import Any

import pytest
from support.shipped_problems import COVERED_PROBLEMS
from support.unlucky import answering
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    TrajgapError,
)
from trajgap.verify import verify_certificate as verify


def stopped_at(name: str, monkeypatch: pytest.MonkeyPatch) -> Certified:
    """A run that was stopped with a proved lower bound and with open boxes."""

    def interrupt(progress: Progress) -> None:
        if progress.lower > 0 and progress.open_boxes > 0:
            raise KeyboardInterrupt

    # However fast boxes are, something is said after every few of them.
    monkeypatch.setattr("trajgap.verify.declared._LEAVES", 8)
    monkeypatch.setattr("trajgap.nlp.proofs.declared.search.Curves.part", 8)
    found = certify(COVERED_PROBLEMS[name], report=interrupt)
    assert found.outcome is Outcome.INTERVAL
    return found


def state_of(found: Certified) -> dict[str, Any]:
    """The state of a stopped run, through JSON."""
    document = state_document(found)
    assert document is not None
    return dict(json.loads(json.dumps(document)))


def test_a_resumed_bound_alone_proves_nothing_infeasible(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    state = state_of(found)
    state["claim"] |= {"durations": None, "upper": None}
    assert state["proof"] is not None
    assert None in exact.duration_upper
    answering(monkeypatch, lambda call, initial: None)
    again = certify(exact, resume=state)
    assert again.outcome is Outcome.OPEN
    assert again.lower == found.lower
    assert verify(certificate(again)).proves


@pytest.mark.parametrize(
    ("part", "change", "reason"),
    [
        ("claim", {"durations": ["0.1", "0.1", "0.1"]}, "not proved .answer"),
        ("claim", {"durations": ["0.4", "0.4"]}, "not proved .answer: one duration per segment"),
        ("claim", {"lower": "1e-9"}, "not proved .the lower bound exceeds the total"),
        ("problem", {"unit": "deg"}, "about another problem"),
    ],
)
def test_a_bad_state_is_refused(part: str, change: dict[str, Any], reason: str) -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    state = state_of(certify(exact, seconds=0.0))
    state[part] |= change
    with pytest.raises(TrajgapError, match=reason):
        certify(exact, resume=state)


def test_what_is_no_state_is_refused() -> None:
    exact = COVERED_PROBLEMS["irb460-pso-353.limit-80.waypoints-rad"]
    finished = certify(exact, gap=0.1)
    for other in (finished, certificate(finished), {}, {"format": "trajgap-state-1"}):
        with pytest.raises(TrajgapError, match="resume: no trajgap-state-2"):
            certify(exact, resume=other)
