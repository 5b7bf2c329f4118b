"""The question: limits, interpolants, trajectories, exact peaks, the checker, and case files."""

from .cartesian_line import CartesianLine, ctraj
from .case import Case, DurationBox
from .check import (
    Check,
    Evaluation,
    Jump,
    Peak,
    Verdict,
    check,
    evaluate,
    reachable_total,
)
from .clamped import ClampedBSpline, Knots, Parameters
from .clamped_fit import clamped_control_points
from .clamped_readings import ClampedReading, Count, clamped_readings
from .curve import Curve, PeakGradients, fit
from .errors import CaseError, CurveError, TrajgapError
from .gradient import peak_gradients
from .interpolant import (
    Interpolant,
    cubic_spline,
    cubic_spline_virtual,
    jtraj,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from .inverse import IkSolution, IkStatus, inverse_kinematics
from .limits import QUANTITIES, Limits
from .load import load_case, parse_case, published_ids
from .peak import Extremum, extrema
from .printed import Printed
from .problem import Coupling, Problem
from .proximity import Proximity, proximity
from .robot import (
    Chain,
    Convention,
    JointKind,
    forward_kinematics,
    geometric_jacobian,
    link_frames,
)
from .robot_file import load_robot, robot_ids
from .scaffold import scaffold
from .schema import CaseFile, case_schema
from .stretched import closed_form
from .timed import ClockedTrajectory
from .trajectory import Trajectory
from .uniform import Timing, control_vertices, uniform_cubic_b_spline
from .workspace import StepKind, Workspace, sample_workspace, waypoint_family

__all__ = [
    "QUANTITIES",
    "CartesianLine",
    "Case",
    "CaseError",
    "CaseFile",
    "Chain",
    "Check",
    "ClampedBSpline",
    "ClampedReading",
    "ClockedTrajectory",
    "Convention",
    "Count",
    "Coupling",
    "Curve",
    "CurveError",
    "DurationBox",
    "Evaluation",
    "Extremum",
    "IkSolution",
    "IkStatus",
    "Interpolant",
    "JointKind",
    "Jump",
    "Knots",
    "Limits",
    "Parameters",
    "Peak",
    "PeakGradients",
    "Printed",
    "Problem",
    "Proximity",
    "StepKind",
    "Timing",
    "Trajectory",
    "TrajgapError",
    "Verdict",
    "Workspace",
    "case_schema",
    "check",
    "clamped_control_points",
    "clamped_readings",
    "closed_form",
    "control_vertices",
    "ctraj",
    "cubic_spline",
    "cubic_spline_virtual",
    "evaluate",
    "extrema",
    "fit",
    "forward_kinematics",
    "geometric_jacobian",
    "inverse_kinematics",
    "jtraj",
    "link_frames",
    "load_case",
    "load_robot",
    "parse_case",
    "peak_gradients",
    "piecewise",
    "proximity",
    "published_ids",
    "quintic_spline",
    "reachable_total",
    "rest_to_rest",
    "robot_ids",
    "sample_workspace",
    "scaffold",
    "three_five_three",
    "uniform_cubic_b_spline",
    "waypoint_family",
]
