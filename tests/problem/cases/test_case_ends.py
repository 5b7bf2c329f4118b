"""End derivatives of case files: by end, by joint, in the file's units."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from trajgap.problem import Case, CaseError, Problem, check, cubic_spline, fit, parse_case

HEAD = """
format = 1
id = "ends"
title = "Ends that move"
[source]
title = "none"
[robot]
name = "arm"
joints = ["a", "b", "c"]
[units]
position = "deg"
velocity = "deg/s"
acceleration = "deg/s^2"
time = "s"
[waypoints]
waypoint_rows = [[10, -50, 3], [50, -30, 9], [12, 20, 30], [-25, 6, 4]]
[limits]
velocity = [63, 97, 80]
acceleration = [170, 126, 300]
[interpolant]
"""
H = np.array([0.8, 1.3, 0.7])


def case(interpolant: str, more: str = "") -> Case:
    return parse_case(f"{HEAD}{interpolant}\n{more}", "ends.toml")


def problem(interpolant: str, more: str = "", pid: str | None = None) -> Problem:
    return case(interpolant, more).problem(pid)


def test_velocities_by_end_and_by_joint_are_scipys() -> None:
    one = problem(
        'family = "cubic-spline"\nend_derivatives = [[28, -11, 0]]\n'
        'finish_derivatives = [["-17", 23, 5]]'
    )
    theirs = CubicSpline(
        np.concatenate([[0.0], np.cumsum(H)]),
        np.radians([[10, -50, 3], [50, -30, 9], [12, 20, 30], [-25, 6, 4]]),
        bc_type=((1, np.radians([28, -11, 0])), (1, np.radians([-17, 23, 5]))),
    )
    places = np.linspace(0.0, H.sum(), 31)
    np.testing.assert_allclose(fit(one.curve, one.waypoints, H)(places), theirs(places), atol=1e-12)


@pytest.mark.parametrize(
    ("written", "start", "finish"),
    [
        ("end_derivatives = [90]", {1: np.pi / 2}, {1: np.pi / 2}),
        ("end_derivatives = [90]\nfinish_derivatives = [0]", {1: np.pi / 2}, {1: 0.0}),
        ("finish_derivatives = [[90, 90, 90]]", {1: 0.0}, {1: np.pi / 2}),
        ("finish_orders = [2]", {1: 0.0}, {2: 0.0}),
        ("end_derivatives = [90]\nfinish_orders = [2]", {1: np.pi / 2}, {2: 0.0}),
        (
            "end_orders = [2]\nfinish_orders = [1]\nfinish_derivatives = [-180]",
            {2: 0.0},
            {1: -np.pi},
        ),
    ],
)
def test_which_end_a_value_is_for(
    written: str, start: dict[int, float], finish: dict[int, float]
) -> None:
    first, last = problem(f'family = "cubic-spline"\n{written}').curve.ends
    assert dict(first) == pytest.approx(start)
    assert dict(last) == pytest.approx(finish)


def test_polynomials_and_quintic_splines_take_accelerations_too() -> None:
    ends = "end_derivatives = [[28, -11, 0], 90]\nfinish_derivatives = [0, [0, 45, 0]]"
    for family in (
        'family = "quintic-spline"',
        'family = "polynomials"\ndegrees = [5, 5, 5]\ncontinuity = 4',
    ):
        one = problem(f"{family}\n{ends}")
        motion = fit(one.curve, one.waypoints, H)
        at = np.array([0.0, H.sum()])
        np.testing.assert_allclose(motion(at, 1)[0], np.radians([28, -11, 0]), atol=1e-10)
        np.testing.assert_allclose(motion(at, 1)[1], 0.0, atol=1e-10)
        np.testing.assert_allclose(motion(at, 2)[0], np.radians([90, 90, 90]), atol=1e-9)
        np.testing.assert_allclose(motion(at, 2)[1], np.radians([0, 45, 0]), atol=1e-9)


def test_a_problem_of_some_joints_has_their_ends() -> None:
    some = '[[problems]]\nid = "two"\njoints = ["c", "a"]'
    one = problem('family = "cubic-spline"\nend_derivatives = [[28, -11, 7]]', some, "two")
    order = [one.joints.index("c"), one.joints.index("a")]
    ((_, values),) = one.curve.ends[0]
    assert np.array(values)[order] == pytest.approx(np.radians([7, 28]))


def test_zeros_are_the_curve_that_says_nothing() -> None:
    written = 'family = "cubic-spline"\nend_derivatives = [[0, 0, 0]]\nfinish_derivatives = [0]'
    assert problem(written).curve == cubic_spline(3)


def test_printed_values_at_the_finish_are_intervals() -> None:
    pid, rid = "main", "as-printed"
    for values, loose in (("[[1, 2, 3]]", False), ('[[1, "2", 3]]', True)):
        one = case(f'family = "cubic-spline"\nfinish_derivatives = {values}')
        assert one.statement(pid, rid).loose_ends is loose


def test_readings_are_told_apart_by_their_ends() -> None:
    readings = """
[[readings]]
id = "rest"
why = "says the text"
[[readings]]
id = "on"
why = "says the figure"
[readings.interpolant]
family = "cubic-spline"
finish_derivatives = [[5, 0, -2]]
"""
    labels = case('family = "cubic-spline"', readings).labels
    assert "finish velocity 5 0 -2" in labels["on"]


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('family = "cubic-spline"\nend_derivatives = [[1, 2]]', r"interpolant.end_derivatives\[0"),
        (
            'family = "cubic-spline"\nfinish_derivatives = [[1, 2, 3, 4]]',
            r"interpolant.finish_derivatives\[0\]: 4 values for 3 joints",
        ),
        (
            'family = "cubic-spline"\nfinish_derivatives = [1, 2]',
            r"interpolant.finish_derivatives: 2 values for the 1 orders \[1\]; give one value per",
        ),
        ('family = "cubic-spline"\nfinish_orders = [2, 2]', r"interpolant.finish_orders: names"),
        (
            'family = "polynomials"\ndegrees = [9, 9, 9]\nfinish_orders = [4]\n'
            "finish_derivatives = [[0, 1, 0]]",
            r"interpolant.finish_derivatives\[0\]: order 4 has no unit; only 0",
        ),
        ('family = "3-5-3"\nfinish_derivatives = [0, 0]', r"finish_derivatives: does not go with"),
        ('family = "cubic-spline"\nend_derivatives = [[]]', r"end_derivatives.*: is an empty list"),
        ('family = "cubic-spline"\nend_orders = [3]\nend_derivatives = [[1, 0, 0]]', r"units.jerk"),
    ],
)
def test_what_does_not_fit_is_refused(written: str, message: str) -> None:
    with pytest.raises(CaseError, match=message):
        problem(written)


def test_values_of_joints_take_part_in_the_check() -> None:
    fast = problem('family = "cubic-spline"\nfinish_derivatives = [[0, 0, 81]]')
    worst = check(fast, 3 * H).worst
    assert worst is not None
    assert (worst.joint, worst.quantity) == ("c", "velocity")
    assert worst.ratio == pytest.approx(81 / 80, rel=1e-9)
