from .flags import limits_of_flags as limits_of_flags
from .moveit import read_moveit as read_moveit
from .precedence import StatedLimits as StatedLimits, merge as merge
from .urdf import read_limits as read_limits, read_urdf as read_urdf
