"""The time limit of a certification: states, search, answer and judging share it."""

from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from support.proof_runs import Ticking, state_of, stopped
from trajgap.nlp import clock
from trajgap.nlp.clock import RunClock
from trajgap.nlp.proofs import judged, session, state
from trajgap.nlp.proofs.answer import prove_feasible
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import tree
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Request
from trajgap.nlp.proofs.quintic import certifier
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Limits, Problem, TrajgapError, curves
from trajgap.verify import (
    CertificateVerdict,
    Clock,
    OutOfTime,
    Subject,
    verify_certificate,
    verify_certificate as verify,
)

LATE = CertificateVerdict(False, "nothing was decided", out_of_time=True)
WAY = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
QUICK = Problem(WAY, Limits([1.1, 0.9], [1.9, 2.3]), curves.cubic_spline(2))
LONG = Problem(WAY[:, :1], Limits([1.1], [1.9], [7.0]), curves.cubic_spline_virtual(3))


@lru_cache(maxsize=1)
def interrupted() -> Certified:
    """After some boxes."""
    return stopped(LONG, lambda now: now.nodes >= 4 and now.open_boxes >= 2, gap=1e-3)


def test_a_resumed_run_without_time_loses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    given = state_of(interrupted())
    monkeypatch.setattr(state, "verify_certificate", lambda document, **_: verify(document))
    boxes: list[Any] = []
    real = tree.TickBox
    monkeypatch.setattr(tree, "TickBox", lambda own: (boxes.append(own), real(own))[1])
    found = certify(LONG, gap=1e-3, seconds=0.0, resume=given)
    assert len(boxes) == 1, "the first box, to which nothing was done"
    assert found.outcome is Outcome.INTERVAL
    assert (str(found.lower), str(found.upper)) == tuple(
        str(Fraction(given["claim"][side])) for side in ("lower", "upper")
    )
    again = state_document(found)
    assert again["proposals"] == given["proposals"]


def late(monkeypatch: pytest.MonkeyPatch, module: Any) -> list[float]:
    """The seconds that a module gives a verifier which decides nothing in them."""
    asked: list[float] = []
    monkeypatch.setattr(
        module, "verify_certificate", lambda _, seconds, **__: (asked.append(seconds), LATE)[1]
    )
    return asked


@pytest.mark.parametrize("subject", list(Subject))
def test_what_is_not_judged_in_time_is_not_certified_and_can_be_resumed(
    monkeypatch: pytest.MonkeyPatch, subject: Subject
) -> None:
    with monkeypatch.context() as patch:
        asked = late(patch, judged)
        found = certify(QUICK, gap=0.01, seconds=50.0, subject=subject)
    (seconds,) = asked
    assert 0 < seconds < 50.0 + RunClock.spare
    assert found.outcome is Outcome.OPEN
    assert (found.lower, found.proof, found.verdict) == (0, None, LATE)
    assert found.upper is not None
    kept = state_of(found)
    assert kept["proof"] is None
    assert kept["proposals"] is not None
    assert verify(kept).proves
    finished = certify(QUICK, gap=0.01, resume=kept, subject=subject)
    assert finished.outcome is Outcome.CERTIFIED
    assert verify(certificate(finished)).proves


def test_what_a_state_proved_stays_if_the_rest_runs_late(monkeypatch: pytest.MonkeyPatch) -> None:
    given = state_of(interrupted())
    monkeypatch.setattr(judged, "verify_certificate", lambda *_, **__: LATE)
    found = certify(LONG, gap=0.1, resume=given)
    assert found.lower == Fraction(given["claim"]["lower"]) > 0
    assert found.verdict.proves
    assert verify(certificate(found)).lower == found.lower
    assert found.proposals is not None
    monkeypatch.undo()
    again = certify(LONG, gap=0.1, resume=state_document(found))
    assert again.outcome is Outcome.CERTIFIED


def test_a_state_is_judged_within_the_time_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    given = state_of(interrupted())
    asked = late(monkeypatch, state)
    with pytest.raises(TrajgapError, match="the state is not proved"):
        certify(LONG, seconds=7.0, resume=given)
    assert asked == [pytest.approx(7.0 + RunClock.spare, abs=0.5)]


@pytest.fixture
def ticks(monkeypatch: pytest.MonkeyPatch) -> Ticking:
    """The clock of every run."""
    found = Ticking()
    monkeypatch.setattr(clock, "time", found)
    return found


def test_the_judge_has_a_second_even_if_the_time_is_over() -> None:
    found: Certified = certify(QUICK, gap=0.01)
    again = judged.judged(replace(found, verdict=None), RunClock(-5.0))
    assert again.verdict.proves
    assert RunClock(-5.0).left == 0.0


def test_a_share_of_the_time_is_a_clock_of_its_own(ticks: Ticking) -> None:
    whole = RunClock(100.0)
    ticks.now = 20.0
    part = whole.share(0.5)
    assert (part.used, part.left) == (20.0, 40.0)
    ticks.now += 30.0
    assert (whole.left, part.left) == (50.0, 10.0)


def test_without_a_time_limit_boxes_are_counted(ticks: Ticking) -> None:
    """However slow the machine: whoever looks at the clock finds that an hour has passed."""
    ticks.step = 3600.0
    assert certify(QUICK, gap=0.01).outcome is Outcome.CERTIFIED
    few = certify(QUICK, gap=1e-6, boxes=1)
    assert few.outcome is Outcome.INTERVAL
    assert few.stopped


RNG = np.random.default_rng(20261128)
Q = RNG.normal(size=(6, 2))
CUBIC = Problem(Q, Limits([1.1] * 2, [1.9] * 2), curves.cubic_spline(5))
QUINTIC = Problem(Q[:3], Limits([1.1] * 2, [1.9] * 2), curves.quintic_spline(2))
SLOW = np.full(5, 20.0)
"""s; no limit is near."""


class Cut(Clock):
    """A clock that is over at the tenth look."""

    looks = 0

    def check(self, ahead: float = 0.0) -> None:
        self.looks += 1
        if self.looks == 10:
            raise OutOfTime


def test_a_proof_of_an_answer_cut_short_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    assert prove_feasible(exact_problem(CUBIC), SLOW) is not None
    one = Session(exact_problem(CUBIC), Request(clock=RunClock(100.0)))
    asked: list[float] = []
    monkeypatch.setattr(session, "Clock", lambda left: (asked.append(left), Cut(left))[1])
    with pytest.raises(OutOfTime):
        one.offer(SLOW)
    assert asked == [pytest.approx(100.0 + Session.answering, abs=1.0)]
    found = one.result(False, certifier.QUINTIC.subject)
    assert (found.outcome, found.lower, found.upper) == (Outcome.OPEN, 0, None)
    assert found.left_out == session.UNPROVED


def test_an_answer_of_usual_size_is_proved_though_the_time_is_over(ticks: Ticking) -> None:
    one = Session(exact_problem(CUBIC), Request(clock=RunClock(1.0)))
    ticks.now = 500.0
    assert one.offer(SLOW)
    assert one.upper == sum(map(Fraction, SLOW))


def test_what_a_search_may_take_is_what_the_clock_leaves_it(ticks: Ticking) -> None:
    one = Session(exact_problem(CUBIC), Request(clock=RunClock(100.0)))
    ticks.now = 30.0
    assert one.left == pytest.approx(100.0 / (1.0 + one.judging) - 30.0)
    # The verifier proves the answer once more: what that took is left to it.
    ticks.step = 0.5
    assert one.offer(SLOW)
    ticks.step, answering = 0.0, one._answering
    assert answering >= 0.5
    ticks.now = 30.0
    shorter = one.left
    assert shorter == pytest.approx((100.0 - answering) / (1.0 + one.judging) - 30.0)
    ticks.now = 30.0 + shorter - 0.01
    one.check_clock()
    ticks.now = 30.0 + shorter + 0.01
    with pytest.raises(OutOfTime):
        one.check_clock()
    assert one.left_out == session.UNBOUNDED


def test_without_time_mean_velocities_bound_a_quintic_spline() -> None:
    problem = Problem(Q, Limits([1.1, 0.7], [1.9] * 2), curves.quintic_spline(5))
    found = certify(problem, gap=1e-6, seconds=0.0)
    # No joint is faster on average than at all: |Δq|/V of the slowest one, segment by segment.
    least = (np.abs(np.diff(Q, axis=0)) / [1.1, 0.7]).max(axis=1).sum()
    assert float(found.lower) == pytest.approx(least, rel=1e-8)
    assert found.lower < least
    verdict = verify_certificate(certificate(found), seconds=5.0)
    assert verdict.proves, verdict.reason
    assert verdict.lower == found.lower
    assert found.outcome is (Outcome.OPEN if found.upper is None else Outcome.INTERVAL)
    assert found.stopped
    assert found.left_out in (session.BARE, session.UNPROVED)


def test_an_interval_without_a_lower_bound_says_why() -> None:
    unlimited = Problem(Q[:3], Limits([np.inf] * 2, [1.9] * 2), curves.quintic_spline(2))
    found = certify(unlimited, gap=1e-6, seconds=0.0)
    assert (found.lower, found.proof) == (0, None)
    assert found.upper is None or found.outcome is Outcome.INTERVAL
    assert found.left_out in (session.UNBOUNDED, session.UNPROVED)
