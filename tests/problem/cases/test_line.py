"""Way-points on a straight line of the robot's end, stated by the angles at its ends."""

from __future__ import annotations

import numpy as np
from support.case_texts import case_text
from support.refusals import Refusal, each_refusal
from trajgap.problem import ctraj, forward_kinematics, load_robot, parse_case

FIRST = [0.1, -0.6, 0.4, 0.2, 0.5, 0.1]
LAST = [0.3, -0.5, 0.3, 0.2, 0.4, 0.2]


def line_text(first: object = FIRST, last: object = LAST, unit: str = "rad") -> str:
    return case_text(
        f"line = {{ first = {first}, last = {last}, points = 4 }}",
        'family = "3-5-3"',
        joints="1 2 3 4 5 6",
        robot='model = "puma560"',
        unit=unit,
    )


def test_its_waypoints_are_those_of_ctraj_and_lie_on_the_line() -> None:
    problem = parse_case(line_text(), "line.toml").problem()
    arm = load_robot("puma560")
    poses = forward_kinematics(arm, np.array([FIRST, LAST]))
    line = ctraj(arm, *poses, 4, guess=FIRST)
    np.testing.assert_allclose(problem.waypoints, line.waypoints, atol=1e-9)
    np.testing.assert_array_equal(problem.waypoints[[0, -1]], [FIRST, LAST])
    ends = forward_kinematics(arm, problem.waypoints)[:, :3, 3]
    for k, share in enumerate(np.linspace(0, 1, 4)):
        np.testing.assert_allclose(ends[k], ends[0] + share * (ends[3] - ends[0]), atol=1e-9)


def test_its_angles_are_in_the_unit_of_the_file() -> None:
    degrees = [np.rad2deg(ends).tolist() for ends in (FIRST, LAST)]
    case = parse_case(line_text(*degrees, unit="deg"), "line.toml")
    other = parse_case(line_text(), "line.toml").problem()
    np.testing.assert_allclose(case.problem().waypoints, other.waypoints, atol=1e-9)
    statement = case.statement()
    assert statement.complete
    assert statement.waypoints is case.statement().waypoints  # computed once


@each_refusal("line")
def test_lines_that_are_refused(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(line_text()), "line.toml"), "line.toml: ")
