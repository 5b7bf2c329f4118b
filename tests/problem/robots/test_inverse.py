"""Inverse kinematics: round trips, bounds, and honest answers where there is none."""

import importlib
import re

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial.transform import Rotation
from support.chains import chains, rotation, translation
from trajgap.problem.cases.data_files import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots import inverse
from trajgap.problem.robots.chain import Chain, Convention, forward_kinematics
from trajgap.problem.robots.inverse import POSE, POSITION, IkStatus, inverse_kinematics
from trajgap.problem.robots.nearness import proximity

S = Convention.STANDARD
PLANAR = Chain(S, a=[0.7, 0.4], alpha=[0, 0], d=[0, 0], lower=[-3, -3], upper=[3, 3])


def misses(chain, q, target) -> tuple[float, float]:
    """Distance and angle to a pose, computed apart from the code under test."""
    end = forward_kinematics(chain, q)
    cosine = (np.trace(target[:3, :3].T @ end[:3, :3]) - 1) / 2
    # arccos loses half the digits near 1; the sine of the half angle does not.
    half = np.linalg.norm(target[:3, :3] - end[:3, :3]) / (2 * np.sqrt(2))
    angle = 2 * np.arcsin(min(1.0, half))
    assert abs(np.cos(angle) - cosine) < 1e-9
    return float(np.linalg.norm(end[:3, 3] - target[:3, 3])), float(angle)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(chains(fewest=2, bounds=True), st.integers(0, 2**32 - 1))
def test_round_trip_on_any_chain(chain, seed):
    rng = np.random.default_rng(seed)
    lower, upper = chain.span()
    q = rng.uniform(lower, upper)
    target = forward_kinematics(chain, q)
    found = inverse_kinematics(chain, target, seed, guess=q + rng.uniform(-0.3, 0.3, q.size))
    assert found.status is IkStatus.SOLVED
    assert found.solved
    distance, angle = misses(chain, found.joints, target)
    assert distance <= 1e-9
    assert angle <= 2e-9
    assert (chain.lower <= found.joints).all()
    assert (found.joints <= chain.upper).all()


@settings(max_examples=25, deadline=None)
@given(chains(fewest=1, bounds=True), st.integers(0, 2**32 - 1))
def test_an_answer_is_never_better_than_it_says(chain, seed):
    # Targets from another chain: most have no solution at all.
    rng = np.random.default_rng(seed)
    other = Chain(S, *rng.uniform(-0.7, 0.7, (3, 4)))
    target = forward_kinematics(other, rng.uniform(-3, 3, 4))
    found = inverse_kinematics(chain, target, seed, starts=4, iterations=40)
    distance, angle = misses(chain, found.joints, target)
    assert found.position_error == pytest.approx(distance, abs=1e-12)
    assert found.angle_error == pytest.approx(angle, abs=1e-7)
    assert found.solved == (found.position_error <= 1e-9 and found.angle_error <= 1e-9)
    assert found.solved == (found.solved_starts > 0)
    assert (chain.lower <= found.joints).all()
    assert (found.joints <= chain.upper).all()


@pytest.mark.parametrize("robot", ["puma560", "irb1600", "z1"])
def test_round_trip_from_random_starts_alone(robot):
    chain = load_robot(robot)
    rng = np.random.default_rng(4)
    for seed in range(15):
        target = forward_kinematics(chain, rng.uniform(*chain.span()))
        found = inverse_kinematics(chain, target, seed)
        assert found.solved
        assert max(misses(chain, found.joints, target)) < 2e-9


@pytest.mark.parametrize(
    "components", [("x", "y"), POSITION, ("y", "rx", "x", "z"), (*POSITION, "rz")]
)
def test_chosen_components_leave_the_others_free(components):
    """Rotations are components of the rotation vector in the base; their order does not matter."""
    chain = load_robot("puma560")
    target = forward_kinematics(chain, [0.3, 0.8, -1.2, 0.4, 0.9, -0.2])
    if not {"rx", "ry", "rz"} & set(components):
        target[:3, :3] = rotation("x", 2.0)[:3, :3] @ target[:3, :3]
    target[2, 3] += 0.0 if "z" in components else 5.0
    found = inverse_kinematics(chain, target, 3, components=components)
    assert found.solved
    assert (found.angle_error == 0.0) == (set(components) <= set(POSITION))
    end = forward_kinematics(chain, found.joints)
    turn = Rotation.from_matrix(target[:3, :3] @ end[:3, :3].T).as_rotvec()
    off = dict(zip(POSE, [*(target[:3, 3] - end[:3, 3]), *turn], strict=True))
    assert all(abs(off[name]) < 2e-9 for name in components)
    assert max(abs(off[name]) for name in set(POSE) - set(components)) > 1e-3
    again = inverse_kinematics(chain, target, 3, components=components[::-1])
    np.testing.assert_array_equal(again.joints, found.joints)


def test_same_seed_same_answer():
    chain = load_robot("puma560")
    target = forward_kinematics(chain, [0.3, 0.8, -1.2, 0.4, 0.9, -0.2])
    one, two = (inverse_kinematics(chain, target, 5) for _ in range(2))
    np.testing.assert_array_equal(one.joints, two.joints)
    rng = np.random.default_rng(5)
    np.testing.assert_array_equal(inverse_kinematics(chain, target, rng).joints, one.joints)


def test_turns_are_taken_off_towards_the_guess():
    free = Chain(S, a=[0.7, 0.4], alpha=[0, 0], d=[0, 0])
    target = forward_kinematics(free, [20.15, -12.98])
    found = inverse_kinematics(free, target, 0, guess=[20.1, -13.0])
    np.testing.assert_allclose(found.joints, [20.15, -12.98], atol=1e-8)


# Nothing there


@pytest.mark.parametrize(
    ("chain", "x", "y", "status", "joint", "value", "error"),
    [
        # Proved by the lengths: the nearest it gets is stretched out.
        (PLANAR, 1.2, 0.0, IkStatus.OUT_OF_REACH, 1, 0.0, 0.1),
        # A hole in the workspace: joint 2 stops at 3 rad, short of folding back.
        (PLANAR, 0.2, 0.0, IkStatus.NOT_FOUND, 1, 3.0, np.hypot(0.7 + 0.4 * np.cos(3.0),
                                                                0.4 * np.sin(3.0)) - 0.2),
        # Reached by joint 1 beyond its bound alone.
        (PLANAR.with_bounds([-0.2, -3], [0.2, 3]), -0.5, -0.6, IkStatus.NOT_FOUND, 0, 0.2, None),
    ],
)  # fmt: skip
def test_where_there_is_nothing_the_nearest_is_given(chain, x, y, status, joint, value, error):
    found = inverse_kinematics(chain, [x, y, 0], 0)
    assert (found.status, found.solved, found.solved_starts) == (status, False, 0)
    assert abs(found.joints[joint]) == pytest.approx(value, abs=1e-2 if value == 0 else 0)
    assert error is None or found.position_error == pytest.approx(error, abs=1e-6)
    assert inverse_kinematics(PLANAR, [-0.5, -0.6, 0], 0).solved


def test_joints_held_by_equal_bounds_stay():
    chain = load_robot("puma560")
    q = np.array([0.3, 0.8, -1.2, 0.4, 0.9, -0.2])
    held = chain.with_bounds([*q[:2], *chain.lower[2:]], [*q[:2], *chain.upper[2:]])
    found = inverse_kinematics(held, forward_kinematics(chain, q)[:3, 3], 2)
    assert found.solved
    np.testing.assert_array_equal(found.joints[:2], q[:2])


def test_a_tolerance_that_arithmetic_cannot_meet_is_not_met():
    chain = load_robot("puma560")
    target = forward_kinematics(chain, [0.3, 0.8, -1.2, 0.4, 0.9, -0.2])
    target[:3, :3] = (rotation("y", 0.1) @ target)[:3, :3]
    found = inverse_kinematics(chain, target, 1, tolerance=1e-30, starts=4)
    assert found.solved == (max(found.position_error, found.angle_error) <= 1e-30)


def test_a_stretched_arm_is_reached_at_its_singularity():
    found = inverse_kinematics(PLANAR, [0, 1.1, 0], 0, iterations=1000)
    assert found.solved
    np.testing.assert_allclose(found.joints, [np.pi / 2, 0], atol=1e-3)


def test_turning_matrix_equals_differences():
    rng = np.random.default_rng(6)
    for size in (1e-7, 1e-3, 0.3, 2.0, 3.1):
        vector = rng.normal(size=3)
        vector *= size / np.linalg.norm(vector)
        spin, h = rng.normal(size=3), 1e-6
        ahead, behind = (
            (Rotation.from_rotvec(vector) * Rotation.from_rotvec(-s * h * spin)).as_rotvec()
            for s in (1, -1)
        )
        slope = (behind - ahead) / (2 * h)
        np.testing.assert_allclose(inverse._turning(vector) @ spin, slope, atol=2e-8)


# Faults

POSE_AT = translation(0.3, 0.2, 0.1)


@pytest.mark.parametrize(
    ("target", "options", "message"),
    [
        ([[1, 2], [3, 4]], {}, "target: shape (2, 2); give a (4, 4) pose or a (3,) point"),
        (["a", "b", "c"], {}, "target: not numbers; give a (4, 4) pose or a (3,) point"),
        ([0, np.nan, 1], {}, "target: a number is not finite; correct it"),
        (2 * np.eye(4), {}, "target: is not a pose; give a rotation and the last row 0, 0, 0, 1"),
        (np.diag([1, 1, -1, 1.0]), {}, "target: is not a pose; give a rotation and the last row"),
        (np.ones((4, 4)), {}, "target: is not a pose; give a rotation and the last row 0, 0, 0, 1"),
        ([0, 0, 1], {"components": ("x", "rx")}, "components: 'rx' is none of x, y, z; use these"),
        (POSE_AT, {"components": ("q",)}, "components: 'q' is none of x, y, z, rx, ry, rz; use"),
        (POSE_AT, {"components": ()}, "components: none, or one is named twice; name each once"),
        (POSE_AT, {"components": ("x", "x")}, "components: none, or one is named twice; name"),
        (POSE_AT, {"starts": 0}, "inverse kinematics: 0 starts, 300 iterations, tolerance 1e-09"),
        (POSE_AT, {"iterations": 0}, "inverse kinematics: 32 starts, 0 iterations, tolerance"),
        (POSE_AT, {"tolerance": 0.0}, "tolerance 0.0; give at least 1 start, at least 1 iteration"),
        (POSE_AT, {"guess": [1.0]}, "joint values: shape (1,); give (..., 2), one per joint"),
        (POSE_AT, {"guess": [[1.0, 2.0]]}, "guess: shape (1, 2); give one value per joint"),
    ],
)
def test_faults(target, options, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        inverse_kinematics(PLANAR, target, 0, **options)


@pytest.mark.parametrize(
    ("point", "held", "message"),
    [
        ([1, 2], [0, 0], "point: is not a finite position; give three numbers, m"),
        ([1, 2, np.inf], [0, 0], "point: is not a finite position; give three numbers, m"),
        ([1, 2, 3], [0], "held: shape (1,) for 2 joints; give one number each, NaN for"),
        ([1, 2, 3], [0, np.inf], "held: shape (2,) for 2 joints; give one number each, NaN"),
    ],
)
def test_faults_of_a_point(point, held, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        proximity(PLANAR, point, held)


NAN = np.nan


@settings(max_examples=30, deadline=None)
@given(chains(fewest=2, bounds=True), st.integers(0, 2**32 - 1), st.integers(0, 2), st.booleans())
def test_bounds_hold_on_any_chain(chain, seed, count, radial):
    """Of a point, or of a distance from the base alone; with none to two joints free."""
    rng = np.random.default_rng(seed)
    lower, upper = chain.span()
    held = rng.uniform(lower, upper)
    free = rng.permutation(chain.joints)[:count]
    point = rng.uniform(-1, 1, 3)
    samples = np.tile(held, (3000, 1))
    samples[:, free] = rng.uniform(lower[free], upper[free], (3000, count))
    held[free] = NAN
    found = proximity(chain, point, held, tolerance=0.02, radial=radial)

    def distance(q):
        ends = forward_kinematics(chain, q)[..., :3, 3]
        if radial:
            return np.abs(np.linalg.norm(ends, axis=-1) - np.linalg.norm(point))
        return np.linalg.norm(ends - point, axis=-1)

    assert found.lower <= distance(samples).min() + 1e-12
    assert found.upper == pytest.approx(distance(found.joints), abs=1e-12)
    assert found.lower <= found.upper <= found.lower + 0.02 + 1e-12
    kept = np.isfinite(held)
    np.testing.assert_array_equal(found.joints[kept], held[kept])
    assert (lower[free] <= found.joints[free]).all()
    assert (found.joints[free] <= upper[free]).all()


def test_held_values_need_not_keep_the_bounds():
    chain = PLANAR.with_bounds([-1, -1], [1, 1])
    found = proximity(chain, [0, 0, 0], [2.5, NAN])
    assert found.joints[0] == 2.5
    assert abs(found.joints[1]) <= 1


def test_many_free_joints_end_with_a_valid_bound(monkeypatch):
    module = importlib.import_module("trajgap.problem.robots.nearness")
    monkeypatch.setattr(module, "_MOST_BOXES", 2000)
    chain = load_robot("puma560")
    found = proximity(chain, [2.5, 0, 0], np.full(6, NAN))
    lower, upper = chain.span()
    q = np.random.default_rng(0).uniform(lower, upper, (20_000, 6))
    seen = np.linalg.norm(forward_kinematics(chain, q)[:, :3, 3] - [2.5, 0, 0], axis=1).min()
    assert 0 <= found.lower <= seen
    assert found.lower < found.upper
    end = forward_kinematics(chain, found.joints)[:3, 3]
    assert np.linalg.norm(end - [2.5, 0, 0]) == pytest.approx(found.upper, abs=1e-14)
