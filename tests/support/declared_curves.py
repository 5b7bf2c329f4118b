"""Declared curves of many kinds, and problems on them with limits of every order."""

import numpy as np
from trajgap.problem import Interpolant, Limits, Problem, curves

CURVES = {
    "3-5-3": (curves.three_five_three(), 4),
    "4-3-4": (curves.piecewise((4, 3, 4)), 4),
    "5-3-5, C3": (curves.piecewise((5, 3, 5), 3), 4),
    "4-3-3-4": (curves.piecewise((4, 3, 3, 4)), 5),
    "4-3-3-3-3-4": (curves.piecewise((4, 3, 3, 3, 3, 4)), 7),
    "septic, C6": (curves.septic_spline(3), 4),
    "clamped cubic": (curves.cubic_spline(4), 5),
    "cubic, virtual": (curves.cubic_spline_virtual(3), 3),
    "quintic": (curves.quintic_spline(3), 4),
    "quintic, virtual": (curves.quintic_spline_virtual(3), 3),
    "rest inside": (
        Interpolant(
            (5, 3, 4, 4),
            (2, 2, 2),
            (((1, 0.0), (2, 0.0)), (), ((1, 0.0), (2, 0.0)), (), ((1, 0.0), (2, 0.0))),
            name="mixed degrees with a stop",
        ),
        5,
    ),
    "4-3-4, moving": (curves.piecewise((4, 3, 4), ends=((1, -0.25), (2, 0.5))), 4),
    "clamped cubic, moving": (curves.cubic_spline(4, ((1, 0.5),), ((1, -0.25),)), 5),
    "quintic, moving": (curves.quintic_spline(2, ((1, 0.0), (2, -0.5)), ((1, 0.375), (2, 0.0))), 3),
    "one piece, moving": (curves.piecewise((5,), ends=((1, 0.25), (2, -0.5))), 2),
    "moving inside": (
        Interpolant(
            (5, 4, 4),
            (2, 2),
            (((1, 0.0), (2, 0.5)), ((1, 0.625),), ((2, -0.25),), ((1, 0.0), (2, 0.0))),
            name="mixed degrees with a pass at speed",
        ),
        4,
    ),
}


def drawn(name: str, rng: np.random.Generator, joints: int) -> Problem:
    """With a limit of every order, position included, whose sides differ."""
    curve, count = CURVES[name]
    q = rng.normal(0.3, 1.0, (count, joints))
    high = rng.uniform(0.5, 3.0, (3, joints)) * np.array([[1.0], [2.0], [9.0]])
    low = -high * rng.uniform(0.6, 1.4, (3, joints))
    ranges = q.min(axis=0) - 0.5, q.max(axis=0) + rng.uniform(0.1, 1.0)
    limits = Limits(*np.stack([low, high], axis=2), *ranges)
    return Problem(q, limits, curve, rng.uniform(0.1, 0.2, curve.segments))
