"""Limits as one source states them, and what holds where several do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import CaseError, TrajgapError
from ..motions import BRAKING, ORDERS, JointLimits, check_range
from ..printed import is_linear, spelling_hint, spelt_like

Range = tuple[float, float]
"""Lower and upper limit, rad and s; infinite if that side has none."""


@dataclass(frozen=True)
class StatedLimits:
    """The limits that one source states: ranges by joint and quantity."""

    source: str
    """The file or flag, for every verdict."""
    ranges: Mapping[str, Mapping[str, Range]]
    """Joint to quantity to (lower, upper), rad and s."""
    named: bool = True
    """Whether the joints are named by the source itself, so an unknown name is a fault."""
    slides: Mapping[str, bool] = field(default_factory=dict)
    """Whether a joint slides instead of turning, where the source says so."""

    def __post_init__(self) -> None:
        for joint, quantities in self.ranges.items():
            for quantity, (low, high) in quantities.items():
                try:
                    check_range(low, high, quantity, joint)
                except TrajgapError as error:
                    raise CaseError(self.source, joint, str(error)) from None

    def for_joints(self, joints: Sequence[str]) -> JointLimits:
        """Limits of some joints, in their order.

        Raises
        ------
        CaseError
            If one of them is unknown.
        """
        return merge(joints, [self])

    def units_of(self, joints: Sequence[str], units: Sequence[str]) -> tuple[str, ...]:
        """Units that suit how joints move; rad and m, the same number, stand for each other.

        Raises
        ------
        CaseError
            If a joint that slides has another angle as its unit, or one that turns a length.
        """
        slides = [self.slides.get(x, is_linear(u)) for x, u in zip(joints, units, strict=True)]
        suited = tuple(
            unit if is_linear(unit) == slide else ("rad", "m")[slide]
            for unit, slide in zip(units, slides, strict=True)
        )
        for joint, unit, suits, slide in zip(joints, units, suited, slides, strict=True):
            if unit not in ("rad", "m", suits):
                raise CaseError(
                    self.source,
                    joint,
                    f"{('turns', 'slides')[slide]}, but its unit is {unit}; give one unit for "
                    f"each joint, such as {','.join(suited)}",
                )
        return suited


def merge(joints: Sequence[str], sources: Sequence[StatedLimits]) -> JointLimits:
    """The limits of joints; if several sources state the same limit, the first one applies.

    Parameters
    ----------
    sources : sequence of StatedLimits
        In order of precedence.

    Raises
    ------
    CaseError
        If no file contains a joint, or a file has a joint with nearly the same name; or if a file
        contains none of the joints.
    """
    _check_names(joints, sources)
    count = len(joints)
    lower, upper = np.full((count, 4), -np.inf), np.full((count, 4), np.inf)
    braking = np.full(count, np.inf)
    said: dict[tuple[str, str], str] = {}
    for one in sources:
        for j, joint in enumerate(joints):
            stated = one.ranges.get(joint, {})
            # Acceleration alone is meant of braking too, whatever a later source says of that.
            both = (joint, "acceleration") in said
            for quantity, (low, high) in stated.items():
                if (joint, quantity) in said or (quantity == BRAKING and both):
                    continue
                said[joint, quantity] = one.source
                if quantity == BRAKING:
                    braking[j] = high
                else:
                    r = ORDERS.index(quantity)
                    lower[j, r], upper[j, r] = low, high
    for j, joint in enumerate(joints):
        if np.isfinite(braking[j]) and lower[j, 2] != -upper[j, 2]:
            raise CaseError(
                said[joint, BRAKING],
                BRAKING,
                f"joint {joint} also has two-sided acceleration limits; state one of the two",
            )
    return JointLimits(tuple(joints), lower, upper, braking, said)


def _check_names(joints: Sequence[str], sources: Sequence[StatedLimits]) -> None:
    """Refuse joints whose limits nobody states under their name: they would be free, unnoticed."""
    files = [one for one in sources if one.named]
    for one in files:
        others = [name for name in one.ranges if name not in joints]
        unknown = [joint for joint in joints if joint not in one.ranges]
        said = "is not a joint with limits there; rename it or add it;"
        faults = [
            (joint, f"{said} {spelling_hint(joint, others or one.ranges)}")
            for joint in unknown
            if len(unknown) == len(joints)
            or spelt_like(joint, others)
            or not any(joint in file.ranges for file in files)
        ]
        if faults:
            raise CaseError(one.source, *faults[0], faults[1:])
