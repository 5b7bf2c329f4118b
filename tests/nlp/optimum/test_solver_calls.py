"""Calls of a solver: what IPOPT is asked for, and calls that were made before."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np
import pytest
from trajgap.nlp.optimum import curve_tracking, solve, solver_calls
from trajgap.nlp.optimum.ipopt import ipopt_options
from trajgap.nlp.optimum.solver_calls import kept_calls, solved_before
from trajgap.problem import Array, Limits, Problem, Verdict, check, uniform_cubic_b_spline

Q = np.array([[0.15, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])


@pytest.fixture(autouse=True)
def keeping(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(solver_calls, "CALLS", 64)
    with kept_calls():
        yield


def asked(solver: object, given: tuple[Array, ...], calls: list[str], good: bool = True) -> int:
    def called() -> int:
        calls.append("called")
        return len(calls)

    return solved_before(solver, given, called, lambda _: good)


@pytest.mark.parametrize(
    ("other", "again"),
    [
        ([1.0, np.inf, 1e-11], False),
        ([1.0 + 1e-13, np.inf, 1e-13], True),
        ([1.0 + 1e-11, np.inf, 0.0], False),
        ([1.0, -np.inf, 0.0], False),
        ([1.0, 5.0, 0.0], False),
        ([1.0, np.nan, 0.0], False),
        ([1.0, np.inf], False),
    ],
)
def test_only_rounding_is_overlooked(other: list[float], again: bool) -> None:
    calls: list[str] = []
    first = (np.array([1.0, np.inf, 0.0]), np.array([3.0]))
    assert asked("one", first, calls) == 1
    assert asked("one", (np.array(other), first[1]), calls) == (1 if again else 2)


def test_another_solver_and_an_answer_that_failed_are_asked_again() -> None:
    calls: list[str] = []
    given = (np.array([1.0]),)
    assert asked("one", given, calls, good=False) == 1
    assert asked("one", given, calls) == 2
    assert asked("other", given, calls) == 3
    assert asked("one", (*given, *given), calls) == 4
    assert asked("one", given, calls) == 2
    for i in range(64):
        asked("one", (np.array([7.0 + i]),), calls)
    assert asked("one", given, calls) == 69  # the oldest are forgotten


def test_what_is_asked_in_other_units_is_solved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    counts: list[int] = []
    own = curve_tracking.run

    def counted(*arguments: object) -> object:
        calls = solver_calls._CALLS.get()
        before = len(calls)
        found = own(*arguments)  # type: ignore[arg-type]
        counts.append(len(calls) - before)
        return found

    monkeypatch.setattr(curve_tracking, "run", counted)
    curve = uniform_cubic_b_spline(4, "timed")
    v, a = np.array([2.0, 1.5]), np.array([9.0, 8.0])
    one = solve(Problem(Q, Limits(v, a), curve), starts=2)
    assert sum(counts) == len(counts) > 2
    done = len(counts)
    # Another unit, and a clock 4 times as fast: v t / q and a t² / q are the same.
    unit, pace = 64.0, 4.0
    twin = Problem(unit * Q, Limits(unit * pace * v, unit * pace**2 * a), curve)
    other = solve(twin, starts=2)
    assert sum(counts[done:]) == 0
    assert other.total_time == pytest.approx(one.total_time / pace, rel=1e-13)
    assert (other.starts, other.iterations) == (one.starts, one.iterations)
    assert check(twin, other.durations).limits is Verdict.PASS
    slower = solve(Problem(Q, Limits(0.99 * v, a), curve), starts=2)
    assert sum(counts[2 * done :]) > 2
    assert slower.total_time > one.total_time * 1.0001


def test_outside_every_call_is_made() -> None:
    calls: list[str] = []
    given = (np.array([1.0]),)
    assert asked("one", given, calls) == 1
    token = solver_calls._CALLS.set(None)
    assert asked("one", given, calls) == 2
    solver_calls._CALLS.reset(token)
    assert asked("one", given, calls) == 1


@pytest.mark.parametrize("warm", [False, True])
def test_nothing_is_printed_where_a_function_is_not_defined(
    warm: bool, capfd: pytest.CaptureFixture[str]
) -> None:
    x = ca.MX.sym("x")
    program = {"x": x, "f": x, "g": ca.sqrt(x - 2.0)}
    solver = ca.nlpsol("cold", "ipopt", program, ipopt_options(warm))
    solver(x0=1.0, lbg=0.0, ubg=1.0)
    assert solver.stats()["return_status"] == "Invalid_Number_Detected"
    assert capfd.readouterr() == ("", "")
