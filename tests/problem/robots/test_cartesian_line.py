"""Straight-line moves: poses on the line, one branch, and curves that leave it less and less."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from trajgap.nlp import solve
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    fit,
    forward_kinematics,
    jtraj,
    load_robot,
    rest_to_rest,
)
from trajgap.problem.robots.cartesian_line import ctraj

START = np.array([0.1, -0.6, 0.4, 0.2, 0.5, 0.1])


def ends(shift=(0.02, 0.12, 0.06), turn=(0.1, -0.2, 0.15)):
    arm = load_robot("puma560")
    first = forward_kinematics(arm, START)
    last = first.copy()
    last[:3, 3] += shift
    last[:3, :3] = Rotation.from_rotvec(turn).as_matrix() @ first[:3, :3]
    return arm, first, last


def test_poses_lie_on_the_line_in_equal_steps_and_turn_about_one_axis() -> None:
    arm, first, last = ends()
    line = ctraj(arm, first, last, 7, guess=START)
    np.testing.assert_allclose(line.waypoints[0], START, atol=1e-8)
    assert line.residual <= 1e-8
    reached = forward_kinematics(arm, line.waypoints)
    expected = first[:3, 3] + np.linspace(0, 1, 7)[:, None] * (last[:3, 3] - first[:3, 3])
    np.testing.assert_allclose(reached[:, :3, 3], expected, atol=1e-8)
    turns = [Rotation.from_matrix(reached[k, :3, :3] @ first[:3, :3].T) for k in range(7)]
    for k, turn in enumerate(turns):
        np.testing.assert_allclose(turn.as_rotvec(), k / 6 * np.array([0.1, -0.2, 0.15]), atol=1e-7)
    assert np.abs(np.diff(line.waypoints, axis=0)).max() < 0.5


def test_a_curve_through_more_points_leaves_the_line_less() -> None:
    arm, first, last = ends()
    off = []
    for points in (4, 7, 13):
        line = ctraj(arm, first, last, points, guess=START)
        curve = cubic_spline(points - 1)
        off.append(line.deviation(fit(curve, line.waypoints, np.full(points - 1, 0.3))))
    assert off[0] > 1e-5
    # Standing still at the ends, the clamped spline is of second order in the spacing there.
    assert all(b < a / 3 for a, b in pairwise(off))
    straight = ctraj(arm, first, last, 2, guess=START)
    joints = fit(jtraj(1), straight.waypoints, [1.0])
    assert straight.deviation(joints) > off[0]


def test_a_move_on_the_spot_turns_only() -> None:
    arm, first, last = ends(shift=(0.0, 0.0, 0.0))
    line = ctraj(arm, first, last, 5, guess=START)
    curve = rest_to_rest(4, 5)
    assert line.deviation(fit(curve, line.waypoints, np.full(4, 0.3))) < 5e-3


def test_its_waypoints_make_a_problem_like_any_other() -> None:
    arm, first, last = ends()
    line = ctraj(arm, first, last, 5, guess=START)
    problem = Problem(line.waypoints, Limits(2.0, 8.0, joints=6), cubic_spline(4))
    solution = solve(problem, starts=1)
    assert check(problem, solution.durations).verdict is Verdict.PASS


def test_what_cannot_be_done_is_said() -> None:
    arm, first, last = ends()
    with pytest.raises(TrajgapError, match="ctraj: 1 points make no line"):
        ctraj(arm, first, last, 1)
    with pytest.raises(TrajgapError, match="ctraj: last is no pose"):
        ctraj(arm, first, last[:3])
    far = last.copy()
    far[:3, 3] += [0.0, 5.0, 0.0]
    with pytest.raises(TrajgapError, match=r"ctraj: pose 2 of 5 is not found \(nearest 0.4"):
        ctraj(arm, first, far, 5, guess=START)
    with pytest.raises(TrajgapError, match=r"ctraj: joint \d moves .* rad between poses 1 and 2"):
        ctraj(arm, first, last, 3, guess=START, largest_step=1e-3)
