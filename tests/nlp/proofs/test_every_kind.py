"""Of every search but that of declared curves: dense searches, broken rows, stops."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.cubic_problems import base_problem
from support.cubic_problems import random_problem as random_cubic
from support.intervals import dense_best, judged
from support.own_kinds import own_kinds as own_kinds
from support.unjudged import unjudged
from support.unlucky import answering
from trajgap.nlp import solve
from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.certifiers import CERTIFIERS, certifiers, certify
from trajgap.nlp.proofs.cubic import certifier as cubic_certify
from trajgap.nlp.proofs.cubic import tree
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.verify import Subject, verify_certificate
from trajgap.verify.cubic import least

FOUR_THREE_FOUR = piecewise((4, 3, 4))
Patches = tuple[tuple[Any, str, Any], ...]


# --- dense searches -------------------------------------------------------------------------------


def random_quintic(seed: int) -> Problem:
    """Few segments and joints; some limits absent, some durations bounded from below."""
    rng = np.random.default_rng(seed)
    n, joints = int(rng.integers(2, 4)), int(rng.integers(1, 3))
    v, a, j = np.exp(rng.uniform(-0.7, 0.7, (3, joints))) * np.array([[1.0], [2.0], [12.0]])
    j = np.where(rng.random(joints) < 0.7, np.inf, j)
    v = np.where(rng.random(joints) < 0.2, np.inf, v)
    shortest = np.where(rng.random(n) < 0.2, 0.8, 0.0)
    waypoints = rng.uniform(-1.5, 1.5, (n + 1, joints))
    return Problem(waypoints, Limits(v, a, j), quintic_spline(n), shortest)


@dataclass(frozen=True)
class Drawn:
    """Random problems of a kind, which a search looks at that shares nothing with the proofs."""

    draw: Callable[[int], Problem]
    quick: range
    gap: float
    seconds: float
    many: range
    many_gap: float
    decided: int
    """So many of the many are certified or infeasible; without acceleration limits some last."""


DRAWN = {
    "cubic": Drawn(random_cubic, range(2), 0.1, 2.0, range(2, 204), 0.05, 150),
    "quintic": Drawn(random_quintic, range(6), 0.03, 600.0, range(100, 300), 0.005, 200),
}


def attack(kind: Drawn, seed: int, gap: float, seconds: float) -> Outcome:
    problem = kind.draw(seed)
    found = certify(problem, gap=gap, seconds=seconds)
    best = dense_best(problem)
    if found.outcome is Outcome.CERTIFIED:
        assert found.gap <= gap
        assert found.upper == sum(found.durations or ())
        assert kind is not DRAWN["quintic"] or float(found.upper) <= best * (1 + 2 * gap)
    return judged(problem, found, best)


@pytest.mark.parametrize(
    ("name", "seed"), [(name, seed) for name, kind in DRAWN.items() for seed in kind.quick]
)
def test_dense_search_never_leaves_the_interval(name: str, seed: int) -> None:
    attack(DRAWN[name], seed, DRAWN[name].gap, DRAWN[name].seconds)


@pytest.mark.slow
@pytest.mark.parametrize("name", DRAWN)
def test_dense_search_never_leaves_the_interval_of_two_hundred_problems(name: str) -> None:
    kind = DRAWN[name]
    seconds = max(20.0, kind.seconds)
    outcomes = [attack(kind, seed, kind.many_gap, seconds) for seed in kind.many]
    decided = outcomes.count(Outcome.CERTIFIED) + outcomes.count(Outcome.INFEASIBLE)
    assert decided >= kind.decided


# --- unlucky answers and broken rows --------------------------------------------------------------


def _high(*given: Any) -> Any:
    """Two fifths more than is proved."""
    return least(*given) * Fraction(7, 5)


QUIET_CUBIC: Patches = ((cubic_certify._Run, "_improve", lambda *_: None),)
HIGH: Patches = ((tree, "least", _high),)
UNLUCKY: dict[str, tuple[Problem, float, Patches, Patches]] = {
    "cubic": (base_problem(), 0.02, QUIET_CUBIC, HIGH),
}
"""A problem, its gap, what keeps a search from a better answer, and what breaks its rows."""


@cache
def truth(name: str) -> Certified:
    problem, gap, *_ = UNLUCKY[name]
    found = certify(problem, gap=gap)
    assert found.outcome is Outcome.CERTIFIED
    return found


def unlucky(name: str, seconds: float, patch: pytest.MonkeyPatch) -> tuple[Fraction, Certified]:
    """The optimum, and a run with an answer 5 % above it and no search for a better one."""
    problem, gap, quiet, _ = UNLUCKY[name]
    best = truth(name)
    assert best.upper is not None
    worse = tuple(h * Fraction(21, 20) for h in best.durations or ())
    answering(patch, lambda call, initial: worse)
    for owner, attribute, value in quiet:
        patch.setattr(owner, attribute, value)
    return best.upper, certify(problem, gap=gap, seconds=seconds)


@pytest.mark.parametrize("name", UNLUCKY)
def test_an_answer_that_is_not_optimal_is_never_certified(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    optimum, found = unlucky(name, 2.0, monkeypatch)
    assert found.outcome is Outcome.INTERVAL
    assert optimum / 2 < found.lower <= optimum


@pytest.mark.parametrize("name", UNLUCKY)
def test_a_broken_relaxation_is_caught(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    truth(name)
    for owner, attribute, value in UNLUCKY[name][-1]:
        monkeypatch.setattr(owner, attribute, value)
    raw = unjudged(monkeypatch)
    optimum, found = unlucky(name, 20.0, monkeypatch)
    assert raw[-1].lower > optimum, "the attack above would not have seen it"
    assert not verify_certificate(certificate(raw[-1])).proves
    assert (found.outcome, found.lower, found.proof) == (Outcome.OPEN, 0, None)


@pytest.mark.parametrize("name", ["cubic"])
def test_a_worse_local_answer_is_replaced(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, gap, *_ = UNLUCKY[name]
    best = truth(name)
    double = tuple(h * 2 for h in best.durations or ())
    calls = answering(monkeypatch, lambda call, initial: double if call == 1 else True)
    found = certify(problem, gap=gap)
    assert len(calls) > 1
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.upper or 0) == pytest.approx(float(best.upper or 0), rel=1e-6)


# --- infeasible -----------------------------------------------------------------------------------


def shortened(problem: Problem, k: int = 0) -> Problem:
    """An upper bound on one duration a little below what the problem asks of it."""
    upper = np.full(problem.segments, 99.0)
    upper[k] = 0.999 * solve(problem).durations[k]
    return replace(problem, duration_upper=upper)


def overshooting(curve: Any, roof: float, *way: float) -> Problem:
    return Problem(np.array(way)[:, None], Limits(1.0, 2.0, 8.0, -np.inf, roof), curve)


def too_short_cubic() -> Problem:
    upper = [float(h) * 0.9 for h in truth("cubic").durations or ()]
    return replace(base_problem(), duration_lower=0.0, duration_upper=upper)


WAY = [[0.0], [1.0], [0.5]]
LONGER = {"duration_upper": ["99"] * 3}
INFEASIBLE: dict[str, tuple[Callable[[], Problem], dict[str, list[str]]]] = {
    "3-5-3": (
        lambda: Problem(
            [[0.2], [1.1], [-0.4], [0.7]], Limits(1.0, 2.0), three_five_three(), 0.1, (4, 1.4, 4)
        ),
        LONGER,
    ),
    # It enters the middle piece from below at a way-point that is too high already.
    "3-5-3, position": (
        lambda: Problem(
            [[0.0], [1.0], [0.75], [0.0]], Limits(1.0, position_upper=0.9375), three_five_three()
        ),
        {"position_upper": ["1.5"]},
    ),
    # The first piece arrives at its way-point from above.
    "4-3-4, position": (
        lambda: overshooting(FOUR_THREE_FOUR, 0.4375, 0.0, 0.5, 0.3, -0.7),
        {"position_upper": ["0.75"]},
    ),
    "cubic": (too_short_cubic, {"duration_upper": ["9"] * 5}),
    "rest-to-rest": (
        lambda: Problem([[0.0], [1.0]], Limits(1.0), rest_to_rest(1, 5), 0.1, 1.8),
        {"duration_upper": ["1.9"]},
    ),
    "stretched": (
        lambda: shortened(Problem(WAY, Limits(1.0), uniform_cubic_b_spline(3, "stretched"))),
        {"duration_upper": ["9", "9"]},
    ),
    "fixed ratios": (
        lambda: shortened(Problem(WAY, Limits(1.0, 2.0), cubic_spline(2), ratios=[1, 1.75]), 1),
        {"duration_upper": ["9", "9"]},
    ),
}


@pytest.mark.parametrize("name", INFEASIBLE)
def test_what_no_durations_keep_is_proved_infeasible(name: str) -> None:
    problem, easier = INFEASIBLE[name]
    found = certify(problem())
    assert found.outcome is Outcome.INFEASIBLE
    assert "proved" in str(found)
    document = certificate(found)
    verdict = verify_certificate(document)
    assert verdict.proves
    assert verdict.infeasible
    assert verdict.upper is None
    document["problem"] |= easier
    assert not verify_certificate(document).proves


# --- stops ----------------------------------------------------------------------------------------


QUINTIC = Problem(
    np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]]),
    Limits([1.0, 0.9], [2.0, 1.5]),
    quintic_spline(3),
)
DETOUR = Problem(
    np.random.default_rng(5).normal(0.0, 1.0, (4, 2)).round(2),
    Limits([2.0, 1.5], [2.0, 3.0]),
    cubic_spline(3),
)
STOPPED: dict[str, tuple[Problem, Subject, float, Callable[[Progress, int], bool]]] = {
    "cubic": (
        base_problem(),
        Subject.DECLARED,
        0.02,
        lambda now, _: now.nodes >= 12 and now.open_boxes >= 3,
    ),
    "quintic": (QUINTIC, Subject.DECLARED, 1e-3, lambda _, reports: reports == 3),
    "any curve": (DETOUR, Subject.ANY, 1e-5, lambda now, _: now.nodes >= 1),
}


@pytest.mark.parametrize("name", STOPPED)
def test_a_stopped_run_goes_on_where_it_stopped(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, subject, gap, when = STOPPED[name]
    reports = 0

    def interrupt(now: Progress) -> None:
        nonlocal reports
        reports += 1
        if when(now, reports):
            raise KeyboardInterrupt

    first = certify(problem, subject=subject, gap=gap / 20, report=interrupt)
    assert first.outcome is Outcome.INTERVAL
    assert first.stopped
    assert 0 < first.lower < (first.upper or 0)
    assert verify_certificate(certificate(first)).lower == first.lower
    state = json.loads(json.dumps(state_document(first)))
    assert verify_certificate(state).lower == first.lower
    if name == "quintic":  # proved again in no time
        waited = certify(problem, gap=gap, seconds=0.0, resume=state)
        assert waited.lower == first.lower
    second = certify(problem, subject=subject, gap=gap, resume=state)
    assert second.outcome is Outcome.CERTIFIED
    assert second.gap <= gap
    assert second.lower >= first.lower
    assert verify_certificate(certificate(second)).proves
    if first.proposals is not None and subject is Subject.DECLARED:
        assert first.open_boxes > 0
        whole = truth(name) if name in UNLUCKY else certify(problem, gap=gap)
        assert second.nodes < whole.nodes
    other = replace(problem, waypoints=2.0 * problem.waypoints)
    with pytest.raises(TrajgapError, match="about another problem"):
        certify(other, subject=subject, resume=state)
    state["proof"]["total"] = str((second.upper or 0) * 2)
    with pytest.raises(TrajgapError, match="the state is not proved"):
        certify(problem, subject=subject, resume=state)


def test_every_entry_is_a_certifier() -> None:
    declared, every = certifiers(Subject.DECLARED), certifiers(Subject.ANY)
    assert all(isinstance(one, Certifier) for one in (*declared, *every))
    assert len({id(one) for one in (*declared, *every)}) == len(CERTIFIERS)
    assert len(every) == 1
    assert [one.instant for one in declared].index(True) == 0
