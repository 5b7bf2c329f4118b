"""Straight-line moves of a robot's end, turned into joint way-points by inverse kinematics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..curves import Trajectory
from ..errors import TrajgapError
from .chain import Chain, forward_kinematics
from .inverse import inverse_kinematics


@dataclass(frozen=True, eq=False)
class CartesianLine:
    """Joint way-points whose poses lie on a straight line."""

    chain: Chain
    waypoints: Array
    """Shape (points, joints); rad (m where a joint slides); between them a curve leaves the line,
    see `deviation`."""
    poses: Array
    """Shape (points, 4, 4)."""
    residual: float
    """Largest distance of forward kinematics from a pose, m and rad."""

    @property
    def table(self) -> str:
        """The way-points as a table for `scaffold`, without loss of any bit."""
        lines = [",".join(("waypoint", *self.chain.labels))]
        for k, row in enumerate(self.waypoints, 1):
            lines.append(",".join((str(k), *(repr(float(q)) for q in row))))
        return "\n".join(lines) + "\n"

    def deviation(self, trajectory: Trajectory, samples: int = 1001) -> float:
        """Largest distance of the end from the line on a joint trajectory, m.

        Sampled, not proved: it shows how many points the line needs and is not a verdict.
        """
        t = np.linspace(0.0, trajectory.breaks[-1], samples)
        ends = forward_kinematics(self.chain, trajectory(t))[:, :3, 3]
        start = self.poses[0, :3, 3]
        along = self.poses[-1, :3, 3] - start
        length = float(np.linalg.norm(along))
        offset = ends - start
        if length > 0.0:
            along = along / length
            place = np.clip(offset @ along, 0.0, length)
            offset = offset - place[:, None] * along
        return float(np.linalg.norm(offset, axis=1).max())


def ctraj(
    chain: Chain,
    first: ArrayLike,
    last: ArrayLike,
    points: int = 9,
    *,
    guess: ArrayLike | None = None,
    seed: int = 0,
    largest_step: float = np.pi / 2,
) -> CartesianLine:
    """Joint way-points of a straight move between two poses, as the toolboxes' ``ctraj`` makes it.

    Position moves on a line, orientation about one fixed axis, in equal steps; each pose is
    solved from the joints of the one before, so the branch of the inverse stays the same.
    The durations determine when the way-points are passed.

    Parameters
    ----------
    first, last : array_like, shape (4, 4)
        Poses of the end in the base, m.
    points : int
        Number of poses, both ends included; with eight steps a joint curve stays near the line.
    guess : array_like, shape (joints,), optional
        Joints near those of the first pose; chooses the branch.
    seed : int
        Seed of the inverse kinematics' starts.
    largest_step : float
        Joint motion between neighbours above which the branch is taken to have changed, rad.

    Raises
    ------
    TrajgapError
        If a pose is not reached, or a joint moves farther than ``largest_step`` between two.

    Examples
    --------
    >>> from trajgap.problem import load_robot, rest_to_rest, fit
    >>> arm = load_robot("puma560")
    >>> first = forward_kinematics(arm, [0.1, -0.6, 0.4, 0.2, 0.5, 0.1])
    >>> last = first.copy()
    >>> last[:3, 3] += [0.0, 0.1, 0.05]
    >>> line = ctraj(arm, first, last, guess=[0.1, -0.6, 0.4, 0.2, 0.5, 0.1])
    >>> line.waypoints.shape
    (9, 6)
    """
    if points < 2:
        raise TrajgapError(f"ctraj: {points} points make no line; give 2 or more")
    poses = _poses(first, last, points)
    rng = np.random.default_rng(seed)
    rows: list[Array] = []
    missed = 0.0
    near = guess
    for k, pose in enumerate(poses):
        found = inverse_kinematics(chain, pose, rng, guess=near)
        if not found.solved:
            raise TrajgapError(
                f"ctraj: pose {k + 1} of {points} is {found.status} (nearest "
                f"{found.position_error:.3g} m, {found.angle_error:.3g} rad away); "
                "move the line into the workspace"
            )
        if rows:
            moved = np.abs(found.joints - rows[-1])
            if moved.max() > largest_step:
                j = int(np.argmax(moved))
                raise TrajgapError(
                    f"ctraj: joint {chain.labels[j]} moves {moved[j]:.3g} rad between poses {k} "
                    f"and {k + 1}; the line crosses a singularity, or needs more points"
                )
        rows.append(found.joints)
        missed = max(missed, found.position_error, found.angle_error)
        near = found.joints
    waypoints = np.array(rows)
    waypoints.setflags(write=False)
    return CartesianLine(chain, waypoints, poses, missed)


def _poses(first: ArrayLike, last: ArrayLike, points: int) -> Array:
    ends = [np.asarray(pose, dtype=np.float64) for pose in (first, last)]
    for name, pose in zip(("first", "last"), ends, strict=True):
        if pose.shape != (4, 4) or not np.isfinite(pose).all():
            raise TrajgapError(f"ctraj: {name} is not a pose; give a finite 4 by 4 transform")
    share = np.linspace(0.0, 1.0, points)
    poses = np.tile(np.eye(4), (points, 1, 1))
    a, b = (pose[:3, 3] for pose in ends)
    poses[:, :3, 3] = a + share[:, None] * (b - a)
    from scipy.spatial.transform import Rotation, Slerp  # a quarter of a second, and few need it

    turn = Slerp([0.0, 1.0], Rotation.from_matrix([pose[:3, :3] for pose in ends]))
    poses[:, :3, :3] = turn(share).as_matrix()
    return poses
