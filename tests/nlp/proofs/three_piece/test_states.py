"""Runs that are stopped and taken up again, and states that were altered."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from support.shipped_problems import COVERED_PROBLEMS
from support.unlucky import answering
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import resumed, state_document
from trajgap.problem import (
    TrajgapError,
)
from trajgap.verify import verify_certificate as verify

module = import_module("trajgap.nlp.proofs.three_piece.search")


def stopped_at(name: str, monkeypatch: pytest.MonkeyPatch) -> Certified:
    """A run that was stopped with a proved lower bound and with open boxes."""

    def interrupt(progress: Progress) -> None:
        if progress.lower > 0 and progress.open_boxes > 0:
            raise KeyboardInterrupt

    monkeypatch.setattr(module, "_BATCH", 8)
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
    for part in ("claim", "proof", "proposals"):
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
                session = Session(exact, Request(resume=state))
                pending = session.taken_up(partial(module._proposed, exact, "three-piece"))
            except TrajgapError:
                outcomes.append((part, "refused"))
                continue
            outcomes.append((part, "taken"))
            assert state.lower <= found.upper, path
            assert (state.proof is None) == (state.lower == 0)
            if state.durations is not None:
                assert keeps_limits(exact, state.durations), path
            assert pending is None or (0.5**pending.boxes.level).prod(axis=1).sum() == 1.0
    for part in ("claim", "proof", "proposals"):
        assert outcomes.count((part, "refused")) > 20
    assert outcomes.count(("proof", "taken")) > 0
    assert outcomes.count(("proposals", "taken")) > 20


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


def test_edited_open_boxes_only_cost_time(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "irb460-pso-353.limit-80.waypoints-rad"
    exact, found = COVERED_PROBLEMS[name], stopped_at(name, monkeypatch)
    state = state_of(found)
    # "Everything is proved by any row", and a total that is far too long.
    state["proposals"] |= {"tree": [[".", 0, "1"]], "total": "100"}
    again = certify(exact, gap=1e-3, resume=state)
    assert again.outcome is Outcome.CERTIFIED
    assert again.lower >= found.lower
    assert verify(certificate(again)).proves


@pytest.mark.parametrize(
    ("part", "change", "reason"),
    [
        ("proposals", {"kind": "stretched"}, "a state of kind"),
        ("proposals", {"tree": None}, "malformed"),
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
