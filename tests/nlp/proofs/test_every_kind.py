"""Of every search: dense searches, broken rows, stops."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from support.any_curve_proofs import DETOUR
from support.intervals import dense_best, judged
from support.proof_problems import (
    NATURAL,
    QUINTIC,
    cubic_problem,
    random_cubic,
    random_declared,
    random_in_motion,
    random_quintic,
)
from support.proof_runs import answering, own_kinds as own_kinds, state_of, unjudged
from support.puma import PUMA
from trajgap.nlp import solve
from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.certifiers import CERTIFIERS, certifiers, certify, covered
from trajgap.nlp.proofs.closed_form.formulas import MOST_REBUILT
from trajgap.nlp.proofs.cubic import certifier as cubic_certify, tree
from trajgap.nlp.proofs.declared import certifier as boxes, search
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import MOVING, ExactProblem, exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.problem import (
    Curve,
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    piecewise,
    quintic_spline,
    quintic_spline_virtual,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.verify import Subject, boxes as verified_boxes, verify_certificate
from trajgap.verify.cubic import least

Patches = tuple[tuple[Any, str, Any], ...]


@dataclass(frozen=True)
class Drawn:
    """Random problems of a kind, which a search looks at that shares nothing with the proofs."""

    draw: Callable[[int], Problem]
    quick: tuple[int, ...]
    gap: float
    seconds: float
    many: tuple[int, ...]
    many_gap: float
    decided: int
    """So many of the many are certified or infeasible; without acceleration limits some last."""
    boxes: float | None = None
    uncovered: int = 0
    """So many of the many no proof covers, at most."""


DRAWN = {
    "declared": Drawn(random_declared, (0, 2, 3), 1e-3, 20.0, (1, *range(4, 210)), 1e-3, 195),
    "in motion": Drawn(
        random_in_motion, (0, 2, 3, 4), 1e-3, 1e4, (1, *range(5, 205)), 1e-3, 120, 20_000, 19
    ),
    "cubic": Drawn(random_cubic, (0, 1), 0.1, 2.0, (*range(2, 204),), 0.05, 150),
    "quintic": Drawn(random_quintic, (*range(6),), 0.03, 600.0, (*range(100, 300),), 0.005, 200),
}


def attack(kind: Drawn, seed: int, gap: float, seconds: float) -> Outcome | None:
    problem = kind.draw(seed)
    if kind.uncovered and covered(exact_problem(problem)) is not None:
        return None
    found = certify(problem, gap=gap, seconds=seconds, boxes=kind.boxes)
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
    assert attack(DRAWN[name], seed, DRAWN[name].gap, DRAWN[name].seconds) is not None


@pytest.mark.slow
@pytest.mark.parametrize("name", DRAWN)
def test_dense_search_never_leaves_the_interval_of_two_hundred_problems(name: str) -> None:
    kind = DRAWN[name]
    seconds = max(20.0, kind.seconds)
    outcomes = [attack(kind, seed, kind.many_gap, seconds) for seed in kind.many]
    decided = outcomes.count(Outcome.CERTIFIED) + outcomes.count(Outcome.INFEASIBLE)
    assert decided >= kind.decided
    assert outcomes.count(None) <= kind.uncovered


def _high(*given: Any) -> Any:
    """Two fifths more than is proved."""
    return least(*given) * Fraction(7, 5)


def _too_strong(problem: ExactProblem, total: Fraction, true: Any = boxes._kind) -> Any:
    return true(problem, total * Fraction(9, 10))


PUMA_ALONE = Problem(PUMA[:, :1], Limits(6.0, 8.0), three_five_three())
QUIET_BOXES: Patches = ((boxes.BoxStages, "_look", lambda run, *_: run.session.check_clock()),)
QUIET_CUBIC: Patches = ((cubic_certify._Run, "_improve", lambda *_: None),)
HIGH: Patches = ((tree, "least", _high),)
UNLUCKY: dict[str, tuple[Problem, float, Patches, Patches]] = {
    "declared": (PUMA_ALONE, 1e-6, QUIET_BOXES, ((boxes, "_kind", _too_strong),)),
    "cubic": (cubic_problem(), 0.02, QUIET_CUBIC, HIGH),
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
def test_only_an_optimum_is_certified(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
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
    assert found.verdict is not None
    assert "not proved" in found.verdict.reason


@pytest.mark.parametrize("name", UNLUCKY)
def test_a_worse_local_answer_is_replaced(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem, gap, *_ = UNLUCKY[name]
    best = truth(name)
    double = tuple(h * 2 for h in best.durations or ())
    calls = answering(monkeypatch, lambda call, initial: double if call == 1 else True)
    found = certify(problem, gap=gap)
    assert len(calls) > 1
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.upper or 0) == pytest.approx(float(best.upper or 0), rel=1e-6)


def shortened(problem: Problem, k: int = 0) -> Problem:
    """An upper bound on one duration a little below what the problem asks of it."""
    upper = np.full(problem.segments, 99.0)
    upper[k] = 0.999 * solve(problem).durations[k]
    return replace(problem, duration_upper=upper)


def too_short_cubic() -> Problem:
    upper = [float(h) * 0.9 for h in truth("cubic").durations or ()]
    return replace(cubic_problem(), duration_lower=0.0, duration_upper=upper)


WAY = [[0.0], [1.0], [0.5]]
LONGER = {"duration_upper": ["99"] * 3}
INFEASIBLE: dict[str, tuple[Callable[[], Problem], dict[str, list[str]]]] = {
    "3-5-3": (
        lambda: Problem(
            [0.2, 1.1, -0.4, 0.7], Limits(1.0, 2.0), three_five_three(), 0.1, (4, 1.4, 4)
        ),
        LONGER,
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


FEW_BOXES: Patches = ((verified_boxes, "_LEAVES", 16), (search.Curves, "part", 16))
"""However fast boxes are, something is said after every few of them."""
STOPPED: dict[str, tuple[Problem, Subject, float, Callable[[Progress, int], bool]]] = {
    "declared": (
        PUMA_ALONE,
        Subject.DECLARED,
        1e-6,
        lambda now, _: now.lower > 0 and now.nodes > 150 and now.open_boxes > 0,
    ),
    "cubic": (
        cubic_problem(),
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
    for owner, attribute, value in FEW_BOXES if name == "declared" else ():
        monkeypatch.setattr(owner, attribute, value)
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
    state = state_of(first)
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
    with pytest.raises(TrajgapError, match="belongs to another problem"):
        certify(other, subject=subject, resume=state)
    state["proof"]["total"] = str((second.upper or 0) * 2)
    with pytest.raises(TrajgapError, match="the state is not proved"):
        certify(problem, subject=subject, resume=state)


def through(curve: Curve, within: Limits | None = None, **more: Any) -> Problem:
    """A problem of one joint that goes to and fro."""
    count = curve.segments + 1 - len(getattr(curve, "virtual", ()))
    way = np.resize([0.2, 1.1, -0.4, 0.7], (count, 1))
    return Problem(
        **{"waypoints": way, "limits": within or Limits(1.0, 2.0), "curve": curve, **more}
    )


INF, STILL = np.inf, [[0.0], [1.0], [1.0], [2.0]]
UNDETERMINED, AT_RATIOS = "the conditions do not determine the curve", {"ratios": "equal"}
MOVES = ((1, 0.5),)
UNCOVERED: list[tuple[str, Problem]] = [
    (UNDETERMINED, through(piecewise((5, 3, 5)))),
    (UNDETERMINED, through(quintic_spline(5, virtual=(1, 3)))),
    (UNDETERMINED, through(cubic_spline(5, virtual=(1, 4)))),
    ("no limit of a joint that moves in it", through(quintic_spline_virtual(2))),
    (
        "segment 2: no limit of a joint that moves in it, and no bound",
        through(three_five_three(), Limits(1.0), waypoints=STILL),
    ),
    ("covered are curves at fixed ratios", through(uniform_cubic_b_spline(4, "timed"))),
    ("nothing limits", through(three_five_three(), Limits())),
    ("nothing limits", through(cubic_spline(2, NATURAL), Limits(INF, 2.0))),
    ("nothing limits", through(quintic_spline(3), Limits())),
    ("keeps its duration above 0", through(cubic_spline_virtual(2), Limits(1.0))),
    ("more than 64 segments", through(cubic_spline(65))),
    ("no joint that moves", through(quintic_spline(3), Limits(INF, INF, 9.0))),
    ("unusual size", through(quintic_spline(3), waypoints=[[0.0], [1e61], [0.0], [1e60]])),
    ("more than 26 segments", through(quintic_spline(29))),
    (
        "not rebuilt in rational numbers; at fixed ratios",
        through(uniform_cubic_b_spline(4, "timed"), **AT_RATIOS),
    ),
    ("coefficients free: not covered at fixed ratios", through(piecewise((5, 5, 5)), **AT_RATIOS)),
    (f"more than {MOST_REBUILT} segments", through(cubic_spline(MOST_REBUILT + 1), **AT_RATIOS)),
    (MOVING, through(cubic_spline(3, MOVES), **AT_RATIOS)),
    ("at most 120 digits", through(three_five_three(), waypoints=[[0], [1e-200], [0.5], [1]])),
    ("joints: no text, or too long", through(three_five_three(), joints=("x" * 10_001,))),
]
UNBOUNDED: list[tuple[str, Problem]] = [
    ("nothing moves", through(cubic_spline(1), waypoints=[[1.0], [1.0]])),
    ("nothing that moves is limited", through(cubic_spline(1), Limits())),
    ("velocity limit is 0", through(cubic_spline(1), Limits(0.0, 1.0))),
    ("acceleration limit is 0", through(cubic_spline(1), Limits(1.0, 0.0))),
    ("its ends are free", through(cubic_spline(1, ()), Limits(INF, 1.0))),
    ("exceeds the limit", through(cubic_spline(1, ((1, 2.0),)))),
    ("nothing moves in segment 2", through(cubic_spline(3), waypoints=STILL)),
]
"""By declared curves, and by any."""


@pytest.mark.parametrize(
    ("subject", "reason", "problem"),
    [*((Subject.DECLARED, *one) for one in UNCOVERED), *((Subject.ANY, *one) for one in UNBOUNDED)],
)
def test_what_no_proof_covers_is_said(subject: Subject, reason: str, problem: Problem) -> None:
    assert reason in str(covered(exact_problem(problem), subject))
    with pytest.raises(TrajgapError, match=re.escape(reason)):
        certify(problem, subject=subject)


def test_every_entry_is_a_certifier() -> None:
    declared, every = certifiers(Subject.DECLARED), certifiers(Subject.ANY)
    assert all(isinstance(one, Certifier) for one in (*declared, *every))
    assert len({id(one) for one in (*declared, *every)}) == len(CERTIFIERS)
    assert len(every) == 1
    assert [one.instant for one in declared].index(True) == 0
