"""Runs that are stopped and taken up again, and states that were altered."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.shipped_problems import COVERED_PROBLEMS
from support.unlucky import answering
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import resumed, state_document
from trajgap.problem import (
    TrajgapError,
)
from trajgap.verify import verify_certificate as verify


def often(monkeypatch: pytest.MonkeyPatch, boxes: int) -> None:
    """Report after every few boxes, however fast they are."""
    monkeypatch.setattr("trajgap.verify.declared._LEAVES", boxes)
    monkeypatch.setattr("trajgap.nlp.proofs.declared.search.Curves.part", boxes)
    monkeypatch.setattr("trajgap.nlp.proofs.session.Session.often", 0.0)


def test_a_stopped_run_goes_on_where_it_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    exact = COVERED_PROBLEMS["puma560-mnam-pso-353.six-joints.durations-positive.joint-1"]

    def interrupt(progress: Progress) -> None:
        if progress.lower > 0 and progress.nodes > 150 and progress.open_boxes > 0:
            raise KeyboardInterrupt

    often(monkeypatch, 16)
    first = certify(exact, report=interrupt)
    assert first.outcome is Outcome.INTERVAL
    assert first.open_boxes > 0
    assert first.lower > 0
    assert 1e-6 < first.gap < 1
    assert verify(certificate(first)).proves
    second = certify(exact, resume=first)
    assert second.outcome is Outcome.CERTIFIED
    assert second.nodes < 800
    assert verify(certificate(second)).proves


def stopped_at(name: str, monkeypatch: pytest.MonkeyPatch) -> Certified:
    """A run that was stopped with a proved lower bound and with open boxes."""

    def interrupt(progress: Progress) -> None:
        if progress.lower > 0 and progress.open_boxes > 0:
            raise KeyboardInterrupt

    often(monkeypatch, 8)
    found = certify(COVERED_PROBLEMS[name], report=interrupt)
    assert found.outcome is Outcome.INTERVAL
    return found


def state_of(found: Certified) -> dict[str, Any]:
    """The state of a stopped run, through JSON."""
    document = state_document(found)
    assert document is not None
    return dict(json.loads(json.dumps(document)))


def test_an_edited_state_proves_nothing_false(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    assert found.upper is not None
    base = state_of(found)
    assert resumed(exact, base).lower == found.lower
    rng = np.random.default_rng(3)
    outcomes = []
    for part in ("claim", "proof"):
        places = state_places(base[part], (part,))
        for _ in range(50):
            path = places[rng.integers(0, len(places))]
            data = copy.deepcopy(base)
            node = data
            for key in path[:-1]:
                node = node[key]
            node[path[-1]] = mangled(node[path[-1]], rng)
            try:
                state = resumed(exact, data)
            except TrajgapError:
                outcomes.append((part, "refused"))
                continue
            outcomes.append((part, "taken"))
            assert state.lower <= found.upper, path
            assert (state.proof is None) == (state.lower == 0)
            if state.durations is not None:
                assert keeps_limits(exact, state.durations), path
    for part in ("claim", "proof"):
        assert outcomes.count((part, "refused")) > 20
    assert outcomes.count(("proof", "taken")) > 0


def state_places(node: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    children = node.items() if isinstance(node, dict) else enumerate(node)
    found = []
    for key, child in children:
        found.append((*path, key))
        if isinstance(child, dict | list):
            found += state_places(child, (*path, key))
    return found


def mangled(value: Any, rng: np.random.Generator) -> Any:
    choice = int(rng.integers(0, 5))
    if choice == 0:
        return [None, [], "", {}, -1, "1e9", "x", True][int(rng.integers(0, 8))]
    if isinstance(value, bool) or value is None:
        return "1"
    if isinstance(value, int):
        return value + int(rng.choice([-1, 1, 5]))
    if value == ".":
        return ["?", "/", "r", "x"][int(rng.integers(0, 4))]
    if isinstance(value, str) and value[:1].isdigit():
        return str(Fraction(value) * (1 + Fraction(int(rng.integers(-9, 9)), 10)))
    if isinstance(value, list):
        return value[:-1]
    return value


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


def test_a_proof_that_is_not_one_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    found = stopped_at(name, monkeypatch)
    state = state_of(found)
    total = state["proof"]["total"]
    state["proof"]["total"] = str(found.upper)
    why = r"not proved .(leaf at node \d+: )?a leaf with limits is not proved"
    with pytest.raises(TrajgapError, match=why):
        certify(COVERED_PROBLEMS[name], resume=state)
    state["proof"]["total"] = total
    state["proof"]["tree"][-1] = ["?"]
    with pytest.raises(TrajgapError, match=r"not proved .the tree leaves a part open"):
        certify(COVERED_PROBLEMS[name], resume=state)


def test_a_state_is_proved_like_a_certificate(monkeypatch: pytest.MonkeyPatch) -> None:
    found = stopped_at("irb460-pso-353.limit-80.waypoints-rad", monkeypatch)
    verdict = verify(state_of(found))
    assert str(verdict).startswith("proves: ")
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
