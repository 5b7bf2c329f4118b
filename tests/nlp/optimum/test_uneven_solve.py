"""Optima where sides of limits differ or ends move: closed forms, and searches."""

import numpy as np
import pytest
from support.uneven import LIMITS, WAYPOINTS, uneven_problem
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Verdict,
    cubic_spline,
    piecewise,
    rest_to_rest,
)


def test_a_closed_form() -> None:
    """A rest-to-rest cubic over 1 rad has |a| = 6/h² on both sides: the smaller size decides."""
    line, curve = np.array([[0.0], [1.0], [-1.0]]), rest_to_rest(2, 3)
    found = solve(Problem(line, Limits(velocity=[[-0.5, 2.0]]), curve))
    # max |v| of a way d is 1.5 |d|/h: forth at 2, back at 0.5.
    assert found.durations == pytest.approx([0.75, 6.0], rel=1e-9)
    found = solve(Problem(line, Limits(acceleration=[[-1.5, 6.0]]), curve))
    assert found.durations == pytest.approx([2.0, np.sqrt(8.0)], rel=1e-9)
    # The motion never turns back, so that it may be forbidden to.
    found = solve(Problem(line[:2], Limits(velocity=[[0.0, 2.0]]), rest_to_rest(1, 3)))
    assert found.durations == pytest.approx([0.75], rel=1e-9)


def test_position_limits_hold_beside_uneven_ones() -> None:
    free = uneven_problem("quintic")
    motion = solve(free).trajectory
    # Joint 2 swings past its second way-point at 0.3; it may do so by half as much.
    most = float(motion(np.linspace(0.0, motion.total_time, 2001))[:, 1].max())
    assert most > 0.3 + 1e-2
    limits = LIMITS.with_positions([-np.inf, -np.inf], [np.inf, 0.15 + 0.5 * most])
    found = solve(Problem(WAYPOINTS, limits, free.curve))
    assert found.check.verdict is Verdict.PASS
    assert found.total_time > motion.total_time * (1 + 1e-6)


def test_a_search_stays_where_curves_have_coefficients() -> None:
    """One side is all but forbidden, and the joint has to turn: longer durations never keep it."""
    line = np.array([[-0.507552], [-0.232662], [0.0889934], [-0.112367]])
    limits = Limits(velocity=[[-1.145e-5, 1.042]])
    found = solve(Problem(line, limits, cubic_spline(3, ((1, 0.0212686),))))
    assert found.status is Status.NONE_FOUND
    assert found.why is not None
    assert "least excess" in found.why


WAY = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
WITHIN = Limits([1.1, 1.7], [3.0, 2.2])


def problem_of(curve: Interpolant, limits: Limits = WITHIN, **more: object) -> Problem:
    return Problem(WAY, limits, curve, 0.05, 6.0, **more)


def test_a_straight_line_has_a_closed_form() -> None:
    """One cubic, v₀ to v₁: with v alone limited by its peak; joint 2 stands and never decides."""
    curve = piecewise((3,), 2, ((1, (0.4, 0.0)),), finish=((1, (0.9, 0.0)),))
    found = solve(Problem([[0.0, 0.2], [1.0, 0.2]], Limits(1.0, joints=2), curve))
    # v(s) = v₀ + (6d/h − 4v₀ − 2v₁)s + (3(v₀ + v₁) − 6d/h)s², and its peak is 1.
    total = found.total_time
    a, b = 6 / total - 4 * 0.4 - 2 * 0.9, 3 * (0.4 + 0.9) - 6 / total
    assert 0.4 - a * a / (4 * b) == pytest.approx(1.0, abs=1e-9)


def test_a_velocity_beyond_one_joints_limit_is_proved_infeasible() -> None:
    curve = cubic_spline(3, ((1, 0.0),), ((1, (0.1, -1.8)),))
    found = solve(problem_of(curve))
    assert found.status is Status.INFEASIBLE
    assert "velocity prescribed at break 3 exceeds the limit of joint 2" in found.why
    one_way = Limits([1.1, 1.7], [[-3.0, 3.0], [-1.0, 2.2]])
    bent = cubic_spline(3, ((1, 0.0),), ((2, (0.0, -1.5)),))
    assert solve(problem_of(bent, one_way)).status is Status.INFEASIBLE
    assert "exceeds" not in str(solve(problem_of(bent)).why)
