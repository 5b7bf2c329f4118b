from .flags import limits_of_flags
from .limit_file import read_limits
from .moveit import read_moveit
from .precedence import StatedLimits, merge
from .urdf import read_urdf

__all__ = [
    "StatedLimits",
    "limits_of_flags",
    "merge",
    "read_limits",
    "read_moveit",
    "read_urdf",
]
