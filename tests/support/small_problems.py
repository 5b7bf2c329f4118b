"""Random problems of the sizes that papers pose: a few segments, a few joints, limits that bind."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    cubic_spline,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)

FAMILIES: dict[str, Callable[[int], Interpolant]] = {
    "3-5-3": lambda n: three_five_three(),
    "4-3-4": lambda n: piecewise((4, 3, 4), 2),
    "C2 cubic": cubic_spline,
    "C4 quintic": quintic_spline,
    "septic": lambda n: rest_to_rest(n, 7),
}
"""Declarations by name, for a number of segments where it is theirs to choose."""


def small_problem(family: str, seed: int) -> Problem:
    """A problem of a family; some have a position range or bounds on the durations."""
    generator = np.random.default_rng([seed, len(family)])
    curve = FAMILIES[family](int(generator.integers(2, 5)))
    joints = int(generator.integers(1, 5))
    q = generator.normal(size=(curve.segments + 1, joints))
    limits = generator.uniform(0.5, 3.0, (3, joints)) * np.array([[1.0], [2.0], [8.0]])
    limits[generator.integers(3)] = np.inf
    low, high = -np.inf, np.inf
    if generator.random() < 0.3:
        span = np.ptp(q, axis=0)
        low, high = q.min(axis=0) - 0.2 * span, q.max(axis=0) + 0.2 * span
    lower = generator.uniform(0.2, 1.0) if generator.random() < 0.4 else 0.0
    return Problem(q, Limits(*limits, low, high, joints=joints), curve, duration_lower=lower)
