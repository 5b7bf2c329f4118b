"""A file of limits, in whichever format its name ends with."""

from __future__ import annotations

from pathlib import Path

from .moveit import read_moveit
from .precedence import StatedLimits
from .urdf import read_urdf


def read_limits(path: Path) -> StatedLimits:
    """Read a URDF (``.urdf``, ``.xml``), or MoveIt's joint_limits.yaml."""
    return (read_urdf if path.suffix.lower() in (".urdf", ".xml") else read_moveit)(path)
