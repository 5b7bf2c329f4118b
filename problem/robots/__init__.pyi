from .cartesian_line import CartesianLine, ctraj
from .chain import (
    Chain,
    Convention,
    JointKind,
    forward_kinematics,
    geometric_jacobian,
    link_frames,
)
from .closed_form import closed_form_inverse
from .dh import DhTable
from .inverse import IkSolution, IkStatus, inverse_kinematics
from .nearness import Proximity, proximity
from .printed_equations import Equation, EquationCheck, check_equation
from .workspace import StepKind, Workspace, sample_workspace, waypoint_sequences

__all__ = [
    "CartesianLine",
    "Chain",
    "Convention",
    "DhTable",
    "Equation",
    "EquationCheck",
    "IkSolution",
    "IkStatus",
    "JointKind",
    "Proximity",
    "StepKind",
    "Workspace",
    "check_equation",
    "closed_form_inverse",
    "ctraj",
    "forward_kinematics",
    "geometric_jacobian",
    "inverse_kinematics",
    "link_frames",
    "proximity",
    "sample_workspace",
    "waypoint_sequences",
]
