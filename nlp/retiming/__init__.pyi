from .as_timed_by_toppra import retimed_motion
from .third_order import jerk_limited_path, retime_third_order
from .toppra_check import Retiming, retime, retime_joints

__all__ = [
    "Retiming",
    "jerk_limited_path",
    "retime",
    "retime_joints",
    "retime_third_order",
    "retimed_motion",
]
