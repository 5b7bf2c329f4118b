"""Limits of joints as robots have them: two sides, some absent, braking apart from speeding up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array
from ..characters import listed
from ..errors import TrajgapError
from ..limits import BRAKING as BRAKING, ORDERS as ORDERS, Limits
from .motion import LARGEST

GIVEN = "given"
"""Said as the source of a limit that came as a number and not from a file."""


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Ranges of position, velocity, acceleration and jerk of every joint.

    Raises
    ------
    TrajgapError
        If a limit is NaN or out of range, a range is empty, or a range of a derivative leaves out
        0.
    """

    joints: tuple[str, ...]
    lower: Array
    upper: Array
    """Shape (joints, 4). Range of derivative 0 to 3, rad, s; infinite if there is none."""
    deceleration: Array
    """Shape (joints,). Largest |acceleration| while the joint's speed falls, rad/s²; if it is
    given, the acceleration limit applies only while the speed grows. inf if it is not given."""
    sources: Mapping[tuple[str, str], str] = field(default_factory=dict)
    """(joint, quantity) to the source of the limit, or of the statement that there is none."""

    def __post_init__(self) -> None:
        for j, joint in enumerate(self.joints):
            for r, quantity in enumerate(ORDERS):
                check_range(self.lower[j, r], self.upper[j, r], quantity, joint)
            if not self.deceleration[j] >= 0:
                raise TrajgapError(f"deceleration of joint {joint}: give 0 or more")
            check_range(-self.deceleration[j], self.deceleration[j], BRAKING, joint)

    @classmethod
    def of(cls, limits: Limits, joints: Sequence[str]) -> JointLimits:
        """The limits of a `Problem` for these joints: it states all of them, inf for none."""
        if limits.quantities[-1] != ORDERS[-1]:
            raise TrajgapError(
                "limits.snap: motions from elsewhere are not judged by it; leave it out"
            )
        ends = [limits.ends(quantity) for quantity in limits.quantities]
        lower = np.column_stack([limits.position_lower, *(low for low, _ in ends)])
        upper = np.column_stack([limits.position_upper, *(high for _, high in ends)])
        said = {(joint, quantity): GIVEN for joint in joints for quantity in ORDERS}
        return cls(tuple(joints), lower, upper, limits.deceleration, said)

    @classmethod
    def from_values(
        cls,
        joints: Sequence[str],
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        jerk: ArrayLike | None = None,
        position: tuple[ArrayLike, ArrayLike] | None = None,
        deceleration: ArrayLike | None = None,
    ) -> JointLimits:
        """Symmetric limits, one value or one per joint, rad and s.

        None means that nothing is stated, so nothing is judged; inf states that there is no limit.
        """
        count = len(joints)

        def each(values: ArrayLike | None) -> Array:
            given = np.asarray(np.inf if values is None else values, dtype=np.float64)
            return np.array(np.broadcast_to(given, (count,)))

        sizes = [each(v) for v in (velocity, acceleration, jerk)]
        low, high = (-np.inf, np.inf) if position is None else position
        lower = np.column_stack([each(low), *(-s for s in sizes)])
        upper = np.column_stack([each(high), *sizes])
        given = zip(ORDERS, (position, velocity, acceleration, jerk), strict=True)
        stated = [quantity for quantity, values in given if values is not None]
        said = {(joint, quantity): GIVEN for joint in joints for quantity in stated}
        return cls(tuple(joints), lower, upper, each(deceleration), said)

    @property
    def unstated(self) -> tuple[tuple[str, str], ...]:
        """Joint and quantity wherever neither a limit nor its absence is stated."""
        free = np.isinf(self.lower) & np.isinf(self.upper)
        return tuple(
            (joint, quantity)
            for j, joint in enumerate(self.joints)
            for r, quantity in enumerate(ORDERS)
            if free[j, r] and (joint, quantity) not in self.sources
        )

    @property
    def symmetric(self) -> Limits:
        """`two_sided` with the smaller size on both sides, which implies these limits."""
        return self.two_sided.narrow

    @property
    def two_sided(self) -> Limits:
        """The same limits for `Problem` and `solve`, each side of its own size.

        A deceleration that goes with no single size of acceleration is none of its own there: the
        smallest of it and both sides of the acceleration is used on both sides.

        Raises
        ------
        TrajgapError
            If a quantity has limits, and one of the joints states none; it would be free unnoticed.
        """
        unstated = self.unstated
        for joint, quantity in unstated:
            lacking = sum(quantity == other for _, other in unstated)
            if quantity != ORDERS[0] and lacking < len(self.joints):
                raise TrajgapError(
                    f"{quantity} of joint {joint}: no limit is stated, but other joints have one; "
                    "state it, or inf for none"
                )
        sides = np.stack([-self.lower[:, 1:], self.upper[:, 1:]])
        least = np.minimum(sides[:, :, 1].min(axis=0), self.deceleration)
        sides[:, self.joined_braking, 1] = least[self.joined_braking]
        free = Limits(joints=len(self.joints)).with_positions(self.lower[:, 0], self.upper[:, 0])
        apart = np.where(self.joined_braking, np.inf, self.deceleration)
        return free.with_sides(np.abs(sides)).with_deceleration(apart)

    @property
    def joined_braking(self) -> NDArray[np.bool_]:
        """Joints whose deceleration `two_sided` joins with the acceleration."""
        low, high = self.lower[:, 2], self.upper[:, 2]
        one_size = np.isfinite(high) & (-low == high) & (self.deceleration > 0)
        return np.asarray(np.isfinite(self.deceleration) & ~one_size)

    def source(self, joint: str, quantity: str) -> str:
        """Where a limit is stated, in words."""
        return self.sources.get((joint, quantity), GIVEN)


def unstated_words(unstated: Sequence[tuple[str, str]], joints: Sequence[str]) -> str:
    """What is not judged: whole joints, whole quantities, the rest; empty if all is judged."""
    lacks = {one: [q for q in ORDERS if (one, q) in set(unstated)] for one in joints}
    free = [one for one in joints if len(lacks[one]) == len(ORDERS)]
    others = [one for one in joints if one not in free]
    by_joints: dict[tuple[str, ...], list[str]] = {}
    for quantity in ORDERS:
        of = tuple(one for one in others if quantity in lacks[one])
        if of:
            by_joints.setdefault(of, []).append(quantity)
    parts = [_joints_in_words(free)] if free else []
    for of, quantities in sorted(by_joints.items(), key=lambda one: len(one[0]), reverse=True):
        whole = "" if len(of) == len(others) else f" of {_joints_in_words(of)}"
        parts.append(listed(quantities) + whole)
    return f"{'; '.join(parts)}, no limit stated" if parts else ""


def _joints_in_words(names: Sequence[str]) -> str:
    return f"joint{'s' * (len(names) > 1)} {listed(names)}"


def check_range(low: float, high: float, quantity: str, joint: str) -> None:
    """Refuse a range that no motion can keep."""
    name = f"{quantity} of joint {joint}"
    if np.isnan(low) or np.isnan(high):
        raise TrajgapError(f"{name}: is NaN; leave it out if there is no limit")
    if quantity != "position" and low == -high > 0:
        raise TrajgapError(f"{name}: is negative; give a size")
    if low > high:
        raise TrajgapError(f"{name}: the lower limit {low:g} lies above the upper one {high:g}")
    if quantity != "position" and not low <= 0.0 <= high:
        raise TrajgapError(
            f"{name}: {low:g} to {high:g} excludes 0; a range must include standstill"
        )
    if any(np.isfinite(end) and abs(end) > LARGEST for end in (low, high)):
        raise TrajgapError(f"{name}: is beyond {LARGEST:g}; write inf for no limit")
    if any(0 < abs(end) < 1 / LARGEST for end in (low, high)):
        raise TrajgapError(f"{name}: is below {1 / LARGEST:g}; write 0 if nothing may move")
    if low == np.inf or high == -np.inf:
        raise TrajgapError(f"{name}: leaves nothing; leave it out if there is no limit")
