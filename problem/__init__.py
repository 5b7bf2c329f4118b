"""The question: limits, interpolants, trajectories, exact peaks, the checker, and case files."""

from .check import Check, Evaluation, Jump, Peak, Verdict, check, evaluate
from .errors import CaseError, TrajgapError
from .gradient import PeakGradients, peak_gradients
from .interpolant import (
    Interpolant,
    cubic_spline,
    cubic_spline_virtual,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from .limits import QUANTITIES, Limits
from .peak import Extremum, extrema
from .problem import Coupling, Problem
from .spline import fit
from .trajectory import Trajectory

__all__ = [
    "QUANTITIES",
    "CaseError",
    "Check",
    "Coupling",
    "Evaluation",
    "Extremum",
    "Interpolant",
    "Jump",
    "Limits",
    "Peak",
    "PeakGradients",
    "Problem",
    "Trajectory",
    "TrajgapError",
    "Verdict",
    "check",
    "cubic_spline",
    "cubic_spline_virtual",
    "evaluate",
    "extrema",
    "fit",
    "peak_gradients",
    "piecewise",
    "quintic_spline",
    "rest_to_rest",
    "three_five_three",
]
