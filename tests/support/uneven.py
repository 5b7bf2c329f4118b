"""Problems whose lower and upper limits differ."""

from collections.abc import Callable

import numpy as np
from trajgap.problem import Curve, Limits, Problem, Timing, curves

WAYPOINTS = np.array([[0.1, -0.4], [0.7, 0.3], [1.2, -0.5], [0.9, 0.2]])
"""Both joints turn, so every side of a limit is met."""
LIMITS = Limits([[-0.9, 1.4], [-2, 1.1]], [[-3, 5], [-6, 2.5]], [[-40, 25], [-20, 60]])
"""No two sides alike."""
CURVES: dict[str, Callable[[], Curve]] = {
    "3-5-3": curves.three_five_three,
    "cubic": lambda: curves.cubic_spline(3),
    "quintic": lambda: curves.quintic_spline(3),
    "rest-to-rest": lambda: curves.rest_to_rest(3, 5),
    "stretched": lambda: curves.uniform_cubic_b_spline(4, Timing.STRETCHED),
}
"""Kinds of curves through four way-points."""


def uneven_problem(curve: str, limits: Limits = LIMITS) -> Problem:
    """A problem of three segments and two joints."""
    return Problem(WAYPOINTS, limits, CURVES[curve]())
