"""Curves that may jump where the limits forbid it: the optimum is one of a smoother declaration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import differential_evolution
from trajgap.nlp import Status, solve
from trajgap.nlp.optimum.smoother import as_answer, same_motions, smoother
from trajgap.problem import (
    Array,
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    fit,
    piecewise,
    three_five_three,
)

REST, STILL = ((1, 0.0),), ((1, 0.0), (2, 0.0))
Q = np.array([[0.31, -0.72], [1.43, 0.38], [0.64, 1.17], [-0.55, 0.93]])
V, A, J = np.array([1.1, 0.9]), np.array([2.1, 2.4]), np.array([6.3, 4.7])
C1 = piecewise((3, 3, 3), 1, REST)
"""Two speeds at the via-points are free, and acceleration may jump there."""


def question(curve: Interpolant = C1, jerk: Array = J, columns: int = 2) -> Problem:
    return Problem(Q[:, :columns], Limits(V[:columns], A[:columns], jerk[:columns]), curve)


def spline_total(logs: Array, columns: int) -> float:
    """Total of the spline by scipy, stretched until it is tight."""
    h = np.exp(np.append(0.0, logs))
    stretch = 0.0
    for j in range(columns):
        spline = CubicSpline(np.append(0.0, np.cumsum(h)), Q[:, j], bc_type="clamped")
        c3, c2, c1, _ = spline.c
        s = np.linspace(0.0, 1.0, 400)[:, None] * h
        stretch = max(
            stretch,
            float(np.abs(3 * c3 * s**2 + 2 * c2 * s + c1).max()) / V[j],
            float((np.abs(6 * c3 * s + 2 * c2).max() / A[j]) ** (1 / 2)),
            float((np.abs(6 * c3).max() / J[j]) ** (1 / 3)),
        )
    return float(h.sum()) * stretch


@pytest.mark.parametrize("columns", [1, 2])
def test_free_speeds_under_jerk_limits_give_the_spline(columns: int) -> None:
    problem = question(columns=columns)
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert solution.problem is problem
    assert solution.durations is not None
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    # Brute force over the cubic splines of scipy: C1 cubics whose acceleration does not jump.
    brute = differential_evolution(
        spline_total, [(-3.0, 3.0)] * 2, args=(columns,), rng=1, tol=1e-10, popsize=20
    )
    assert solution.total_time == pytest.approx(brute.fun, rel=1e-5)
    # The free values are the speeds of that spline.
    spline = replace(problem, curve=cubic_spline(3))
    moved = fit(spline.curve, spline.waypoints, solution.durations)
    speeds = [[moved.derivative(b, j, 1)[0] for j in range(columns)] for b in (1, 2)]
    np.testing.assert_allclose(solution.nodal, speeds, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("curve", "same"),
    [
        (piecewise((4, 3, 4), 1, STILL), piecewise((4, 3, 4), 2, STILL)),
        (piecewise((5, 3, 5), 1, (*STILL, (3, 0.0))), piecewise((5, 3, 5), 2, (*STILL, (3, 0.0)))),
    ],
    ids=["4-3-4", "5-3-5"],
)
def test_higher_degrees(curve: Interpolant, same: Interpolant) -> None:
    solution, other = solve(question(curve)), solve(question(same))
    assert solution.status is other.status is Status.CONVERGED
    assert solution.total_time == pytest.approx(other.total_time, rel=1e-12)
    assert solution.durations is not None
    assert check(question(curve), solution.durations, solution.nodal).verdict is Verdict.PASS


def test_without_a_jerk_limit_acceleration_may_jump() -> None:
    free = np.full(2, np.inf)
    assert smoother(question(jerk=free)) is None
    assert solve(question(jerk=free)).total_time < solve(question()).total_time * 0.999


def test_a_joint_without_a_jerk_limit_makes_it_feasible_only() -> None:
    some = question(jerk=np.array([6.3, np.inf]))
    assert not same_motions(some)
    solution = solve(some)
    assert solution.status is Status.FEASIBLE
    assert "held as smooth as the others" in str(solution.why)
    assert solution.durations is not None
    assert check(some, solution.durations, solution.nodal).verdict is Verdict.PASS
    # A joint that stands still is smooth by itself.
    still = replace(some, waypoints=np.column_stack([Q[:, 0], np.full(4, 0.3)]))
    assert same_motions(still)
    assert solve(still).status is Status.CONVERGED


def test_known_motions_and_starts_go_with_it() -> None:
    problem = question()
    best = solve(problem)
    assert best.durations is not None
    assert best.nodal is not None
    slow = np.array(best.durations) * 1.5
    known = solve(
        problem, initial=slow, known=best.durations[None], known_nodal=best.nodal[None], starts=1
    )
    assert known.total_time <= best.total_time * (1 + 1e-9)
    assert solve(problem, initial=slow, known=slow).total_time < slow.sum()


def test_infeasible_is_a_proof_for_the_first_problem_where_the_motions_are_the_same() -> None:
    short = np.full(3, 0.4)
    proved = solve(replace(question(), duration_upper=short))
    assert proved.status is Status.INFEASIBLE
    some = replace(question(jerk=np.array([6.3, np.inf])), duration_upper=np.full(3, 2.0))
    smooth = smoother(some)
    assert smooth is not None
    found = replace(solve(smooth), status=Status.INFEASIBLE, durations=None, why="not this one")
    assert as_answer(some, found) is None
    alike = replace(question(), duration_upper=np.full(3, 2.0))
    answer = as_answer(alike, found)
    assert answer is not None
    assert answer.problem is alike


@pytest.mark.parametrize(
    "curve",
    [three_five_three(), piecewise((3, 3, 3), 1, STILL), piecewise((3, 2, 3), 1, REST)],
    ids=["determined", "determined and jumping", "too few coefficients"],
)
def test_nothing_to_raise(curve: Interpolant) -> None:
    assert smoother(question(curve)) is None
