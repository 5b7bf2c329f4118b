from .toppra_check import Retiming, retime, retime_joints

__all__ = ["Retiming", "retime", "retime_joints"]
