"""Limits and problems: what they fill in, what they freeze, and what they refuse in one line."""

import dataclasses
import pickle
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.interpolate import PPoly
from support.two_joints import WAYPOINTS, two_joints
from trajgap.nlp import problem_seal
from trajgap.problem import (
    QUANTITIES,
    Coupling,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    fit,
    keeps_limits,
    piecewise,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.problem.checks import worst_ratios
from trajgap.problem.motions import JointLimits, as_motion, check_motion

problem_with = partial(two_joints, limits=Limits([5.0, 3.0], [8.0, 11.0]))


FORMS = {
    "one size": (3.0, -3.0, 3.0),
    "sizes": ([3.0, 4.0], [-3.0, -4.0], [3.0, 4.0]),
    "pairs": ([[-2.0, 5.0], [-np.inf, 7.0]], [-2.0, -np.inf], [5.0, 7.0]),
    "equal pairs": ([[-3.0, 3.0], [-4.0, 4.0]], [-3.0, -4.0], [3.0, 4.0]),
    "nothing": (None, -np.inf, np.inf),
}
"""What may be given of two joints, and what it means below 0 and above."""


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("order", range(4), ids=QUANTITIES)
def test_limits_are_what_was_given(order: int, form: str) -> None:
    given, low, high = FORMS[form]
    name = QUANTITIES[order]
    ranges = {"position_lower": -7, "position_upper": [np.inf, 1.5]}
    limits = Limits(**({} if given is None else {name: given}), **ranges, joints=2)  # type: ignore[arg-type]
    ends = np.array([np.broadcast_to(low, 2), np.broadcast_to(high, 2)])
    for one in (limits, pickle.loads(pickle.dumps(limits)), limits.with_sides(limits.sides)):
        np.testing.assert_array_equal(one.ends(name), ends)
        sides = np.full((2, 2, max(3, order + 1)), np.inf)
        sides[:, :, order] = np.abs(ends)
        # Snap has a column where it is limited.
        columns = 3 if form == "nothing" else sides.shape[2]
        np.testing.assert_array_equal(one.sides, sides[:, :, :columns])
        np.testing.assert_array_equal(one.position_lower, [-7, -7])
        np.testing.assert_array_equal(one.position_upper, [np.inf, 1.5])
    assert limits.uneven == limits.is_uneven(name) == (form == "pairs")
    np.testing.assert_array_equal(limits.widest, limits.sides.max(axis=0))
    np.testing.assert_array_equal(limits.hull.derivatives, limits.widest)
    np.testing.assert_array_equal(limits.joint(1).sides, limits.sides[:, 1:])
    assert (limits.joint(1).joints, limits.joint(1).position_upper.tolist()) == (1, [1.5])
    assert limits.limits_position
    if limits.uneven:
        for size in (name, "derivatives"):
            with pytest.raises(TrajgapError, match="differ in size"):
                getattr(limits, size)
    else:
        assert limits.hull is limits
        np.testing.assert_array_equal(getattr(limits, name), ends[1])
        again = limits.with_derivatives(limits.derivatives)
        np.testing.assert_array_equal(again.position_lower, limits.position_lower)
        np.testing.assert_array_equal(again.derivatives, limits.derivatives)


def test_limits_without_a_number_of_joints() -> None:
    assert (Limits(2, 3).joints, Limits(2, [3, 4]).joints) == (1, 2)
    assert not Limits(2, 3).limits_position


def test_a_deceleration_of_its_own_is_no_size_of_acceleration() -> None:
    limits = Limits(9.0, [2.0, 5.0, 4.0], deceleration=[3.0, 1.0, 4.0])
    np.testing.assert_array_equal(limits.braking, [True, True, False])
    np.testing.assert_array_equal(limits.sides[1, :, 1], [3.0, 5.0, 4.0])
    np.testing.assert_array_equal(limits.narrow.acceleration, [2.0, 1.0, 4.0])
    np.testing.assert_array_equal(limits.hull.acceleration, [3.0, 5.0, 4.0])
    with pytest.raises(TrajgapError, match=r"limits.deceleration: a limit of its own"):
        _ = limits.acceleration
    assert limits.same(limits.with_deceleration([3.0, 1.0, np.inf]))
    assert not limits.same(limits.with_deceleration([3.0, 2.0, 4.0]))
    back = JointLimits.of(limits, ("a", "b", "c")).two_sided
    assert back.same(limits)
    assert limits.joint(2).acceleration == 4.0
    with pytest.raises(TrajgapError, match=r"limits.snap: motions from elsewhere"):
        JointLimits.of(Limits(snap=1.0), ("a",))
    assert list(Limits(jerk=[1.0, np.inf], snap=[np.inf, 1]).smooth_orders) == [2, 3]
    assert Limits(velocity=1.0).smooth_orders == 1


def test_what_was_given_is_copied_and_frozen() -> None:
    given = {"velocity": np.array([2.0, 3.0])}
    points = WAYPOINTS.copy()
    problem = problem_with(waypoints=points, limits=Limits(**given))
    given["velocity"][0] = points[:] = 99.0
    assert problem.limits.velocity[0] == 2.0
    np.testing.assert_array_equal(problem.waypoints, WAYPOINTS)
    for array in (problem.limits.velocity, problem.waypoints, problem.duration_lower):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        problem.limits.velocity = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"velocity": [1, 2], "jerk": [1, 2, 3]}, r"limits.velocity: expected one value or 3"),
        ({"acceleration": np.ones((2, 3))}, r"limits.acceleration: .* got shape \(2, 3\)"),
        ({"velocity": [1, 2], "joints": 3}, r"limits.velocity: expected one value or 3"),
        ({"velocity": [1, np.nan]}, r"limits.velocity: is NaN; write inf for no limit"),
        ({"position_upper": np.nan}, r"limits.position_upper: is NaN"),
        ({"jerk": [-1, 2]}, r"limits.jerk: is negative; give the largest absolute value, 0 or"),
        ({"velocity": -np.inf}, r"limits.velocity: is negative"),
        ({"velocity": [[1, 2]]}, r"limits.velocity: 1 to 2 leaves out 0"),
        ({"velocity": [[-2, -1]]}, r"limits.velocity: .* leaves out 0"),
        ({"velocity": [[np.nan, 1]]}, r"limits.velocity: is NaN"),
        ({"velocity": "fast"}, r"limits.velocity: not numbers; give one value, or one per joint"),
        ({"jerk": [1, [2, 3]]}, r"limits.jerk: not numbers"),
        ({"acceleration": [[-1, 2]], "deceleration": 1.0}, r"deceleration: .* one finite size"),
        ({"deceleration": 1.0}, r"limits.deceleration: must be positive, and go with one finite"),
        ({"acceleration": 2.0, "deceleration": 0.0}, r"limits.deceleration: must be positive"),
        ({"position_lower": [0, 2], "position_upper": [1, 1]}, r"position_lower: lies above lim"),
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
    assert Problem([0.1, 0.5, 0.2, 0.9], Limits(2), three_five_three()).waypoints.shape == (4, 1)
    same = problem_with(limits=Limits(2, 5, 9, -3, 4)).limits
    np.testing.assert_array_equal(same.derivatives, [[2, 5, 9], [2, 5, 9]])
    np.testing.assert_array_equal(same.position_upper, [4, 4])
    pair = problem_with(limits=Limits(acceleration=[[-15, 10]]))
    np.testing.assert_array_equal(pair.limits.ends("acceleration"), [[-15, -15], [10, 10]])
    assert not pair.hull.limits.uneven
    alone = problem_with(joints=("shoulder", "elbow"), duration_lower=0.2).joint(1)
    assert (alone.joints, alone.coupling) == (("elbow",), Coupling.SHARED)
    assert alone.name == "problem, joint elbow"
    np.testing.assert_array_equal(alone.duration_lower, [0.2] * 3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"waypoints": np.ones((4, 2, 2))}, r"waypoints: expected shape \(way-points, joints\)"),
        ({"waypoints": np.ones((4, 0))}, r"waypoints: expected shape .* got \(4, 0\)"),
        ({"waypoints": np.full((4, 2), np.nan)}, r"waypoints: every angle must be finite"),
        ({"waypoints": np.full((4, 2), np.inf)}, r"waypoints: every angle must be finite"),
        ({"waypoints": WAYPOINTS[:3]}, r"waypoints: 3-5-3 polynomials with 3 segments needs 4"),
        ({"curve": cubic_spline_virtual(5)}, r"waypoints: C2 cubic spline with two virtual .*"),
        (
            {"curve": uniform_cubic_b_spline(4, "timed"), "limits": Limits(1, 2, deceleration=1)},
            r"limits.deceleration: a limit of its own is not supported on a uniform cubic B-spline",
        ),
        ({"limits": Limits([1, 2, 3])}, r"limits: given for 3 joints, way-points for 2"),
        ({"duration_lower": [0.1, 0.2]}, r"duration_lower: expected one value or 3, got 2"),
        ({"duration_upper": np.ones((3, 1))}, r"duration_upper: expected one value or 3, got 3"),
        ({"duration_lower": np.nan}, r"duration_lower: must be 0 or more and not NaN"),
        ({"duration_upper": [1, -1, 1]}, r"duration_upper: must be 0 or more and not NaN"),
        ({"duration_lower": 2, "duration_upper": [3, 1, 3]}, r"duration_lower: lies above dura"),
        ({"duration_lower": np.inf}, r"duration bounds: no positive finite duration lies between"),
        ({"duration_upper": [1, 0, 1]}, r"duration bounds: no positive finite duration lies"),
        ({"joints": ("a",)}, r"joints: 1 labels for 2 joints"),
        ({"joints": ("a", "a")}, r"joints: a label occurs twice in a, a"),
        ({"waypoints": "abc"}, r"waypoints: not a table of numbers; give one row per way-point"),
        ({"waypoints": [[1, 2], [3], [4, 5], [6, 7]]}, r"waypoints: not a table of numbers"),
        ({"ratios": [1, 2, 3, 4]}, r"ratios: expected 3, one per segment, got 4"),
        ({"ratios": 1.0}, r"ratios: expected 3, one per segment, got 1"),
        ({"ratios": [1, 0, 1]}, r"ratios: every one must be positive and finite"),
        ({"ratios": [1, np.inf, 1]}, r"ratios: every one must be positive and finite"),
        ({"ratios": [1, np.nan, 1]}, r"ratios: every one must be positive and finite"),
        ({"ratios": [1, 1, 1e13]}, r"ratios: the largest is more than 1e\+12 times the smallest"),
        ({"ratios": [1, 1, "x"]}, r'ratios: not numbers; give one per segment, "equal" or "chord"'),
        ({"ratios": "even"}, r"ratios: 'even' is unknown; give one number per segment"),
        ({"ratios": "chord", "waypoints": WAYPOINTS[[0, 1, 1, 2]]}, r"2 and 3, which coincide"),
        (
            {"ratios": "chord", "waypoints": WAYPOINTS[:3], "curve": cubic_spline_virtual(3)},
            r'ratios: "chord" needs a way-point at every end of the 4',
        ),
        ({"coupling": "loose"}, r"coupling: 'loose' is none of shared, per-joint"),
        ({"duration_lower": "short"}, r"duration_lower: not numbers; give seconds"),
    ],
)
def test_problem_refuses(changes: dict[str, object], message: str) -> None:
    with pytest.raises(TrajgapError, match=message) as refusal:
        problem_with(**changes)
    assert "\n" not in str(refusal.value)


def test_a_side_of_zero_forbids_that_side_alone() -> None:
    rising, curve = np.array([[0.0], [1.0]]), rest_to_rest(1, 3)
    forward = Limits(velocity=[[0, 2]])
    assert check(Problem(rising, forward, curve), [1.0]).verdict is Verdict.PASS
    back = check(Problem(-rising, forward, curve), [1.0])
    assert worst_ratios(Problem(-rising, forward, curve), fit(curve, -rising, [1.0])) == 0.0
    assert back.verdict is Verdict.VIOLATED
    assert back.feasible_time is None
    assert not keeps_limits(Problem(-rising, forward, curve), np.array([[1.0]]), 1e-9)[0]
    free = Limits(velocity=[[-np.inf, 2]])
    unlimited = check(Problem(-rising, free, curve), [1e-3])
    assert unlimited.verdict is Verdict.PASS
    assert unlimited.peaks[0].ratio == 0.0
    # At -1 rad/s all the way, nothing lies on the limited side.
    steady = check(Problem(-rising, free, piecewise((1,), 0, ())), [1.0])
    assert (steady.verdict, steady.peaks[0].ratio) == (Verdict.PASS, 0.0)


Q = np.array([[0.2, -1.0], [0.5, -0.6], [0.5, 0.6]])


def posed(ratios: object, **other: object) -> Problem:
    return Problem(Q, Limits(1.0), cubic_spline(2), ratios=ratios, **other)


@pytest.mark.parametrize(
    ("ratios", "shares"),
    [
        ("equal", [0.5, 0.5]),
        ("chord", [0.5 / 1.7, 1.2 / 1.7]),
        ([1, 3], [0.25, 0.75]),
        ([1e200, 3e200], [0.25, 0.75]),
        ((1e-310, 3e-310), [0.25, 0.75]),
    ],
)
def test_their_scale_is_irrelevant(ratios, shares) -> None:
    problem = posed(ratios)
    np.testing.assert_allclose(problem.shares, shares, rtol=1e-12)
    for same in (problem.joint(1), problem.hull, replace(problem, name="x")):
        assert same.shares.tolist() == problem.shares.tolist()
    assert pickle.loads(pickle.dumps(problem)).shares.tolist() == problem.shares.tolist()
    assert not problem.ratios.flags.writeable


def test_the_seal_of_a_question_holds_its_ratios() -> None:
    free = Problem(Q, Limits(1.0), cubic_spline(2))
    assert free.ratios is free.shares is free.unscaled is None
    seals = {problem_seal(one) for one in (free, posed("equal"), posed("chord"), posed([1, 3]))}
    assert len(seals) == 4
    assert problem_seal(posed([2, 6])) == problem_seal(posed([1, 3]))
    assert problem_seal(posed([5, 5])) == problem_seal(posed("equal"))
    ends = [cubic_spline(3, ((1, (0.5, -0.2)),), ((1, (-0.3, last)),)) for last in (0.4, 0.5)]
    assert len({problem_seal(problem_with(curve=one)) for one in ends}) == 2


def test_limits_of_another_class_are_named() -> None:
    curve = cubic_spline(1)
    stated = JointLimits.from_values(("a",), velocity=1.0)
    motion = as_motion(PPoly(np.zeros((2, 1, 1)), [0.0, 1.0]), ("a",))
    with pytest.raises(TrajgapError, match=r"limits: float is not Limits; write Limits\(velocity"):
        Problem([[0.0], [1.0]], 1.0, curve)  # type: ignore[arg-type]
    with pytest.raises(TrajgapError, match="limits: JointLimits is not Limits"):
        Problem([[0.0], [1.0]], stated, curve)  # type: ignore[arg-type]
    with pytest.raises(TrajgapError, match="limits: Limits is not JointLimits; write"):
        check_motion(motion, Limits(1.0))  # type: ignore[arg-type]
    with pytest.raises(TrajgapError, match="velocity of joint a: is negative"):
        JointLimits.from_values(("a",), velocity=-1.0)
