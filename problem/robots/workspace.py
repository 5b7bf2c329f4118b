"""The Monte-Carlo workspace of a chain, and sequences of way-points drawn from it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ..arrays import Array
from ..errors import TrajgapError
from .chain import Chain, forward_kinematics
from .inverse import POSE, POSITION, inverse_kinematics

_BATCH = 50_000
"""Configurations evaluated at once, to bound the memory."""


class StepKind(StrEnum):
    """What the step length of a sequence measures."""

    JOINT = "joint"
    """Largest change of any joint, rad; every joint is drawn uniformly within it."""
    END = "end"
    """Distance of successive positions of the end, m, within a tenth of it."""


@dataclass(frozen=True, eq=False)
class Workspace:
    """Seeded sample of the positions of a chain's end."""

    chain: Chain
    seed: int
    joints: Array
    """Shape (samples, joints). Uniform within `Chain.span`, rad (m where a joint slides)."""
    points: Array
    """Shape (samples, 3). Positions of the end in the base, m."""

    @property
    def lower(self) -> Array:
        """Lower corner of the sample's bounding box, m."""
        return np.asarray(self.points.min(axis=0))

    @property
    def upper(self) -> Array:
        """Upper corner of the sample's bounding box, m."""
        return np.asarray(self.points.max(axis=0))

    @property
    def distances(self) -> tuple[float, float]:
        """Smallest and largest distance of a sampled position from the base's origin, m."""
        far = np.linalg.norm(self.points, axis=1)
        return float(far.min()), float(far.max())

    def __str__(self) -> str:
        near, far = self.distances
        box = ", ".join(
            f"{axis} {low:.4f} to {high:.4f}"
            for axis, low, high in zip("xyz", self.lower, self.upper, strict=True)
        )
        return (
            f"{self.chain.name or 'chain'}: {len(self.points)} positions, seed {self.seed}\n"
            f"bounding box    {box} m\n"
            f"from the base   {near:.4f} to {far:.4f} m (no more than {self.chain.reach:.4f} m)"
        )


def sample_workspace(chain: Chain, count: int, seed: int) -> Workspace:
    """Sample the positions that the end of a chain can take.

    Joint values are uniform, so positions are not: they concentrate where the arm is folded.

    Parameters
    ----------
    seed : int
        Seed of a PCG64 generator; the first samples do not depend on ``count``.

    Raises
    ------
    TrajgapError
        If the count is not positive or a joint slides without bounds.
    """
    if count < 1:
        raise TrajgapError(f"count: {count} samples; give at least 1")
    lower, upper = chain.span()
    joints = np.random.default_rng(seed).uniform(lower, upper, (count, chain.joints))
    parts = [joints[at : at + _BATCH] for at in range(0, count, _BATCH)]
    points = np.concatenate([forward_kinematics(chain, part)[:, :3, 3] for part in parts])
    return Workspace(chain, seed, joints, points)


def waypoint_sequences(
    workspace: Workspace,
    *,
    step: float,
    count: int,
    seed: int,
    waypoints: int = 8,
    kind: StepKind = StepKind.JOINT,
    orientation: bool = False,
) -> Array:
    """Draw sequences of way-points from a workspace at one step length.

    Every sequence begins at a sampled configuration. With `StepKind.JOINT` each joint of the next
    way-point is uniform within ``step`` of the last one and within its bounds. With
    `StepKind.END` the next position is a sampled one about ``step`` away, and the joints are the
    solution of inverse kinematics nearest to the last ones, as in the pipeline workspace,
    way-points, inverse kinematics of z1-woa-bspline.

    Parameters
    ----------
    step : float
        rad or m, see `StepKind`.
    count : int
        Number of sequences; the first ones do not depend on it.
    waypoints : int
        Way-points of each sequence, at least 2.
    orientation : bool
        With `StepKind.END`, take the sampled orientation too. Without it the orientation is left
        free, and a joint that does not move the end's position keeps its value.

    Returns
    -------
    ndarray, shape (count, waypoints, joints)
        Joint variables, rad (m where a joint slides).

    Raises
    ------
    TrajgapError
        If a number is out of range, or no sampled position can be reached at that step.
    """
    if not (count >= 1 and waypoints >= 2 and 0 < step < np.inf):
        raise TrajgapError(
            f"{count} sequences of {waypoints} way-points, step {step}; "
            "give at least 1 sequence, at least 2 way-points, and a positive length"
        )
    try:
        kind = StepKind(kind)
    except ValueError:
        raise TrajgapError(f"kind: {kind!r} is unknown; use {', '.join(StepKind)}") from None
    sequences = np.empty((count, waypoints, workspace.chain.joints))
    for sequence, child in zip(sequences, np.random.SeedSequence(seed).spawn(count), strict=True):
        rng = np.random.default_rng(child)
        sequence[0] = workspace.joints[rng.integers(len(workspace.joints))]
        for k in range(1, waypoints):
            if kind is StepKind.JOINT:
                low = np.maximum(workspace.chain.lower, sequence[k - 1] - step)
                high = np.minimum(workspace.chain.upper, sequence[k - 1] + step)
                sequence[k] = rng.uniform(low, high)
            else:
                sequence[k] = _stepped(workspace, sequence[k - 1], step, rng, orientation)
    return sequences


def _stepped(
    workspace: Workspace, last: Array, step: float, rng: np.random.Generator, orientation: bool
) -> Array:
    chain = workspace.chain
    here = forward_kinematics(chain, last)[:3, 3]
    far = np.linalg.norm(workspace.points - here, axis=1)
    # The next position lies in a shell of a tenth of the step to both sides; after 20 positions a
    # step is given up as out of reach.
    near = np.flatnonzero(np.abs(far - step) <= 0.1 * step)
    for chosen in rng.permutation(near)[:20]:
        found = inverse_kinematics(
            chain,
            forward_kinematics(chain, workspace.joints[chosen]),
            rng,
            components=POSE if orientation else POSITION,
            guess=last,
            starts=8,
        )
        if found.solved:
            return found.joints
    raise TrajgapError(
        f"step: none of the {len(workspace.points)} sampled positions lies {step:g} m from a "
        "way-point; take more samples or another step"
    )
