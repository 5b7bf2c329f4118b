"""The sampled workspace and families of way-points: bounds, seeds, step lengths."""

import re
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from trajgap.problem import fit, jtraj, parse_case, rest_to_rest, scaffold
from trajgap.problem.cases.data_files import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots import workspace
from trajgap.problem.robots.cartesian_line import CartesianLine, ctraj
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


def test_the_seed_decides_and_the_first_samples_depend_on_nothing_else(monkeypatch):
    for batch in (workspace._BATCH, 33):
        monkeypatch.setattr(workspace, "_BATCH", batch)
        again = sample_workspace(PUMA, 100, 7)
        np.testing.assert_array_equal(again.joints, CLOUD.joints[:100])
        np.testing.assert_array_equal(again.points, CLOUD.points[:100])
    assert not np.array_equal(sample_workspace(PUMA, 100, 8).joints, CLOUD.joints[:100])


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
    def family(count, seed):
        return waypoint_sequences(
            CLOUD, step=0.2, count=count, waypoints=3, seed=seed, kind=StepKind.END
        )

    np.testing.assert_array_equal(family(3, 9)[:2], family(2, 9))
    assert not np.array_equal(family(2, 10), family(2, 9))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"count": 0}, "0 sequences of 8 way-points, step 0.1; give at least 1 sequence"),
        ({"waypoints": 1}, "1 sequences of 1 way-points, step 0.1; give at least 1"),
        ({"step": 0.0}, "1 sequences of 8 way-points, step 0.0; give at least 1 sequence"),
        (
            {"step": np.nan},
            "step nan; give at least 1 sequence, at least 2 way-points, and a positive length",
        ),
        ({"kind": "stride"}, "kind: 'stride' is unknown; use joint, end"),
        ({"kind": "end", "step": 9.0}, "step: none of the 4000 sampled positions lies 9"),
    ],
)
def test_faults(change, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        waypoint_sequences(CLOUD, **{"step": 0.1, "count": 1, "seed": 0, **change})
    with pytest.raises(TrajgapError, match="count: 0 samples; give at least 1"):
        sample_workspace(PUMA, 0, 1)


START = np.array([0.1, -0.6, 0.4, 0.2, 0.5, 0.1])


def ends(shift=(0.02, 0.12, 0.06), turn=(0.1, -0.2, 0.15)):
    arm = load_robot("puma560")
    first = forward_kinematics(arm, START)
    last = first.copy()
    last[:3, 3] += shift
    last[:3, :3] = Rotation.from_rotvec(turn).as_matrix() @ first[:3, :3]
    return arm, first, last


@cache
def moved(points: int) -> CartesianLine:
    return ctraj(*ends(), points, guess=START)


def test_poses_lie_on_the_line_in_equal_steps_and_turn_about_one_axis() -> None:
    (arm, first, last), line = ends(), moved(7)
    np.testing.assert_allclose(line.waypoints[0], START, atol=1e-8)
    assert line.residual <= 1e-8
    reached = forward_kinematics(arm, line.waypoints)
    expected = first[:3, 3] + np.linspace(0, 1, 7)[:, None] * (last[:3, 3] - first[:3, 3])
    np.testing.assert_allclose(reached[:, :3, 3], expected, atol=1e-8)
    turns = [Rotation.from_matrix(reached[k, :3, :3] @ first[:3, :3].T) for k in range(7)]
    for k, turn in enumerate(turns):
        np.testing.assert_allclose(turn.as_rotvec(), k / 6 * np.array([0.1, -0.2, 0.15]), atol=1e-7)
    assert np.abs(np.diff(line.waypoints, axis=0)).max() < 0.5


@pytest.mark.parametrize("length", [0.0, 0.13, 2.0])
def test_a_deviation_is_the_distance_from_the_nearest_place_of_the_line(length) -> None:
    arm = load_robot("puma560")
    q = START + np.array([[0.0], [0.3]])
    poses = forward_kinematics(arm, np.stack([START, START]))
    poses[1, :3, 3] += length * np.array([-0.8, 0.0, 0.6])
    motion = fit(jtraj(1), q, [1.0])
    ends = forward_kinematics(arm, motion(np.linspace(0.0, 1.0, 51)))[:, None, :3, 3]
    line = np.linspace(poses[0, :3, 3], poses[1, :3, 3], 4001)
    furthest = np.linalg.norm(ends - line, axis=-1).min(axis=1).max()
    found = CartesianLine(arm, q, poses, 0.0).deviation(motion, 51)
    assert found == pytest.approx(furthest, abs=1e-6)


def test_a_table_of_its_way_points_keeps_every_bit(tmp_path) -> None:
    line = moved(5)
    (tmp_path / "line.csv").write_text(line.table)
    text = scaffold(tmp_path / "line.csv", {"position": "rad"}, family="cubic-spline")
    problem = parse_case(text, "line.toml").problem()
    np.testing.assert_array_equal(problem.waypoints, line.waypoints)
    assert problem.joints == line.chain.labels


def test_a_move_on_the_spot_turns_only() -> None:
    arm, first, last = ends(shift=(0.0, 0.0, 0.0))
    line = ctraj(arm, first, last, 5, guess=START)
    curve = rest_to_rest(4, 5)
    assert line.deviation(fit(curve, line.waypoints, np.full(4, 0.3))) < 5e-3


def test_what_cannot_be_done_is_said() -> None:
    arm, first, last = ends()
    with pytest.raises(TrajgapError, match="ctraj: 1 points make no line"):
        ctraj(arm, first, last, 1)
    with pytest.raises(TrajgapError, match="ctraj: last is not a pose"):
        ctraj(arm, first, last[:3])
    far = last.copy()
    far[:3, 3] += [0.0, 5.0, 0.0]
    with pytest.raises(TrajgapError, match=r"ctraj: pose 2 of 5 is not found \(nearest 0.4"):
        ctraj(arm, first, far, 5, guess=START)
    with pytest.raises(TrajgapError, match=r"ctraj: joint \d moves .* rad between poses 1 and 2"):
        ctraj(arm, first, last, 3, guess=START, largest_step=1e-3)
