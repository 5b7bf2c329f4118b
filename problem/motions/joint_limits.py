"""Limits of joints as robots have them: two sides, some absent, braking apart from speeding up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import TrajgapError
from ..limits import QUANTITIES, Limits

ORDERS = ("position", *QUANTITIES)
"""Words for derivatives 0 to 3."""
BRAKING = "deceleration"
"""Acceleration while the speed falls, where it has a limit of its own."""
GIVEN = "given"
"""Said as the source of a limit that came as a number and not from a file."""


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Ranges of position, velocity, acceleration and jerk of every joint.

    Attributes
    ----------
    joints : tuple of str
    lower, upper : ndarray, shape (joints, 4)
        Range of derivative 0 to 3, rad, s; infinite where there is none.
    deceleration : ndarray, shape (joints,)
        Largest |acceleration| while the joint's speed falls, rad/s²; where it is given,
        ``acceleration`` holds while the speed grows. inf where it is not.
    sources : mapping
        (joint, quantity) to where the limit is stated.

    Raises
    ------
    TrajgapError
        If a limit is NaN, a range is empty, or a range of a derivative leaves out 0.
    """

    joints: tuple[str, ...]
    lower: Array
    upper: Array
    deceleration: Array
    sources: Mapping[tuple[str, str], str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for j, joint in enumerate(self.joints):
            for r, quantity in enumerate(ORDERS):
                check_range(self.lower[j, r], self.upper[j, r], quantity, joint)
            if not self.deceleration[j] >= 0:
                raise TrajgapError(f"deceleration of joint {joint}: give 0 or more")

    @classmethod
    def of(cls, limits: Limits, joints: Sequence[str]) -> JointLimits:
        """The limits of a `Problem` for these joints."""
        below, above = limits.sides
        lower = np.column_stack([limits.position_lower, -below])
        upper = np.column_stack([limits.position_upper, above])
        free = np.full(len(joints), np.inf)
        return cls(tuple(joints), lower, upper, free)

    @classmethod
    def from_values(
        cls,
        joints: Sequence[str],
        velocity: ArrayLike = np.inf,
        acceleration: ArrayLike = np.inf,
        jerk: ArrayLike = np.inf,
        position: tuple[ArrayLike, ArrayLike] = (-np.inf, np.inf),
        deceleration: ArrayLike = np.inf,
    ) -> JointLimits:
        """Symmetric limits, one value or one per joint, rad and s."""
        count = len(joints)

        def each(values: ArrayLike) -> Array:
            return np.array(np.broadcast_to(np.asarray(values, dtype=np.float64), (count,)))

        sizes = [each(v) for v in (velocity, acceleration, jerk)]
        lower = np.column_stack([each(position[0]), *(-s for s in sizes)])
        upper = np.column_stack([each(position[1]), *sizes])
        return cls(tuple(joints), lower, upper, each(deceleration))

    @property
    def symmetric(self) -> Limits:
        """Limits of the same size to both sides that imply these: for `Problem` and `solve`.

        The smaller side counts, and of acceleration and deceleration the smaller one.
        """
        sizes = np.minimum(-self.lower[:, 1:], self.upper[:, 1:])
        sizes[:, 1] = np.minimum(sizes[:, 1], self.deceleration)
        return Limits(
            np.abs(sizes[:, 0]),
            np.abs(sizes[:, 1]),
            np.abs(sizes[:, 2]),
            position_lower=self.lower[:, 0],
            position_upper=self.upper[:, 0],
        )

    @property
    def two_sided(self) -> Limits:
        """The same limits for `Problem` and `solve`, each side of its own size.

        A deceleration has no place there: where it is given, the smallest of it and of both sides
        of the acceleration counts on both.
        """
        sides = np.stack([-self.lower[:, 1:], self.upper[:, 1:]])
        braking = np.isfinite(self.deceleration)
        least = np.minimum(sides[:, :, 1].min(axis=0), self.deceleration)
        sides[:, braking, 1] = least[braking]
        free = Limits(joints=len(self.joints)).with_positions(self.lower[:, 0], self.upper[:, 0])
        return free.with_sides(np.abs(sides))

    def source(self, joint: str, quantity: str) -> str:
        """Where a limit is stated, in words."""
        return self.sources.get((joint, quantity), GIVEN)


def check_range(low: float, high: float, quantity: str, joint: str) -> None:
    """Refuse a range that no motion can keep.

    Raises
    ------
    TrajgapError
    """
    name = f"{quantity} of joint {joint}"
    if np.isnan(low) or np.isnan(high):
        raise TrajgapError(f"{name}: is NaN; leave it out where there is no limit")
    if low > high:
        raise TrajgapError(f"{name}: the lower limit {low:g} lies above the upper one {high:g}")
    if quantity != "position" and not low <= 0.0 <= high:
        raise TrajgapError(f"{name}: {low:g} to {high:g} leaves out 0; a range includes standing")
    if low == np.inf or high == -np.inf:
        raise TrajgapError(f"{name}: leaves nothing; leave it out where there is no limit")
