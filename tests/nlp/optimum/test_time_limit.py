"""Time limits: a search ends at its next step with its best, and begins no stage too late."""

import math

import numpy as np
import pytest
from support.proof_runs import Ticking
from trajgap.nlp import Solution, Status, certify, clock, stopping_after
from trajgap.nlp.clock import time_up
from trajgap.nlp.optimum import closed_forms, rounds, solve
from trajgap.nlp.optimum.program import Program
from trajgap.nlp.optimum.rounds import STAGES, begun, solve_round
from trajgap.nlp.proofs import session
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.local import call_cap
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Request
from trajgap.nlp.proofs.quintic import windows
from trajgap.nlp.proofs.session import Session
from trajgap.problem import Limits, Problem, Verdict, check, curves
from trajgap.verify import OutOfTime


def ticking(monkeypatch: pytest.MonkeyPatch, step: float = 1.0) -> Ticking:
    ticks = Ticking(step=step)
    monkeypatch.setattr(clock, "time", ticks)
    return ticks


RNG = np.random.default_rng(20261122)
MANY = Problem(RNG.normal(size=(7, 3)), Limits([1.1] * 3, [1.9] * 3), curves.cubic_spline(6))
NEAR_LIMITS = Limits(0.23, 0.1, 0.33, position_lower=-1.3, position_upper=2.4)
NEAR = Problem([2.2, 0.8, -0.7, 1.28, 1.2801], NEAR_LIMITS, curves.cubic_spline(4))
"""Searched by exact descents."""
THREE = Problem(RNG.normal(size=(4, 2)), Limits([1.1] * 2, [1.9] * 2), curves.three_five_three())
UNIFORM = Problem(
    RNG.normal(size=(5, 2)), Limits(1.1, 1.9), curves.uniform_cubic_b_spline(5, "timed")
)
PROBLEMS = {"many": MANY, "near": NEAR, "three": THREE, "uniform": UNIFORM}


def test_no_limit_without_one() -> None:
    assert clock.seconds_left() == math.inf
    assert not time_up()
    assert call_cap() is None


def test_a_limit_ends_what_is_within_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = ticking(monkeypatch, 0.0)
    with stopping_after(10.0):
        ticks.now = 9.75
        assert not time_up()
        with stopping_after(100.0):  # the earlier one holds
            assert clock.seconds_left() == 0.25
        with stopping_after(0.1):
            assert clock.seconds_left() == pytest.approx(0.1)
        ticks.now = 10.0
        assert time_up()
    assert not time_up()


def test_a_limit_is_gone_after_an_interrupt() -> None:
    with pytest.raises(KeyboardInterrupt), stopping_after(-1.0):
        raise KeyboardInterrupt
    assert not time_up()


@pytest.mark.parametrize(
    ("left", "cap"), [(1000.0, 128.0), (60.0, 16.0), (15.9, 2.0), (0.3, 0.25), (-3.0, 0.25)]
)
def test_a_call_has_what_is_left(monkeypatch: pytest.MonkeyPatch, left: float, cap: float) -> None:
    ticking(monkeypatch, 0.0)
    with stopping_after(left):
        assert call_cap() == cap


def test_an_estimate_stops_after_a_start(monkeypatch: pytest.MonkeyPatch) -> None:
    assert estimate_any_curve(MANY).starts == 6
    ticking(monkeypatch)
    with stopping_after(0.0):
        found = estimate_any_curve(MANY)
    assert found.starts == 1


def test_the_answer_of_a_certification_has_a_time_share(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = Ticking()
    monkeypatch.setattr(clock, "time", ticks)
    one = Session(exact_problem(NEAR), Request(clock=clock.RunClock(100.0)))
    ticks.now = 60.0
    left: list[float] = []
    real = session.solve

    def looked(*given: object, **named: object) -> object:
        left.append(clock.seconds_left())
        return real(*given, **named)

    monkeypatch.setattr(session, "solve", looked)
    assert one.seek()
    assert left == [Session.seeking * 40.0]
    assert clock.seconds_left() == math.inf


def test_a_certification_without_time_has_an_answer() -> None:
    found = certify(MANY, seconds=0.0)
    assert found.upper > certify(MANY, seconds=60.0, gap=0.5).upper * (1 - 1e-9)


def test_the_windows_of_a_proof_look_at_the_clock() -> None:
    looks = 0

    def clock_() -> None:
        nonlocal looks
        looks += 1
        if looks == 3:
            raise OutOfTime

    steps = np.diff(RNG.normal(size=(4, 2)), axis=0)
    with pytest.raises(OutOfTime):
        windows.windows(steps, np.array([[1.0, 2.0, 9.0]] * 2), np.ones(3), clock=clock_)
    assert looks == 3


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_a_solve_ends_soon_after_time(monkeypatch: pytest.MonkeyPatch, problem: Problem) -> None:
    ticks = ticking(monkeypatch)
    whole = solve(problem, seconds=1e9)
    needed = ticks.looks
    assert whole.status in (Status.CONVERGED, Status.NOT_ATTAINED)
    for share, later in ((0.4, 10), (0.0, 20)):
        ticks.now, ticks.looks = 0.0, 0
        part = solve(problem, seconds=share * needed)
        assert share * needed <= ticks.looks <= share * needed + later < needed
        assert closed_forms.CUT_SHORT in str(part.why)
        assert check(problem, part.durations).limits is Verdict.PASS
        assert part.total_time >= whole.total_time * (1 - 1e-9)
        assert clock.seconds_left() == np.inf
    assert part.iterations <= 20


@pytest.mark.parametrize(
    ("status", "why", "said"),
    [
        (Status.NONE_FOUND, "none of 4", f"none of 4; {closed_forms.OUT_OF_TIME}"),
        (Status.FAILED, None, closed_forms.OUT_OF_TIME),
        (Status.INFEASIBLE, "a proof", "a proof"),
    ],
)
def test_the_time_proves_nothing(status: Status, why: str | None, said: str) -> None:
    found = closed_forms.cut_short(Solution(THREE, status, why))
    assert (found.status, found.why) == (status, said)


def test_ipopt_keeps_its_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    program = Program(MANY, 5.0, np.zeros(MANY.segments))
    h = np.full(MANY.segments, 5.0)
    monkeypatch.setattr(rounds, "SHORTEST", 1e-6)
    state, rows = begun(program, (h, None))
    with stopping_after(-1.0):
        success, iterations, _ = solve_round(program, rows, state, STAGES[0], (0.1 * h, 9.0 * h))
    assert not success
    assert iterations <= 1
    state, rows = begun(program, (h, None))
    assert solve_round(program, rows, state, STAGES[0], (0.1 * h, 9.0 * h))[0]
