"""MoveIt's joint_limits.yaml, and that of ros2_control, which has the same fields."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import CaseError
from ..motions import BRAKING, number_of, read_yaml
from ..printed import spelt_like
from .precedence import Range, StatedLimits

_SIZES = ("velocity", "acceleration", BRAKING, "jerk")
"""Quantities with ``has_X_limits`` and ``max_X``; the smallest value is minus the largest."""
_READ = (
    *(key for one in _SIZES for key in (f"has_{one}_limits", f"max_{one}")),
    *("has_position_limits", "min_position", "max_position"),
)
"""Keys that state limits."""
_OTHERS = (
    *("has_effort_limits", "max_effort", "angle_wraparound", "has_soft_limits"),
    *("k_position", "k_velocity", "soft_lower_limit", "soft_upper_limit"),
)
"""Keys of ros2_control that state no limit of a motion; they are left aside."""


def read_moveit(path: Path) -> StatedLimits:
    """Read limits from MoveIt's joint_limits.yaml.

    Parameters
    ----------
    path : Path
        Under ``joint_limits``, for each joint: ``has_velocity_limits`` and ``max_velocity``, the
        same of acceleration, deceleration of either sign and jerk, and ``has_position_limits`` with
        ``min_position`` and ``max_position``; rad, or m. A ``has_...`` that is false says that
        there is no limit; a missing one follows from the other keys. The default
        scaling factors of planners are not limits and are left aside.
    """
    name = str(path)
    documents = read_yaml(path)
    if len(documents) > 1:
        raise CaseError(name, "", f"contains {len(documents)} documents; keep one")
    found = documents[0] if documents else None
    # As a file of ROS parameters it is wrapped: node, ros__parameters, robot_description_planning.
    for _ in range(4):
        if isinstance(found, Mapping) and "joint_limits" not in found and len(found) == 1:
            found = next(iter(found.values()))
    if not isinstance(found, Mapping) or not isinstance(found.get("joint_limits"), Mapping):
        raise CaseError(name, "joint_limits", "is missing; give MoveIt's joint_limits.yaml")
    ranges: dict[str, dict[str, Range]] = {}
    for joint, block in found["joint_limits"].items():
        if not isinstance(joint, str) or not isinstance(block, Mapping):
            raise CaseError(name, f"joint_limits.{joint}", "is not a block of limits; see MoveIt")
        ranges[joint] = _ranges(name, f"joint_limits.{joint}", block)
    if not ranges:
        raise CaseError(name, "joint_limits", "contains no joint; name the joints of the arm")
    return StatedLimits(name, ranges)


def _ranges(name: str, field: str, block: Mapping[Any, Any]) -> dict[str, Range]:
    ranges: dict[str, Range] = {}
    for key in block:
        near = None if key in (*_READ, *_OTHERS) else spelt_like(str(key), _READ)
        if near:
            raise CaseError(name, f"{field}.{str(key)[:40]}", f"did you mean {near!r}?")
    for quantity in (*_SIZES, "position"):
        sides = ("min_position", "max_position") if quantity == "position" else (f"max_{quantity}",)
        ends = {key: _number(name, field, block, key) for key in sides}
        has = f"has_{quantity}_limits"
        stated = block.get(has, None not in ends.values())
        if not isinstance(stated, bool):
            why = f"{str(stated)[:40]!r} is neither true nor false"
            raise CaseError(name, f"{field}.{has}", why)
        if not stated and has in block:
            ranges[quantity] = (-math.inf, math.inf)
        if not stated:
            continue
        found = []
        for key, end in ends.items():
            if end is None:
                raise CaseError(name, f"{field}.{key}", f"is missing; {has} is true")
            if quantity == BRAKING:
                end = abs(end)  # Pilz's planner wants it negative
            if quantity != "position" and end < 0:
                raise CaseError(name, f"{field}.{key}", "is negative; give a size")
            found.append(end)
        ranges[quantity] = (found[0] if quantity == "position" else -found[0], found[-1])
    return ranges


def _number(name: str, field: str, block: Mapping[Any, Any], key: str) -> float | None:
    value = block.get(key)
    # Numbers that are not finite are refused with the range, unless they say that there is none.
    return None if value is None else number_of(value, name, f"{field}.{key}", finite=False)
