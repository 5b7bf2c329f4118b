from .as_timed_by_toppra import retimed_motion
from .toppra_check import Retiming, retime, retime_joints

__all__ = ["Retiming", "retime", "retime_joints", "retimed_motion"]
