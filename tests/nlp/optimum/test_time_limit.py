"""Time limits: a search ends at its next step with its best, and begins no stage too late."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from trajgap.nlp import Solution, Status, certify
from trajgap.nlp.optimum import (
    call_cap,
    clock,
    curve_formulation,
    ipopt,
    newton,
    newton_kernel,
    solve,
    solver,
    stopping,
    stopping_after,
    time_up,
    unsearched,
    wide_search,
)
from trajgap.nlp.optimum.clock import TooLong, look_ahead
from trajgap.nlp.optimum.curve_tracking import curve_coarse
from trajgap.nlp.optimum.exact_multistart import box_above
from trajgap.nlp.optimum.ipopt import compiled, structure_of
from trajgap.nlp.optimum.tracking import solve_coarse
from trajgap.nlp.proofs import clock as proof_clock
from trajgap.nlp.proofs import session
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Request
from trajgap.nlp.proofs.quintic import windows
from trajgap.nlp.proofs.session import Session
from trajgap.problem import (
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves import Deferred, compilation
from trajgap.verify import OutOfTime


@dataclass
class Ticking:
    """A clock that goes on by one second whenever somebody looks at it."""

    now: float = 0.0
    step: float = 1.0
    looks: int = 0

    def perf_counter(self) -> float:
        self.now += self.step
        self.looks += 1
        return self.now

    monotonic = perf_counter


def ticking(monkeypatch: pytest.MonkeyPatch, step: float = 1.0) -> Ticking:
    ticks = Ticking(step=step)
    monkeypatch.setattr(clock, "time", ticks)
    return ticks


RNG = np.random.default_rng(20261122)
MANY = Problem(RNG.normal(size=(7, 3)), Limits([1.1] * 3, [1.9] * 3), cubic_spline(6))
"""Lifted, 150 variables: a call of IPOPT has a limit of its own."""
NEAR = Problem(
    np.array([[2.2], [0.8], [-0.7], [1.28], [1.2801]]),
    Limits(0.23, 0.1, 0.33, position_lower=-1.3, position_upper=2.4, joints=1),
    cubic_spline(4),
)
"""Searched by exact descents."""
THREE = Problem(RNG.normal(size=(4, 2)), Limits([1.1] * 2, [1.9] * 2), three_five_three())
UNIFORM = Problem(
    RNG.normal(size=(5, 2)), Limits([1.1] * 2, [1.9] * 2), uniform_cubic_b_spline(5, "timed")
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
def test_a_call_has_no_more_than_is_left(
    monkeypatch: pytest.MonkeyPatch, left: float, cap: float
) -> None:
    ticking(monkeypatch, 0.0)
    with stopping_after(left):
        assert call_cap() == cap


def test_only_long_calls_are_limited() -> None:
    large, small = compiled(structure_of(MANY)), compiled(structure_of(THREE))
    assert large.formulation.sizes["variables"] > ipopt.QUICK_VARIABLES
    assert small.formulation.sizes["variables"] <= ipopt.QUICK_VARIABLES
    free = large.cold, large.warm, small.cold
    with stopping_after(60.0):
        limited = large.cold, large.warm, small.cold
        assert [a is b for a, b in zip(free, limited, strict=True)] == [False, False, True]
        assert large.cold is limited[0], "compiled once"
    assert large.cold is free[0]


def test_ipopt_keeps_its_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clock, "CAPS", (1e-6,))
    built = compiled(structure_of(MANY))
    start = np.full(MANY.segments, 5.0)
    with stopping_after(60.0):
        _, _, success, iterations = solve_coarse(MANY, built, start, 1e-3)
        assert not success
        assert iterations <= 1
        assert "ime" in built.cold.stats()["return_status"]
    assert solve_coarse(MANY, built, start, 1e-3)[2]


@pytest.mark.parametrize("name", PROBLEMS)
def test_a_search_without_time_has_an_answer_all_the_same(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    problem = PROBLEMS[name]
    ticks = ticking(monkeypatch)
    with stopping_after(0.0):
        found = solve(problem)
        looks = ticks.looks
    assert check(problem, found.durations).limits is Verdict.PASS
    assert found.iterations <= 20
    assert looks <= 20, "every loop ends at its next step"


def test_an_estimate_stops_after_a_start(monkeypatch: pytest.MonkeyPatch) -> None:
    assert estimate_any_curve(MANY).starts == 6
    ticking(monkeypatch)
    with stopping_after(0.0):
        found = estimate_any_curve(MANY)
    assert found.starts == 1


def test_the_answer_of_a_certification_has_a_share_of_the_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ticks = Ticking(step=0.0)
    monkeypatch.setattr(proof_clock, "time", ticks)
    monkeypatch.setattr(clock, "time", ticks)
    one = Session(exact_problem(NEAR), Request(clock=proof_clock.RunClock(100.0)))
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


def test_a_first_population_is_as_large_as_the_time_is_there_for() -> None:
    box = box_above(MANY, np.zeros(MANY.segments))
    h = np.exp(np.random.default_rng(3).normal(size=(3 * wide_search.PART, MANY.segments)))
    whole = wide_search.excess_and_total(MANY, h.copy(), box)
    with stopping_after(1e6):
        in_parts = wide_search._first(MANY, h.copy(), box)
    for one, other in zip(whole, in_parts, strict=True):
        np.testing.assert_array_equal(one, other)
    with stopping_after(0.0):
        z, excess, total = wide_search._first(MANY, h.copy(), box)
    assert len(z) == len(excess) == len(total) == wide_search.PART
    np.testing.assert_array_equal(z, whole[0][: wide_search.PART])


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


def test_a_formulation_that_is_kept_costs_no_second_solve_any_time() -> None:
    problem = Problem([[0.1], [0.7], [1.2], [0.9]], Limits(6.0, 8.0), three_five_three())
    first, second = solve(problem, starts=1), solve(problem, starts=1)
    assert min(first.solve_seconds, second.solve_seconds) > 0
    assert second.build_seconds < 0.05


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_a_solve_ends_soon_after_its_time_and_says_so(
    monkeypatch: pytest.MonkeyPatch, problem: Problem
) -> None:
    monkeypatch.setattr(solver, "settled_quickly", lambda *_: None)
    solve(problem)  # builds what is kept
    ticks = ticking(monkeypatch)
    whole = solve(problem, seconds=1e9)
    needed = ticks.looks
    assert whole.status in (Status.CONVERGED, Status.NOT_ATTAINED)
    ticks.now, ticks.looks = 0.0, 0
    part = solve(problem, seconds=0.4 * needed)
    assert 0.4 * needed <= ticks.looks <= 0.4 * needed + 25 < needed
    assert unsearched.CUT_SHORT in str(part.why)
    assert check(problem, part.durations).limits is Verdict.PASS
    assert part.total_time >= whole.total_time * (1 - 1e-9)
    assert clock.seconds_left() == np.inf


@pytest.mark.parametrize(
    ("status", "why", "said"),
    [
        (Status.NONE_FOUND, "none of 4", f"none of 4; {unsearched.OUT_OF_TIME}"),
        (Status.FAILED, None, unsearched.OUT_OF_TIME),
        (Status.INFEASIBLE, "a proof", "a proof"),
    ],
)
def test_the_time_proves_nothing(status: Status, why: str | None, said: str) -> None:
    found = unsearched.cut_short(Solution(THREE, status, why))
    assert (found.status, found.why) == (status, said)


def test_looking_ahead(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = ticking(monkeypatch, 0.0)
    look_ahead(1e9)
    with stopping_after(10.0):
        look_ahead(10.0)
        with pytest.raises(TooLong):
            look_ahead(10.1)
        ticks.now = 10.0
        with pytest.raises(TooLong):
            look_ahead()


def test_a_program_that_takes_too_long_to_build_is_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    real = curve_formulation.build_curve

    def slow(structure: Any) -> Any:
        return replace(real(structure), build_seconds=1e6)

    monkeypatch.setattr(curve_formulation, "build_curve", slow)
    curve_formulation.compiled_curve.cache_clear()
    tried: list[Any] = []
    monkeypatch.setattr(solver, "settled_quickly", lambda *_: None)
    monkeypatch.setattr(solver, "searchable", lambda _: False)
    monkeypatch.setattr(solver, "tracked_search", _noted(solver.tracked_search, tried))
    found = solve(UNIFORM, seconds=1000.0)
    assert tried == [TooLong]
    assert check(UNIFORM, found.durations).limits is Verdict.PASS
    curve_formulation.compiled_curve.cache_clear()
    monkeypatch.setattr(curve_formulation, "build_curve", real)
    best = solve(UNIFORM)
    assert best.total_time <= found.total_time * (1 + 1e-9)


def _noted(real: Any, tried: list[Any]) -> Any:
    def search(*given: Any) -> Any:
        try:
            return real(*given)
        except TooLong:
            tried.append(TooLong)
            raise

    return search


def test_writing_a_program_down_stops_at_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    structure = curve_formulation.curve_structure(UNIFORM)
    ticks = ticking(monkeypatch)
    with stopping_after(30.0), pytest.raises(TooLong):
        curve_formulation.build_curve(structure)
    assert 30 <= ticks.looks <= 33


def test_ipopt_looks_at_the_clock_after_each_iteration(monkeypatch: pytest.MonkeyPatch) -> None:
    built = curve_formulation.compiled_curve(curve_formulation.curve_structure(UNIFORM))
    start = np.full(UNIFORM.segments, 9.0)
    looks = 0

    def up() -> bool:
        nonlocal looks
        looks += 1
        return looks >= 4

    monkeypatch.setattr(stopping, "time_up", up)
    _, _, success, needed = curve_coarse(UNIFORM, built, start, 1e-3)
    assert success
    assert needed > 6
    assert looks == 0, "without a limit nobody looks"
    with stopping_after(1e6):
        _, _, success, iterations = curve_coarse(UNIFORM, built, start, 1e-3)
    assert not success
    assert iterations <= looks == 4


def test_no_descent_is_begun_that_would_end_too_late(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = ticking(monkeypatch, 0.0)
    calls: list[int] = []

    class Slow:
        compiled = True

        def __call__(self, starts: Any, begin: int, stop: int, steps: int, *rest: Any) -> None:
            calls.append(steps)
            ticks.now += 1.0 if steps == 0 else 10.0
            rest[-1][begin:stop] = 0.0

    monkeypatch.setattr(newton, "_descents", Slow())
    descents, n = newton.Descents(THREE), THREE.segments
    wide = np.full(n, 9.0)
    with stopping_after(1000.0):
        descents.run(np.zeros((newton.PART, n)), -wide, wide, 0)
        assert descents.place_seconds == pytest.approx(1.0 / newton.PART)
        descents.place_seconds = 10.0
        ticks.now = 1000.0 - 10.0 * newton.DESCENT + 0.1
        _, found = descents.run(np.zeros((3, n)), -wide, wide, newton_kernel.STEPS)
        assert calls == [0]
        assert np.isinf(found[:, 1]).all()
        ticks.now = 0.0
        descents.place_seconds = 0.1
        ticks.now = 1000.0 - 25.0
        _, found = descents.run(np.zeros((9, n)), -wide, wide, newton_kernel.STEPS)
    # The third would end 5 s after the limit, as the first two tell.
    assert calls == [0, newton_kernel.STEPS, newton_kernel.STEPS]
    assert np.isinf(found[2:, 1]).all()


def test_what_would_be_compiled_beyond_the_limit_is_interpreted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compilation, "at_hand", lambda _: False)
    function = Deferred(newton_kernel._shares, 6.0)
    z, slope, again = np.array([0.3, -0.2, 1.0]), np.empty(3), np.empty(3)
    function._spent = 7.0
    with stopping_after(6.0 * compilation.BUSY - 1.0), stopping_after(1000.0):
        early = function(z, slope)
    assert not function.compiled
    function._spent = 9.0
    with stopping_after(1000.0):
        assert function(z, again) == early
    assert function.compiled
    assert (slope == again).all()
