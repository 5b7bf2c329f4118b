from .adjoint import Adjoint, Places, places_of
from .clamped import ClampedBSpline, clamped_control_points
from .clamped_counts import ClampedReading, Count, clamped_readings
from .clamped_declaration import average_matrix, fractions_of
from .clamped_knots import Knots, Parameters
from .compilation import compiler
from .condition import Condition, ConditionKind, Conditions, Layout, counts_in_words
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
    coefficients_of_many,
    layout,
    right_hand_sides,
)
from .kind import Curve, Derivatives, Enclosed, as_curve, as_durations, fit
from .peak import (
    Extremum,
    Furthest,
    PeakGradients,
    critical_points,
    extrema,
    furthest,
    near_extrema,
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
from .stretched import Timing, segment_peaks, shape_of, solve_in_closed_form
from .timed import ClockedTrajectory, numerators
from .trajectory import Trajectory
from .uniform import StretchedUniformBSpline, TimedUniformBSpline, uniform_cubic_b_spline
from .uniform_matrices import clock_matrix, control_vertices, shape_matrix, vertex_matrix

__all__ = [
    "MAX_COEFFICIENTS",
    "MOST_OPEN",
    "PERM",
    "Adjoint",
    "ClampedBSpline",
    "ClampedReading",
    "ClockedTrajectory",
    "Condition",
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
    "clamped_control_points",
    "clamped_readings",
    "clock_matrix",
    "coefficients_of_many",
    "compiler",
    "control_vertices",
    "counts_in_words",
    "critical_points",
    "cubic_spline",
    "cubic_spline_virtual",
    "derivative_rows",
    "derived",
    "extrema",
    "fit",
    "fractions_of",
    "furthest",
    "jtraj",
    "layout",
    "near_extrema",
    "numerators",
    "piecewise",
    "places_of",
    "quintic_spline",
    "quintic_spline_virtual",
    "rest_to_rest",
    "right_hand_sides",
    "roots_in_unit",
    "segment_peaks",
    "septic_spline",
    "shape_matrix",
    "shape_of",
    "solve_in_closed_form",
    "three_five_three",
    "uniform_cubic_b_spline",
    "valued",
    "vertex_matrix",
]
