"""Limits and problems: what they fill in, what they freeze, and what they refuse in one line."""

import dataclasses

import numpy as np
import pytest
from trajgap.problem import (
    QUANTITIES,
    Coupling,
    Limits,
    Problem,
    TrajgapError,
    check,
    cubic_spline_virtual,
    piecewise,
    three_five_three,
)

WAYPOINTS = np.array([[0.19, -1.63], [0.82, -2.01], [0.13, -1.07], [-0.88, -1.31]])


def problem_with(**changes: object) -> Problem:
    given = {
        "waypoints": WAYPOINTS,
        "limits": Limits([5.0, 3.0], [8.0, 11.0]),
        "curve": three_five_three(),
    }
    return Problem(**{**given, **changes})  # type: ignore[arg-type]


def test_limits_fill_in() -> None:
    limits = Limits(2, [3, 4], position_upper=[np.inf, 1.5])
    assert limits.joints == 2
    np.testing.assert_array_equal(limits.velocity, [2, 2])
    np.testing.assert_array_equal(limits.derivatives, [[2, 3, np.inf], [2, 4, np.inf]])
    np.testing.assert_array_equal(limits.position_lower, [-np.inf, -np.inf])
    assert limits.limits_position
    assert not Limits(2, 3).limits_position
    assert Limits(2, 3).joints == 1
    np.testing.assert_array_equal(Limits(2, joints=3).velocity, [2, 2, 2])
    assert QUANTITIES == ("velocity", "acceleration", "jerk")


def test_limits_are_frozen_copies() -> None:
    given = np.array([2.0, 3.0])
    limits = Limits(given)
    given[0] = 99.0
    assert limits.velocity[0] == 2.0
    with pytest.raises(ValueError, match="read-only"):
        limits.velocity[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        limits.velocity = given  # type: ignore[misc]


def test_limits_of_one_joint_and_replaced() -> None:
    limits = Limits([1, 2], [3, 4], [5, 6], [-7, -8], [9, 10])
    one = limits.joint(1)
    assert one.joints == 1
    np.testing.assert_array_equal(one.derivatives, [[2, 4, 6]])
    assert (one.position_lower[0], one.position_upper[0]) == (-8, 10)
    other = limits.with_derivatives([[11, 12, 13], [14, 15, 16]])
    np.testing.assert_array_equal(other.derivatives, [[11, 12, 13], [14, 15, 16]])
    np.testing.assert_array_equal(other.position_lower, limits.position_lower)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"velocity": [1, 2], "jerk": [1, 2, 3]}, r"limits.velocity: expected one value or 3"),
        ({"acceleration": np.ones((2, 3))}, r"limits.acceleration: .* got shape \(2, 3\)"),
        ({"acceleration": np.ones((2, 2))}, r"limits.acceleration: 1 to 1 leaves out 0"),
        ({"velocity": [1, 2], "joints": 3}, r"limits.velocity: expected one value or 3"),
        ({"velocity": [1, np.nan]}, r"limits.velocity: is NaN; write inf where there is no limit"),
        ({"position_upper": np.nan}, r"limits.position_upper: is NaN"),
        ({"jerk": [-1, 2]}, r"limits.jerk: is negative; give the largest absolute value, 0 or"),
        ({"velocity": -np.inf}, r"limits.velocity: is negative"),
        ({"velocity": "fast"}, r"limits.velocity: not numbers; give one value, or one per joint"),
        ({"jerk": [1, [2, 3]]}, r"limits.jerk: not numbers"),
        (
            {"position_lower": [0, 2], "position_upper": [1, 1]},
            r"limits.position_lower: lies above limits.position_upper",
        ),
    ],
)
def test_limits_refuse(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        Limits(**arguments)  # type: ignore[arg-type]


def test_problem_fills_in() -> None:
    problem = problem_with(duration_lower=0.3, duration_upper=[1.0, 2.0, 3.0])
    assert problem.joints == ("1", "2")
    assert problem.segments == 3
    assert problem.coupling is Coupling.SHARED
    np.testing.assert_array_equal(problem.duration_lower, [0.3, 0.3, 0.3])
    np.testing.assert_array_equal(problem.duration_upper, [1.0, 2.0, 3.0])
    assert problem_with(coupling="per-joint").coupling is Coupling.PER_JOINT
    np.testing.assert_array_equal(problem_with().duration_lower, np.zeros(3))
    assert np.isinf(problem_with().duration_upper).all()


def test_one_joint_as_a_plain_list() -> None:
    problem = Problem([0.1, 0.5, 0.2, 0.9], Limits(2, 5), three_five_three())
    assert problem.waypoints.shape == (4, 1)


def test_one_limit_for_all_joints() -> None:
    problem = problem_with(limits=Limits(2, 5, 9, -3, 4))
    np.testing.assert_array_equal(problem.limits.derivatives, [[2, 5, 9], [2, 5, 9]])
    np.testing.assert_array_equal(problem.limits.position_upper, [4, 4])


def test_problem_is_a_frozen_copy() -> None:
    given = WAYPOINTS.copy()
    problem = problem_with(waypoints=given)
    given[:] = 0.0
    np.testing.assert_array_equal(problem.waypoints, WAYPOINTS)
    with pytest.raises(ValueError, match="read-only"):
        problem.waypoints[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        problem.duration_lower[0] = 1.0


def test_joint_alone_is_judged_alike() -> None:
    problem = problem_with(joints=("shoulder", "elbow"), duration_lower=0.2, coupling="per-joint")
    h = [0.7, 0.9, 0.8]
    whole = check(problem, h)
    for j, label in enumerate(problem.joints):
        alone = problem.joint(j)
        assert alone.joints == (label,)
        assert alone.coupling is Coupling.SHARED
        assert alone.name == f"problem, joint {label}"
        np.testing.assert_array_equal(alone.duration_lower, problem.duration_lower)
        mine = [p.ratio for p in check(alone, h).peaks if p.joint]
        assert mine == [p.ratio for p in whole.peaks if p.joint == label]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"waypoints": np.ones((4, 2, 2))}, r"waypoints: expected shape \(way-points, joints\)"),
        ({"waypoints": np.ones((4, 0))}, r"waypoints: expected shape .* got \(4, 0\)"),
        ({"waypoints": np.full((4, 2), np.nan)}, r"waypoints: every angle must be finite"),
        ({"waypoints": np.full((4, 2), np.inf)}, r"waypoints: every angle must be finite"),
        ({"waypoints": WAYPOINTS[:3]}, r"waypoints: 3-5-3 polynomials with 3 segments needs 4"),
        ({"curve": cubic_spline_virtual(5)}, r"waypoints: C2 cubic spline with two virtual .*"),
        ({"limits": Limits([1, 2, 3])}, r"limits: given for 3 joints, way-points for 2"),
        ({"duration_lower": [0.1, 0.2]}, r"duration_lower: expected one value or 3, got 2"),
        ({"duration_upper": np.ones((3, 1))}, r"duration_upper: expected one value or 3, got 3"),
        ({"duration_lower": np.nan}, r"duration_lower: must be 0 or more and not NaN"),
        ({"duration_upper": [1, -1, 1]}, r"duration_upper: must be 0 or more and not NaN"),
        (
            {"duration_lower": 2, "duration_upper": [3, 1, 3]},
            r"duration_lower: lies above duration_upper",
        ),
        ({"duration_lower": np.inf}, r"duration bounds: no positive finite duration lies between"),
        ({"duration_upper": [1, 0, 1]}, r"duration bounds: no positive finite duration lies"),
        ({"joints": ("a",)}, r"joints: 1 labels for 2 joints"),
        ({"joints": ("a", "a")}, r"joints: a label occurs twice in a, a"),
        ({"waypoints": "abc"}, r"waypoints: not a table of numbers; give one row per way-point"),
        ({"waypoints": [[1, 2], [3], [4, 5], [6, 7]]}, r"waypoints: not a table of numbers"),
        ({"coupling": "loose"}, r"coupling: 'loose' is none of shared, per-joint"),
        ({"duration_lower": "short"}, r"duration_lower: not numbers; give seconds"),
    ],
)
def test_problem_refuses(changes: dict[str, object], message: str) -> None:
    with pytest.raises(TrajgapError, match=message) as refusal:
        problem_with(**changes)
    assert "\n" not in str(refusal.value)


def test_every_refusal_is_a_value_error() -> None:
    assert issubclass(TrajgapError, ValueError)
    with pytest.raises(TrajgapError, match="over-determined"):
        piecewise((3, 3, 3), 2)
