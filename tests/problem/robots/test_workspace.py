"""The sampled workspace and families of way-points: bounds, seeds, step lengths."""

from __future__ import annotations

import re

import numpy as np
import pytest
from trajgap.problem.cases.robot_file import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots.chain import Chain, Convention, forward_kinematics
from trajgap.problem.robots.workspace import StepKind, sample_workspace, waypoint_sequences

PUMA = load_robot("puma560")
CLOUD = sample_workspace(PUMA, 4000, 7)


def test_points_are_those_of_the_joints_and_keep_the_bounds():
    assert CLOUD.joints.shape == (4000, 6)
    ends = forward_kinematics(PUMA, CLOUD.joints)[:, :3, 3]
    np.testing.assert_array_equal(CLOUD.points, ends)
    assert (PUMA.lower <= CLOUD.joints).all()
    assert (CLOUD.joints <= PUMA.upper).all()
    # A tenth of each range at either end is met.
    width = PUMA.upper - PUMA.lower
    assert (CLOUD.joints.min(axis=0) < PUMA.lower + 0.1 * width).all()
    assert (CLOUD.joints.max(axis=0) > PUMA.upper - 0.1 * width).all()


def test_the_seed_decides_and_the_first_samples_do_not_depend_on_the_count():
    np.testing.assert_array_equal(sample_workspace(PUMA, 100, 7).joints, CLOUD.joints[:100])
    assert not np.array_equal(sample_workspace(PUMA, 100, 8).joints, CLOUD.joints[:100])


def test_batches_leave_no_seam(monkeypatch):
    from trajgap.problem.robots import workspace

    monkeypatch.setattr(workspace, "_BATCH", 33)
    np.testing.assert_array_equal(sample_workspace(PUMA, 100, 7).points, CLOUD.points[:100])


def test_a_planar_arm_fills_its_ring():
    ring = Chain(Convention.STANDARD, a=[0.7, 0.4], alpha=[0, 0], d=[0, 0.2], name="ring")
    cloud = sample_workspace(ring, 20_000, 1)
    near, far = (np.sqrt(r**2 + 0.2**2) for r in (0.3, 1.1))
    assert near <= cloud.distances[0] < near + 0.01
    assert far - 0.01 < cloud.distances[1] <= far + 1e-12
    np.testing.assert_allclose(cloud.lower, [-1.1, -1.1, 0.2], atol=0.02)
    np.testing.assert_allclose(cloud.upper, [1.1, 1.1, 0.2], atol=0.02)
    text = str(cloud)
    assert text.startswith("ring: 20000 positions, seed 1\n")
    assert f"{cloud.lower[0]:.4f} to {cloud.upper[0]:.4f}" in text
    assert f"no more than {ring.reach:.4f} m" in text


@pytest.mark.parametrize("step", [0.05, 0.3, 1.5])
def test_joint_steps(step):
    family = waypoint_sequences(CLOUD, step=step, count=6, seed=3)
    assert family.shape == (6, 8, 6)
    assert (PUMA.lower <= family).all()
    assert (family <= PUMA.upper).all()
    steps = np.abs(np.diff(family, axis=1))
    assert steps.max() <= step + 1e-12
    assert steps.max() > 0.9 * step
    for sequence in family:
        assert (sequence[0] == CLOUD.joints).all(axis=1).any()


@pytest.mark.parametrize("orientation", [False, True])
def test_end_steps(orientation):
    family = waypoint_sequences(
        CLOUD, step=0.3, count=2, waypoints=4, seed=3, kind=StepKind.END, orientation=orientation
    )
    ends = forward_kinematics(PUMA, family)[..., :3, 3]
    steps = np.linalg.norm(np.diff(ends, axis=1), axis=-1)
    assert (np.abs(steps - 0.3) <= 0.03 + 1e-8).all()
    assert (PUMA.lower <= family).all()
    assert (family <= PUMA.upper).all()
    for end in ends.reshape(-1, 3):
        assert np.linalg.norm(CLOUD.points - end, axis=1).min() < 1e-8


def test_a_longer_family_begins_with_the_shorter():
    kind = StepKind.END
    long = waypoint_sequences(CLOUD, step=0.2, count=3, waypoints=3, seed=9, kind=kind)
    short = waypoint_sequences(CLOUD, step=0.2, count=2, waypoints=3, seed=9, kind=kind)
    np.testing.assert_array_equal(long[:2], short)
    other = waypoint_sequences(CLOUD, step=0.2, count=2, waypoints=3, seed=10, kind=kind)
    assert not np.array_equal(other, short)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"count": 0}, "0 sequences of 8 way-points, step 0.1; give at least 1, at least 2"),
        ({"waypoints": 1}, "1 sequences of 1 way-points, step 0.1; give at least 1"),
        ({"step": 0.0}, "1 sequences of 8 way-points, step 0.0; give at least 1, at least"),
        ({"step": np.nan}, "step nan; give at least 1, at least 2, and a positive length"),
        ({"kind": "stride"}, "kind: 'stride' is unknown; use joint, end"),
        ({"kind": "end", "step": 9.0}, "step: none of the 4000 sampled positions is reached at 9"),
    ],
)
def test_faults(change, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        waypoint_sequences(CLOUD, **{"step": 0.1, "count": 1, "seed": 0, **change})


def test_an_empty_sample_is_refused():
    with pytest.raises(TrajgapError, match="count: 0 samples; give at least 1"):
        sample_workspace(PUMA, 0, 1)
