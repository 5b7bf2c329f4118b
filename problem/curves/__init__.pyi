from .adjoint import Adjoint, Places, places_of
from .clamped import (
    ClampedBSpline,
    ClampedReading,
    Count,
    clamped_readings,
)
from .clamped_declaration import Knots, Parameters, average_matrix, fractions_of
from .clamped_fit import splines_of
from .condition import ConditionKind, Conditions, Layout, counts_in_words
from .families import (
    cubic_spline,
    cubic_spline_virtual,
    jtraj,
    piecewise,
    quintic_spline,
    quintic_spline_virtual,
    rest_to_rest,
    septic_spline,
    three_five_three,
)
from .interpolant import (
    MOST_OPEN,
    Interpolant,
    as_piecewise,
    right_hand_sides,
)
from .kind import Asked, Curve, Derivatives, Enclosed, Timing, as_curve, as_durations, fit
from .peak import (
    Extremum,
    Furthest,
    PeakGradients,
    extrema,
    furthest,
)
from .polynomials import (
    MAX_COEFFICIENTS,
    PERM,
    bernstein,
    derivative_rows,
    derived,
    roots_in_unit,
    valued,
)
from .stretched import solve_in_closed_form
from .timed import ClockedTrajectory, numerators
from .trajectory import Trajectory
from .uniform import (
    StretchedUniformBSpline,
    TimedUniformBSpline,
    clock_matrix,
    control_vertices,
    shape_matrix,
    uniform_cubic_b_spline,
    vertex_matrix,
)

__all__ = [
    "MAX_COEFFICIENTS",
    "MOST_OPEN",
    "PERM",
    "Adjoint",
    "Asked",
    "ClampedBSpline",
    "ClampedReading",
    "ClockedTrajectory",
    "ConditionKind",
    "Conditions",
    "Count",
    "Curve",
    "Derivatives",
    "Enclosed",
    "Extremum",
    "Furthest",
    "Interpolant",
    "Knots",
    "Layout",
    "Parameters",
    "PeakGradients",
    "Places",
    "StretchedUniformBSpline",
    "TimedUniformBSpline",
    "Timing",
    "Trajectory",
    "as_curve",
    "as_durations",
    "as_piecewise",
    "average_matrix",
    "bernstein",
    "clamped_readings",
    "clock_matrix",
    "control_vertices",
    "counts_in_words",
    "cubic_spline",
    "cubic_spline_virtual",
    "derivative_rows",
    "derived",
    "extrema",
    "fit",
    "fractions_of",
    "furthest",
    "jtraj",
    "numerators",
    "piecewise",
    "places_of",
    "quintic_spline",
    "quintic_spline_virtual",
    "rest_to_rest",
    "right_hand_sides",
    "roots_in_unit",
    "septic_spline",
    "shape_matrix",
    "solve_in_closed_form",
    "splines_of",
    "three_five_three",
    "uniform_cubic_b_spline",
    "valued",
    "vertex_matrix",
]
