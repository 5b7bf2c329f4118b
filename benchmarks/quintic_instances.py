"""Twenty seeded problems of 7 segments and 6 joints on the C4 quintic spline, for every benchmark.

Eight way-points each from the Monte-Carlo workspace of the Z1's printed table, at four step
lengths: acceleration alone decides at the short ones, velocity too at the longest. The limits are
Table 2 of z1-woa-bspline in its reading ``v-deg-a-deg`` (°/s and °/s²); durations are shared by the
joints and only have to be positive.
"""

import numpy as np
from trajgap.problem import (
    Coupling,
    Limits,
    Problem,
    load_robot,
    quintic_spline,
    sample_workspace,
    waypoint_sequences,
)

STEPS = (0.5, 1.0, 2.0, 3.0)
"""Largest change of a joint between way-points, rad."""
EACH = 5
SAMPLES = 2000
SEED = 20260301
VELOCITY = np.deg2rad([120.0, 120.0, 100.0, 180.0, 145.0, 180.0])
ACCELERATION = np.deg2rad(np.full(6, 100.0))


def instances() -> list[Problem]:
    """The twenty problems, always the same: five of each step length, shortest steps first."""
    workspace = sample_workspace(load_robot("z1"), SAMPLES, SEED)
    limits = Limits(VELOCITY, ACCELERATION)
    problems = []
    for k, step in enumerate(STEPS):
        family = waypoint_sequences(workspace, step=step, count=EACH, seed=SEED + 1 + k)
        for i, waypoints in enumerate(family):
            name = f"step {step} rad, number {i + 1}"
            problems.append(
                Problem(waypoints, limits, quintic_spline(7), coupling=Coupling.SHARED, name=name)
            )
    return problems
