from .adjoint import Adjoint, Places, places_of
from .clamped import ClampedBSpline
from .clamped_counts import ClampedReading, Count, clamped_readings
from .clamped_fit import clamped_control_points
from .clamped_knots import Knots, Parameters, average_matrix, fractions_of
from .compilation import (
    Deferred,
    at_hand,
    by_elements,
    compiler,
    compiling_at_once,
    compiling_until,
    interpreted,
)
from .condition import Condition, ConditionKind, counts_in_words
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
from .interpolant import MOST_OPEN, Interpolant
from .kernel import MAX_COEFFICIENTS, roots_in_unit
from .kind import Curve, Derivatives, PeakGradients, as_curve, fit
from .peak import Extremum, critical_points, extrema, largest, unit_roots
from .piece_kernel import one_sided_extreme, piece_extremes
from .pieces import MANY_PIECES, largest_of_each, may_jump, near_extrema, step_sizes, tops
from .refined import coefficient_gradient
from .spline import (
    PERM,
    Layout,
    as_durations,
    batch_coefficients,
    layout,
    motion_values,
    right_hand_sides,
)
from .stretched import Timing, segment_peaks, shape_of, solve_in_closed_form
from .timed import ClockedTrajectory, numerators
from .trajectory import Trajectory
from .uniform import StretchedUniformBSpline, TimedUniformBSpline, uniform_cubic_b_spline
from .uniform_matrices import clock_matrix, control_vertices, shape_matrix, vertex_matrix

__all__ = [
    "MANY_PIECES",
    "MAX_COEFFICIENTS",
    "MOST_OPEN",
    "PERM",
    "Adjoint",
    "ClampedBSpline",
    "ClampedReading",
    "ClockedTrajectory",
    "Condition",
    "ConditionKind",
    "Count",
    "Curve",
    "Deferred",
    "Derivatives",
    "Extremum",
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
    "at_hand",
    "average_matrix",
    "batch_coefficients",
    "by_elements",
    "clamped_control_points",
    "clamped_readings",
    "clock_matrix",
    "coefficient_gradient",
    "compiler",
    "compiling_at_once",
    "compiling_until",
    "control_vertices",
    "counts_in_words",
    "critical_points",
    "cubic_spline",
    "cubic_spline_virtual",
    "extrema",
    "fit",
    "fractions_of",
    "interpreted",
    "jtraj",
    "largest",
    "largest_of_each",
    "layout",
    "may_jump",
    "motion_values",
    "near_extrema",
    "numerators",
    "one_sided_extreme",
    "piece_extremes",
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
    "step_sizes",
    "three_five_three",
    "tops",
    "uniform_cubic_b_spline",
    "unit_roots",
    "vertex_matrix",
]
