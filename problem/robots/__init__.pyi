from .cartesian_line import CartesianLine as CartesianLine, ctraj as ctraj
from .chain import (
    Chain as Chain,
    Convention as Convention,
    JointKind as JointKind,
    forward_kinematics as forward_kinematics,
    geometric_jacobian as geometric_jacobian,
    link_frames as link_frames,
)
from .closed_form import closed_form_inverse as closed_form_inverse
from .dh import DhTable as DhTable
from .inverse import (
    IkSolution as IkSolution,
    IkStatus as IkStatus,
    inverse_kinematics as inverse_kinematics,
)
from .nearness import Proximity as Proximity, proximity as proximity
from .printed_equations import (
    Equation as Equation,
    EquationCheck as EquationCheck,
    check_equation as check_equation,
)
from .workspace import (
    StepKind as StepKind,
    Workspace as Workspace,
    sample_workspace as sample_workspace,
    waypoint_sequences as waypoint_sequences,
)
