"""Forward kinematics and the Jacobian by second routes: hand-derived, elementary, a library."""

import re

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.chains import chains, elementary, rotation, translation
from trajgap.problem.cases.data_files import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots.chain import (
    Chain,
    Convention,
    JointKind,
    end_positions,
    forward_kinematics,
    geometric_jacobian,
    link_frames,
)

S, M = Convention.STANDARD, Convention.MODIFIED


def some(chain: Chain, count: int, seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2.7, 2.9, (count, chain.joints))


# Hand-derived transforms


def test_irb1600_equals_the_joint_axes_that_it_was_written_from():
    # Origins and axes of irb1600_6_12_macro.xacro, ROS-Industrial; tool0 turned by 90° about y.
    joints = [
        ((0, 0, 0), "z"),
        ((0.15, 0, 0.4865), "y"),
        ((0, 0, 0.475), "y"),
        ((0.3, 0, 0), "x"),
        ((0.3, 0, 0), "y"),
        ((0.065, 0, 0), "x"),
    ]
    chain = load_robot("irb1600")
    for q in some(chain, 20):
        pose = np.eye(4)
        for (origin, axis), angle in zip(joints, q, strict=True):
            pose = pose @ translation(*origin) @ rotation(axis, angle)
        pose = pose @ rotation("y", np.pi / 2)
        np.testing.assert_allclose(forward_kinematics(chain, q), pose, atol=1e-15)


# Identities on any chain


@settings(max_examples=60, deadline=None)
@given(chains(), st.randoms(use_true_random=False))
def test_product_of_elementary_transforms(chain, random):
    q = [random.uniform(-3, 3) for _ in range(chain.joints)]
    expected = elementary(chain, q)
    np.testing.assert_allclose(forward_kinematics(chain, q), expected, atol=1e-13)
    batch = np.array([[q, q[::-1]]])
    ends = forward_kinematics(chain, batch)[..., :3, 3]
    np.testing.assert_allclose(end_positions(chain, batch), ends, rtol=0, atol=1e-13)


@settings(max_examples=60, deadline=None)
@given(chains())
def test_jacobian_equals_differences(chain):
    q, h = some(chain, 1)[0], 1e-6
    jacobian = geometric_jacobian(chain, q)
    pose = forward_kinematics(chain, q)
    for j in range(chain.joints):
        step = h * np.eye(chain.joints)[j]
        rate = (forward_kinematics(chain, q + step) - forward_kinematics(chain, q - step)) / (2 * h)
        np.testing.assert_allclose(jacobian[:3, j], rate[:3, 3], atol=1e-8)
        spin = rate[:3, :3] @ pose[:3, :3].T
        expected = [spin[2, 1], spin[0, 2], spin[1, 0]]
        np.testing.assert_allclose(jacobian[3:, j], expected, atol=1e-8)


@settings(max_examples=60, deadline=None)
@given(chains())
def test_arms_and_reach_bound_the_end(chain):
    lower, upper = chain.span()
    q = np.random.default_rng(1).uniform(lower, upper, (200, chain.joints))
    frames = link_frames(chain, q)
    assert np.linalg.norm(frames[..., :3, 3], axis=-1).max() <= chain.reach + 1e-12
    speeds = np.linalg.norm(geometric_jacobian(chain, q)[:, :3], axis=1).max(axis=0)
    assert (speeds <= chain.arms + 1e-12).all()


def test_batches_lead():
    chain = load_robot("z1")
    q = some(chain, 12).reshape(2, 3, 2, 6)
    for compute in (forward_kinematics, link_frames, geometric_jacobian):
        whole = compute(chain, q)
        for at in np.ndindex(2, 3, 2):
            np.testing.assert_allclose(whole[at], compute(chain, q[at]), atol=1e-15)
        assert compute(chain, np.empty((0, 6))).shape == (0, *whole.shape[3:])
    np.testing.assert_array_equal(
        link_frames(chain, q)[..., -1, :, :], forward_kinematics(chain, q)
    )


# The chain itself


def test_span_is_one_turn_where_a_joint_is_free():
    inf = np.inf
    chain = Chain(S, [1] * 4, [0] * 4, [0] * 4, lower=[-inf, 0.5, -inf, -1], upper=[inf, inf, 2, 9])
    lower, upper = chain.span()
    np.testing.assert_allclose(lower, [-np.pi, 0.5, 2 - 2 * np.pi, -1])
    np.testing.assert_allclose(upper, [np.pi, 0.5 + 2 * np.pi, 2, 9])


def test_defaults_and_read_only_arrays():
    chain = Chain("modified", [0.1, 0.2], [0, 1], [0, 0])
    assert chain.convention is M
    assert chain.labels == ("1", "2")
    assert chain.kinds == (JointKind.REVOLUTE,) * 2
    assert np.isinf(chain.lower).all()
    with pytest.raises(ValueError, match="read-only"):
        chain.a[0] = 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"convention": "craig"}, "chain: 'craig' is not a valid Convention; use one of the words"),
        ({"kinds": ("screw", "revolute")}, "chain: 'screw' is not a valid JointKind; use one of"),
        ({"kinds": ("revolute",)}, "chain.kinds: 1 for 2 joints; give one each"),
        ({"labels": ("1", "2", "3")}, "chain.labels: 3 for 2 joints; give one each"),
        ({"a": []}, "chain.a: is empty; give one link length per joint"),
        ({"d": [0.1]}, "chain.d: shape (1,) for 2 joints; give one number each"),
        ({"alpha": [0, np.nan]}, "chain.alpha: contains a number that is not finite; correct it"),
        ({"a": [0, np.inf]}, "chain.a: contains a number that is not finite; correct it"),
        ({"lower": [np.inf, 0]}, "chain.lower: contains a number that is not finite; correct it"),
        ({"upper": [np.nan, 0]}, "chain.upper: contains a number that is not finite; correct it"),
        ({"lower": [0, 2], "upper": [1, 1]}, "chain.lower: lies above chain.upper; exchange them"),
    ],
)
def test_faults_of_a_chain(change, message):
    good = {"convention": S, "a": [0.3, 0.2], "alpha": [0, 0], "d": [0, 0]}
    with pytest.raises(TrajgapError, match=re.escape(message)):
        Chain(**{**good, **change})


@pytest.mark.parametrize(
    ("q", "message"),
    [
        ([0.1, 0.2], "joint values: shape (2,); give (..., 6), one per joint"),
        (0.1, "joint values: shape (); give (..., 6), one per joint"),
        ([[0, 0, 0, 0, 0, np.nan]], "joint values: one is not finite; give rad"),
        (["a"] * 6, "joint values: not numbers; give rad, (..., joints)"),
    ],
)
@pytest.mark.parametrize("compute", [forward_kinematics, link_frames, geometric_jacobian])
def test_faults_of_joint_values(compute, q, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        compute(load_robot("puma560"), q)


def test_a_joint_that_slides_freely_has_no_span():
    chain = Chain(S, [0, 0], [0, 0], [0, 0], kinds=("revolute", "prismatic"))
    with pytest.raises(TrajgapError, match="joint '2' slides without bounds; give lower and upper"):
        chain.span()
    assert chain.reach == np.inf
