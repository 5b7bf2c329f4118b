from .flags import limits_of_flags
from .moveit import read_moveit
from .precedence import StatedLimits, merge, read_limits
from .urdf import read_urdf

__all__ = [
    "StatedLimits",
    "limits_of_flags",
    "merge",
    "read_limits",
    "read_moveit",
    "read_urdf",
]
