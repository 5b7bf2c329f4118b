"""The question: limits, interpolants, trajectories, exact peaks, the checker, and case files."""

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
from .load import load_case, parse_case, published_ids
from .peak import Extremum, extrema
from .printed import Printed
from .problem import Coupling, Problem
from .scaffold import scaffold
from .schema import CaseFile, case_schema
from .spline import fit
from .trajectory import Trajectory

__all__ = [
    "QUANTITIES",
    "Case",
    "CaseError",
    "CaseFile",
    "Check",
    "Coupling",
    "DurationBox",
    "Evaluation",
    "Extremum",
    "Interpolant",
    "Jump",
    "Limits",
    "Peak",
    "PeakGradients",
    "Printed",
    "Problem",
    "Trajectory",
    "TrajgapError",
    "Verdict",
    "case_schema",
    "check",
    "cubic_spline",
    "cubic_spline_virtual",
    "evaluate",
    "extrema",
    "fit",
    "load_case",
    "parse_case",
    "peak_gradients",
    "piecewise",
    "published_ids",
    "quintic_spline",
    "reachable_total",
    "rest_to_rest",
    "scaffold",
    "three_five_three",
]
