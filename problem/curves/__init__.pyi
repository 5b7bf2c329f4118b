from .adjoint import Adjoint as Adjoint, Places as Places, places_of as places_of
from .clamped import (
    ClampedBSpline as ClampedBSpline,
    ClampedReading as ClampedReading,
    Count as Count,
    clamped_readings as clamped_readings,
)
from .clamped_declaration import (
    Knots as Knots,
    Parameters as Parameters,
    average_matrix as average_matrix,
    fractions_of as fractions_of,
)
from .clamped_fit import splines_of as splines_of
from .condition import (
    ConditionKind as ConditionKind,
    Conditions as Conditions,
    Layout as Layout,
    counts_in_words as counts_in_words,
)
from .families import (
    cubic_spline as cubic_spline,
    cubic_spline_virtual as cubic_spline_virtual,
    jtraj as jtraj,
    piecewise as piecewise,
    quintic_spline as quintic_spline,
    quintic_spline_virtual as quintic_spline_virtual,
    rest_to_rest as rest_to_rest,
    septic_spline as septic_spline,
    three_five_three as three_five_three,
)
from .interpolant import (
    MOST_OPEN as MOST_OPEN,
    Interpolant as Interpolant,
    as_piecewise as as_piecewise,
    right_hand_sides as right_hand_sides,
)
from .kind import (
    Asked as Asked,
    Curve as Curve,
    Derivatives as Derivatives,
    Enclosed as Enclosed,
    Timing as Timing,
    as_curve as as_curve,
    as_durations as as_durations,
    fit as fit,
)
from .peak import (
    Extremum as Extremum,
    Furthest as Furthest,
    PeakGradients as PeakGradients,
    extrema as extrema,
    furthest as furthest,
)
from .polynomials import (
    MAX_COEFFICIENTS as MAX_COEFFICIENTS,
    PERM as PERM,
    bernstein as bernstein,
    derivative_rows as derivative_rows,
    derived as derived,
    roots_in_unit as roots_in_unit,
    valued as valued,
)
from .stretched import solve_in_closed_form as solve_in_closed_form
from .timed import ClockedTrajectory as ClockedTrajectory, numerators as numerators
from .trajectory import Trajectory as Trajectory
from .uniform import (
    StretchedUniformBSpline as StretchedUniformBSpline,
    TimedUniformBSpline as TimedUniformBSpline,
    clock_matrix as clock_matrix,
    control_vertices as control_vertices,
    shape_matrix as shape_matrix,
    uniform_cubic_b_spline as uniform_cubic_b_spline,
    vertex_matrix as vertex_matrix,
)
