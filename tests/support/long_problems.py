"""Problems of many segments: random walks of two joints within all limits."""

from __future__ import annotations

import numpy as np
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    cubic_spline,
    cubic_spline_virtual,
    piecewise,
    quintic_spline,
)

LIMITS = Limits([1.5, 3.0], [6.0, 15.0], [np.inf, 90.0])


def long_curves(segments: int) -> dict[str, Interpolant]:
    return {
        "cubic": cubic_spline(segments),
        "quintic": quintic_spline(segments),
        "virtual": cubic_spline_virtual(segments - 1),
        "degrees of two kinds": piecewise((4, *(3,) * (segments - 2), 4), 2),
        "moving ends": cubic_spline(segments, ((1, 0.25),)),
        "ends apart": cubic_spline(segments, ((1, (0.25, -0.4)),), ((1, (-0.1, 0.3)),)),
    }


def long_problem(
    curve: Interpolant, seed: int = 3, limits: Limits = LIMITS, **bounds: object
) -> Problem:
    rng = np.random.default_rng(seed)
    count = len(curve.waypoint_breaks)
    q = np.cumsum(rng.normal(size=(count, 2)) * [0.4, 0.9], axis=0) - 5.0
    return Problem(q, limits, curve, **bounds)  # type: ignore[arg-type]
