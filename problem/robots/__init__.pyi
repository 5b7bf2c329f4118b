from .cartesian_line import CartesianLine, ctraj
from .chain import (
    Chain,
    Convention,
    JointKind,
    forward_kinematics,
    geometric_jacobian,
    link_frames,
)
from .dh import DhTable
from .inverse import IkSolution, IkStatus, inverse_kinematics
from .nearness import Proximity, proximity
from .workspace import StepKind, Workspace, sample_workspace, waypoint_sequences

__all__ = [
    "CartesianLine",
    "Chain",
    "Convention",
    "DhTable",
    "IkSolution",
    "IkStatus",
    "JointKind",
    "Proximity",
    "StepKind",
    "Workspace",
    "ctraj",
    "forward_kinematics",
    "geometric_jacobian",
    "inverse_kinematics",
    "link_frames",
    "proximity",
    "sample_workspace",
    "waypoint_sequences",
]
