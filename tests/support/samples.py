"""Shifted, unequal sample problems for the tests of ``trajgap.problem``."""

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
    rest_to_rest,
    three_five_three,
)

DECLARATIONS: dict[str, Interpolant] = {
    "3-5-3": three_five_three(),
    "4-3-4": piecewise((4, 3, 4)),
    "cubic": cubic_spline(4),
    "cubic, moving ends": cubic_spline(3, ((1, 0.25),)),
    "cubic, virtual": cubic_spline_virtual(3),
    "quintic": quintic_spline(3),
    "rest 3": rest_to_rest(2, 3),
    "rest 5": rest_to_rest(2, 5),
    "rest 7": rest_to_rest(1, 7),
    "4-2-3": piecewise((4, 2, 3), 1),
    "3-1-3": piecewise((3, 1, 3), 1, ((1, 0.0),)),
    "4-1-4": piecewise((4, 1, 4), 2, ((1, 0.0),)),
    "lines": piecewise((1, 1), 0, ()),
    "uneven": Interpolant(
        (4, 6, 3),
        (3, 2),
        (((1, 0.0), (2, 0.0)), ((1, -0.3),), (), ((1, 0.2), (2, 0.5))),
    ),
}
"""Determined declarations, one of each kind, and some that nobody prints."""

FREE: dict[str, Interpolant] = {
    "5-5-5 C2": piecewise((5, 5, 5), 2),
    "5-4-5 C2": piecewise((5, 4, 5), 2),
    "6-6 C3": piecewise((6, 6), 3),
    "virtual quintics": Interpolant(
        (5, 5, 5), (4, 4), (((1, 0.0),), (), (), ((1, 0.0),)), virtual=(1,)
    ),
}
"""Under-determined declarations, completed by nodal derivatives."""


def sample_problem(
    interpolant: Interpolant,
    seed: int,
    joints: int = 3,
    limits: Limits | None = None,
    **changes: object,
) -> tuple[Problem, np.ndarray]:
    """Random problem with offsets and unequal joints, and a random duration vector."""
    rng = np.random.default_rng(seed)
    count = len(interpolant.waypoint_breaks)
    spread = rng.uniform(0.2, 2.0, joints)
    waypoints = rng.normal(size=(count, joints)) * spread + rng.uniform(-3, 3, joints)
    if limits is None:
        limits = Limits(
            rng.uniform(1, 4, joints), rng.uniform(2, 9, joints), rng.uniform(20, 90, joints)
        )
    durations = rng.uniform(0.3, 2.0, interpolant.segments)
    return Problem(waypoints, limits, interpolant, **changes), durations  # type: ignore[arg-type]
