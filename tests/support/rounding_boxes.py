"""Problems with boxes around their inputs, sampled densely."""

from __future__ import annotations

import numpy as np
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    piecewise,
)

MOVING_ENDS = piecewise((4, 3, 4), 2, ((1, 0.3), (2, -0.7)))


def rounded_problem(
    seed: int, interpolant: Interpolant, joints: int = 2
) -> tuple[Problem, np.ndarray]:
    """Shifted, unequal data under velocity, acceleration and, for C4, jerk limits."""
    rng = np.random.default_rng(seed)
    count = len(interpolant.waypoint_breaks)
    waypoints = np.round(0.7 + rng.normal(size=(count, joints)), 4)
    durations = np.round(rng.uniform(0.4, 1.3, interpolant.segments), 3)
    jerk = rng.uniform(80.0, 200.0, joints) if interpolant.continuity[0] > 2 else np.inf
    limits = Limits(rng.uniform(2.0, 4.0, joints), rng.uniform(8.0, 20.0, joints), jerk)
    return Problem(waypoints, limits, interpolant), durations
