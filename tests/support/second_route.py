"""3-5-3 optima by a route that shares no code with the package.

The curve of the synthetic papers, its exact peaks, scipy's SLSQP on the three durations.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize
from support.papers.motions import FAMILIES, Pieces


def ratios(
    durations: np.ndarray, waypoints: np.ndarray, velocity: float, acceleration: float
) -> np.ndarray:
    """Largest |v|/V and |a|/A of every joint and segment."""
    motion = FAMILIES["3-5-3"].fit(waypoints, durations)
    assert isinstance(motion, Pieces)
    segments = [
        Pieces(motion.lengths[[k]], motion.coefficients[[k]]) for k in range(len(durations))
    ]
    limits = [(r, x) for r, x in ((1, velocity), (2, acceleration)) if np.isfinite(x)]
    return np.concatenate([one.peaks(r) / limit for one in segments for r, limit in limits])


def shortest(
    waypoints: np.ndarray,
    velocity: float,
    acceleration: float,
    lower: float,
    starts: np.ndarray,
) -> tuple[float, np.ndarray]:
    """Best total over the starts, and its durations."""
    best, at = np.inf, starts[0]
    for start in starts:
        answer = minimize(
            np.sum,
            start,
            jac=lambda h: np.ones_like(h),
            bounds=[(max(lower, 1e-3), None)] * 3,
            constraints={
                "type": "ineq",
                "fun": lambda h: 1.0 - ratios(h, waypoints, velocity, acceleration),
                "jac": lambda h: -_jacobian(h, waypoints, velocity, acceleration),
            },
            method="SLSQP",
            options={"ftol": 1e-15, "maxiter": 300},
        )
        worst = ratios(answer.x, waypoints, velocity, acceleration).max()
        if worst <= 1 + 1e-9 and answer.fun < best:
            best, at = float(answer.fun), answer.x
    return best, at


def _jacobian(
    h: np.ndarray, waypoints: np.ndarray, velocity: float, acceleration: float
) -> np.ndarray:
    """Central differences."""
    steps = 1e-6 * np.diag(h)
    sides = [[ratios(h + s * e, waypoints, velocity, acceleration) for e in steps] for s in (1, -1)]
    return ((np.array(sides[0]) - np.array(sides[1])) / (2e-6 * h[:, None])).T
