"""Determined curves that may jump: ratios of durations at which they do not, if there are any."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import fsolve
from trajgap.nlp import Status, solve
from trajgap.nlp.optimum.matching import matched
from trajgap.problem import (
    Array,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    piecewise,
    rest_to_rest,
)

C1 = piecewise((3, 3, 3), 1, ((1, 0.0), (2, 0.0)))
"""Twelve conditions on twelve coefficients; acceleration may jump at both via-points."""
ONWARDS = np.array([-0.844, 0.002, 0.615, 1.043])
BACK = np.array([0.741, 0.493, 1.137, 1.554])
V, A, J = 1.1, 2.1, 6.3


def question(q: Array, curve: object = C1, **bounds: Array) -> Problem:
    return Problem(q[:, None], Limits([V], [A], [J]), curve, **bounds)  # type: ignore[arg-type]


def end_accelerations(ratios: Array, q: Array) -> Array:
    """Of the C2 cubic spline at rest in velocity: without a jump they must be 0 as well."""
    h = np.exp(np.append(0.0, np.clip(ratios, -8.0, 8.0)))
    spline = CubicSpline(np.append(0.0, np.cumsum(h)), q, bc_type="clamped")
    return np.asarray(spline([0.0, h.sum()], 2)) * h[[0, -1]] ** 2


def brute_totals(q: Array) -> list[float]:
    """Totals of all motions without a jump that a grid of starts leads to, by scipy's splines."""
    totals: list[float] = []
    for first in np.linspace(-4, 4, 9):
        for second in np.linspace(-4, 4, 9):
            ratios, _, ended, _ = fsolve(
                end_accelerations, [first, second], args=(q,), full_output=True, xtol=1e-13
            )
            if ended != 1 or np.abs(end_accelerations(ratios, q)).max() > 1e-9:
                continue
            if np.abs(ratios).max() > 5:
                continue  # where a duration vanishes everything does
            h = np.exp(np.append(0.0, ratios))
            spline = CubicSpline(np.append(0.0, np.cumsum(h)), q, bc_type="clamped")
            t = np.linspace(0.0, h.sum(), 20001)
            worst = [
                float((np.abs(spline(t, r)).max() / limit) ** (1 / r))
                for r, limit in ((1, V), (2, A), (3, J))
            ]
            totals.append(float(h.sum()) * max(worst))
    return totals


def test_a_motion_without_a_jump_is_found_where_there_is_one() -> None:
    problem = question(ONWARDS)
    solution = solve(problem)
    assert solution.status is Status.FEASIBLE
    assert "at which the motion does not jump" in str(solution.why)
    assert solution.durations is not None
    assert check(problem, solution.durations).verdict is Verdict.PASS
    assert solution.total_time == pytest.approx(min(brute_totals(ONWARDS)), rel=1e-6)


def test_none_is_found_where_brute_force_has_none() -> None:
    assert brute_totals(BACK) == []
    solution = solve(question(BACK))
    assert solution.status is Status.NONE_FOUND
    assert "jumps" in str(solution.why)


def test_bounds_on_the_durations_hold() -> None:
    ((free, _),) = matched(question(ONWARDS), 0)
    low = np.array([0.0, 2.0 * free[1], 0.0])
    ((longer, _),) = matched(question(ONWARDS, duration_lower=low), 0)
    np.testing.assert_allclose(longer, 2.0 * free, rtol=1e-6)
    assert matched(question(ONWARDS, duration_upper=0.9 * free), 0) == []


def test_proportional_joints_share_the_ratios() -> None:
    both = Problem(
        np.column_stack([ONWARDS, 0.5 - 0.4 * ONWARDS]), Limits([V] * 2, [A] * 2, [J] * 2), C1
    )
    ((alone, _),), ((shared, _),) = matched(question(ONWARDS), 0), matched(both, 0)
    np.testing.assert_allclose(shared, alone, rtol=1e-6)
    other = Problem(np.column_stack([ONWARDS, BACK]), Limits([V] * 2, [A] * 2, [J] * 2), C1)
    assert matched(other, 0) == []


@pytest.mark.parametrize(
    "curve",
    [
        cubic_spline(3),
        rest_to_rest(3, 3),
        piecewise((3, 3, 3), 1, ((1, 0.0),)),
        piecewise((3, 3, 3), 1, ((1, 0.0), (2, 0.3))),
    ],
    ids=["smooth", "each segment by itself", "free speeds", "no stretch"],
)
def test_where_nothing_is_to_be_matched(curve: object) -> None:
    assert matched(question(ONWARDS, curve), 0) == []


def test_without_a_jerk_limit_nothing_is_matched() -> None:
    problem = Problem(ONWARDS[:, None], Limits([V], [A], joints=1), C1)
    assert matched(problem, 0) == []
