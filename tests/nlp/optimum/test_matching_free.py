"""3-2-3 polynomials with C1: one speed of each joint is free, one too few for C2."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from trajgap.nlp import Solution, Status, solve
from trajgap.nlp.optimum.matching import jump_equations, matched
from trajgap.problem import Array, Limits, Problem, Verdict, check, piecewise

CURVE = piecewise((3, 2, 3), 1, ((1, 0.0),))
ONWARDS = np.array([0.21, 0.9, 1.34, 1.87])
BACK = np.array([0.21, 0.9, 0.34, 1.87])
V, A, J = 1.1, 2.1, 6.3


def problem_through(q: Array, jerk: float | list[float] = J) -> Problem:
    q = q.reshape(4, -1)
    joints = q.shape[1]
    return Problem(q, Limits([V] * joints, [A] * joints, jerk, joints=joints), CURVE)


def middle(h: Array, q: Array) -> tuple[Array, Array]:
    """Speed at the first via-point and the constant acceleration of the middle segment.

    In a cubic from rest whose acceleration ends at a the speed ends at 3d/2h + ah/4; from the other
    end alike, and between them the speed grows by a times h₂.
    """
    d = np.diff(q)
    a = 1.5 * (d[2] / h[2] - d[0] / h[0]) / (h[0] / 4 + h[1] + h[2] / 4)
    return 1.5 * d[0] / h[0] + a * h[0] / 4, a


def mismatch(h: Array, q: Array) -> Array:
    """Way of the middle segment beyond what a motion without a jump makes of it.

    Durations may be a batch, segments first.
    """
    speed, a = middle(h, q)
    return np.asarray(speed * h[1] + a * h[1] ** 2 / 2 - (q[2] - q[1]))


def tight_total(h: Array, q: Array) -> float:
    """Total after the stretch that limits at the ends of segments ask for.

    Speed is largest where the acceleration is 0, else at an end of its segment; acceleration is
    linear, jerk constant, in every segment.
    """
    d = np.diff(q)
    speed, a = middle(h, q)
    after = speed + a * h[1]
    first, last = 3 * d[0] / h[0] ** 2 - a / 2, -3 * d[2] / h[2] ** 2 - a / 2
    speeds = [speed, after]
    for start, end, begin, span in ((first, a, 0.0, h[0]), (a, last, after, h[2])):
        if start * end < 0:
            t = span * start / (start - end)
            speeds.append(begin + start * t / 2)
    jerks = [(a - first) / h[0], (last - a) / h[2]]
    needs = [
        max(map(abs, speeds)) / V,
        (max(abs(first), abs(a), abs(last)) / A) ** 0.5,
        (max(map(abs, jerks)) / J) ** (1 / 3),
    ]
    return float(h.sum() * max(needs))


def brute_total(q: Array, count: int = 201) -> float:
    """Least total over a grid of one ratio, and all ratios of the last that go with it, refined."""
    thirds = np.exp(np.linspace(-4.0, 4.0, 161))

    def total(log_second: float) -> float:
        second = np.exp(log_second)

        def off(third: float) -> float:
            return float(mismatch(np.array([1.0, second, third]), q))

        ones = np.ones_like(thirds)
        values = mismatch(np.stack([ones, second * ones, thirds]), q)
        roots = [
            brentq(off, thirds[i], thirds[i + 1], xtol=1e-15)
            for i in np.flatnonzero(values[:-1] * values[1:] < 0)
        ]
        totals = [tight_total(np.array([1.0, second, x]), q) for x in roots]
        return min(totals, default=np.inf)

    grid = np.linspace(-3.0, 3.0, count)
    found = [total(x) for x in grid]
    if not np.isfinite(found).any():
        return np.inf
    best, step = grid[int(np.argmin(found))], float(grid[1] - grid[0])
    near = minimize_scalar(total, bounds=(best - step, best + step), options={"xatol": 1e-10})
    return min(float(near.fun), min(found))


@cache
def shortest() -> Solution:
    """The answer for one joint that goes on, which two tests look at."""
    return solve(problem_through(ONWARDS))


def test_the_shortest_motion_without_a_jump_is_found() -> None:
    problem, solution = problem_through(ONWARDS), shortest()
    assert solution.status is Status.FEASIBLE
    assert "at which the motion does not jump" in str(solution.why)
    assert check(problem, solution.durations, solution.nodal).verdict is Verdict.PASS
    assert solution.durations is not None
    h = solution.durations
    assert mismatch(h, ONWARDS) == pytest.approx(0.0, abs=1e-8)
    assert tight_total(h, ONWARDS) == pytest.approx(h.sum(), rel=1e-8)
    assert solution.total_time == pytest.approx(brute_total(ONWARDS), rel=1e-6)


def test_there_is_none_where_the_middle_turns_back() -> None:
    """The mean speed of the middle lies between those at its ends, both of the outer ways' sign."""
    assert brute_total(BACK, 61) == np.inf
    solution = solve(problem_through(BACK))
    assert solution.status is Status.NONE_FOUND
    assert "jumps" in str(solution.why)


def test_two_joints_have_two_equations_for_two_ratios() -> None:
    both = np.column_stack([ONWARDS, 0.5 - 0.4 * ONWARDS])
    assert jump_equations(problem_through(both)) == (2, 2)
    (shared, *_) = matched(problem_through(both), 0)
    assert shared[0].sum() == pytest.approx(shortest().total_time, rel=1e-5)


def test_more_equations_than_ratios_are_named() -> None:
    q = np.column_stack([ONWARDS, ONWARDS**2, np.sqrt(ONWARDS)])
    solution = solve(problem_through(q))
    assert solution.status is Status.NONE_FOUND
    assert "it would take 2 ratios of durations that meet 3 equations" in str(solution.why)


def test_without_a_jerk_limit_the_acceleration_may_jump() -> None:
    assert jump_equations(problem_through(ONWARDS, np.inf)) == (0, 2)
    solution = solve(problem_through(ONWARDS, np.inf))
    assert solution.status is Status.CONVERGED
    assert solution.total_time < brute_total(ONWARDS, 61)
