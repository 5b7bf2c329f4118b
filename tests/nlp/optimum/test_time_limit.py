"""The time limit of `solve`, and stages that are not begun since they would end after it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from trajgap.nlp import Solution, Status, solve
from trajgap.nlp.optimum import (
    clock,
    curve_formulation,
    newton,
    newton_kernel,
    solver,
    stopping,
    stopping_after,
    unsearched,
)
from trajgap.nlp.optimum.clock import TooLong, look_ahead
from trajgap.nlp.optimum.curve_tracking import curve_coarse
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

RNG = np.random.default_rng(20261127)
MANY = Problem(RNG.normal(size=(7, 3)), Limits([1.1] * 3, [1.9] * 3), cubic_spline(6))
TIMED = Problem(
    RNG.normal(size=(6, 2)), Limits([1.1] * 2, [1.9] * 2), uniform_cubic_b_spline(6, "timed")
)
THREE = Problem(RNG.normal(size=(4, 2)), Limits([1.1] * 2, [1.9] * 2), three_five_three())


@dataclass
class Ticking:
    """A clock that goes on by a step whenever somebody looks at it."""

    now: float = 0.0
    step: float = 1.0
    looks: int = 0

    def perf_counter(self) -> float:
        self.now += self.step
        self.looks += 1
        return self.now


def ticking(monkeypatch: pytest.MonkeyPatch, step: float = 1.0) -> Ticking:
    ticks = Ticking(step=step)
    monkeypatch.setattr(clock, "time", ticks)
    return ticks


@pytest.mark.parametrize("problem", [MANY, TIMED], ids=["spline", "timed"])
def test_a_solve_ends_soon_after_its_time_and_says_so(
    monkeypatch: pytest.MonkeyPatch, problem: Problem
) -> None:
    monkeypatch.setattr(solver, "settled_quickly", lambda *_: None)
    solve(problem)  # builds what is kept
    ticks = ticking(monkeypatch)
    whole = solve(problem, seconds=1e9)
    needed = ticks.looks
    assert whole.status is Status.CONVERGED
    assert whole.why is None
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
    found = solve(TIMED, seconds=1000.0)
    assert tried == [TooLong]
    assert found.durations is not None
    assert check(TIMED, found.durations).limits is Verdict.PASS
    curve_formulation.compiled_curve.cache_clear()
    monkeypatch.setattr(curve_formulation, "build_curve", real)
    best = solve(TIMED)
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
    structure = curve_formulation.curve_structure(TIMED)
    ticks = ticking(monkeypatch)
    with stopping_after(30.0), pytest.raises(TooLong):
        curve_formulation.build_curve(structure)
    assert 30 <= ticks.looks <= 33


def test_ipopt_looks_at_the_clock_after_each_iteration(monkeypatch: pytest.MonkeyPatch) -> None:
    built = curve_formulation.compiled_curve(curve_formulation.curve_structure(TIMED))
    start = np.full(TIMED.segments, 9.0)
    looks = 0

    def up() -> bool:
        nonlocal looks
        looks += 1
        return looks >= 4

    monkeypatch.setattr(stopping, "time_up", up)
    _, _, success, needed = curve_coarse(TIMED, built, start, 1e-3)
    assert success
    assert needed > 6
    assert looks == 0, "without a limit nobody looks"
    with stopping_after(1e6):
        _, _, success, iterations = curve_coarse(TIMED, built, start, 1e-3)
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
