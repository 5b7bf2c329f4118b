"""Optima where sides of limits differ or ends move: closed forms, and searches."""

import numpy as np
import pytest
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.problem import Interpolant, Limits, Problem, cubic_spline, rest_to_rest


def test_a_motion_that_never_turns_back_may_be_forbidden_to() -> None:
    found = solve(Problem([[0.0], [1.0]], Limits(velocity=[[0.0, 2.0]]), rest_to_rest(1, 3)))
    assert found.durations == pytest.approx([0.75], rel=1e-9)


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


def test_a_velocity_beyond_one_joints_limit_is_proved_infeasible() -> None:
    curve = cubic_spline(3, ((1, 0.0),), ((1, (0.1, -1.8)),))
    found = solve(problem_of(curve))
    assert found.status is Status.INFEASIBLE
    assert "velocity prescribed at break 3 exceeds the limit of joint 2" in found.why
    one_way = Limits([1.1, 1.7], [[-3.0, 3.0], [-1.0, 2.2]])
    bent = cubic_spline(3, ((1, 0.0),), ((2, (0.0, -1.5)),))
    assert solve(problem_of(bent, one_way)).status is Status.INFEASIBLE
    assert "exceeds" not in str(solve(problem_of(bent)).why)
