"""Way-points of splines, drawn."""

from fractions import Fraction

import numpy as np
from support import exact_route
from trajgap.problem import (
    Interpolant,
    Problem,
)


def waypoints(count: int, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) * [0.4, 1.0, 2.0] + [-3.0, 0.5, 2.0]


def exact_scaled(
    interpolant: Interpolant, problem: Problem, h: np.ndarray, j: int, nodal: np.ndarray | None
) -> list[list[Fraction]]:
    extra = (
        None if nodal is None else dict(zip(interpolant.free_derivatives, nodal[:, j], strict=True))
    )
    pieces = exact_route.fitted(interpolant, problem.waypoints[:, j], h, extra)
    return [
        [c * Fraction(float(h[k])) ** p for p, c in enumerate(piece)]
        for k, piece in enumerate(pieces)
    ]
