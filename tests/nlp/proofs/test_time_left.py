"""Exact proofs of answers, and compiling, within the time limit of a certification."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from trajgap.nlp.proofs import session
from trajgap.nlp.proofs.answer import prove_feasible, solve_exactly
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome, Request
from trajgap.nlp.proofs.quintic import certifier
from trajgap.nlp.proofs.session import OutOfTime, Session
from trajgap.problem import Limits, Problem, cubic_spline, quintic_spline
from trajgap.verify import verify_certificate

RNG = np.random.default_rng(20261128)
Q = RNG.normal(size=(6, 2))
CUBIC = Problem(Q, Limits([1.1] * 2, [1.9] * 2), cubic_spline(5))
QUINTIC = Problem(Q[:3], Limits([1.1] * 2, [1.9] * 2), quintic_spline(2))
SLOW = np.full(5, 20.0)
"""s; no limit is near."""


class Ticking:
    """A clock that goes on by a step whenever somebody looks at it."""

    now, step = 0.0, 0.0

    def perf_counter(self) -> float:
        self.now += self.step
        return self.now


def test_elimination_solves_and_stops() -> None:
    matrix = [[Fraction(int(x)) for x in row] for row in RNG.integers(-4, 5, (9, 9))]
    for i in range(8):
        matrix[i][i + 1 :] = [Fraction(0)] * (8 - i) if i % 2 else matrix[i][i + 1 :]
    right = [[Fraction(int(x)) for x in row] for row in RNG.integers(-4, 5, (9, 3))]
    solved = solve_exactly(matrix, right)
    assert solved is not None
    for row, values in zip(matrix, right, strict=True):
        again = [sum(x * s[k] for x, s in zip(row, solved, strict=True)) for k in range(3)]
        assert again == values
    assert solve_exactly([*matrix[:8], matrix[0]], right) is None
    looks = 0

    def clock() -> None:
        nonlocal looks
        looks += 1
        if looks == 5:
            raise OutOfTime

    with pytest.raises(OutOfTime):
        solve_exactly(matrix, right, clock)


def test_the_proof_of_an_answer_is_cut_short_and_proves_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert prove_feasible(exact_problem(CUBIC), SLOW) is not None
    ticks = Ticking()
    monkeypatch.setattr(session, "time", ticks)
    one = Session(exact_problem(CUBIC), Request(seconds=100.0))
    ticks.step = 10.0
    with pytest.raises(OutOfTime):
        one.offer(SLOW)
    assert 100.0 < ticks.now < 150.0
    ticks.step = 0.0
    found = one.result(False, certifier.QUINTIC.subject)
    assert (found.outcome, found.lower, found.upper) == (Outcome.OPEN, 0, None)
    assert found.left_out == session.UNPROVED


def test_an_answer_of_usual_size_is_proved_though_the_time_is_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ticks = Ticking()
    monkeypatch.setattr(session, "time", ticks)
    one = Session(exact_problem(CUBIC), Request(seconds=1.0))
    ticks.now = 500.0
    assert one.offer(SLOW)
    assert one.upper == sum(map(Fraction, SLOW))


def test_a_search_is_not_compiled_where_that_takes_longer_than_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def never(*_: object) -> int:
        raise AssertionError("compiled")

    with monkeypatch.context() as patch:
        patch.setattr(certifier, "at_hand", lambda _: False)
        patch.setattr(certifier, "search", never)
        found = certify(QUINTIC, gap=0.5, seconds=0.9 * certifier.COMPILING)
    assert (found.outcome, found.nodes) == (Outcome.INTERVAL, 0)
    assert found.left_out == certifier.UNCOMPILED
    assert found.upper is not None


def test_what_a_search_may_take_is_what_the_clock_leaves_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ticks = Ticking()
    monkeypatch.setattr(session, "time", ticks)
    one = Session(exact_problem(CUBIC), Request(seconds=100.0))
    ticks.now = 30.0
    assert one.searching == pytest.approx(100.0 / (1.0 + session.JUDGING) - 30.0)
    # The verifier proves the answer once more: what that took is left to it.
    ticks.step = 0.05
    assert one.offer(SLOW)
    ticks.step, answering = 0.0, ticks.now - 30.0
    assert answering > 1.0
    ticks.now = 30.0
    shorter = one.searching
    assert shorter == pytest.approx((100.0 - answering) / (1.0 + session.JUDGING) - 30.0, abs=0.1)
    ticks.now = 30.0 + shorter - 0.01
    one.check_clock()
    ticks.now = 30.0 + shorter + 0.01
    with pytest.raises(OutOfTime):
        one.check_clock()
    assert one.left_out == session.UNBOUNDED


def test_without_time_mean_velocities_bound_a_quintic_spline() -> None:
    problem = Problem(Q, Limits([1.1, 0.7], [1.9] * 2), quintic_spline(5))
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


def test_a_search_proves_more_than_mean_velocities() -> None:
    at_once = certify(QUINTIC, gap=0.2, seconds=0.0)
    searched = certify(QUINTIC, gap=0.2, seconds=60.0)
    assert searched.outcome is Outcome.CERTIFIED
    assert at_once.lower < searched.lower


def test_an_interval_without_a_lower_bound_says_why() -> None:
    unlimited = Problem(Q[:3], Limits([np.inf] * 2, [1.9] * 2), quintic_spline(2))
    found = certify(unlimited, gap=1e-6, seconds=0.0)
    assert (found.lower, found.proof) == (0, None)
    assert found.upper is None or found.outcome is Outcome.INTERVAL
    assert found.left_out in (session.UNBOUNDED, session.UNPROVED, certifier.UNCOMPILED)
