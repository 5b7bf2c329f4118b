"""What an expert would write for 3-5-3 polynomials alone: SLSQP on three durations, exact extrema.

The first and the last cubic are known in closed form, so is the quintic between them: no linear
system is left. Pinned: not to be improved.
"""

import numpy as np
from scipy.optimize import minimize


def ratios(h, steps, velocity, acceleration):
    """Largest |v| and |a| of each joint over their limits, for all t."""
    first, middle, last = steps
    v0, a0 = 3 * first / h[0], 6 * first / h[0] ** 2
    v1, a1 = 3 * last / h[2], -6 * last / h[2] ** 2
    t = h[1]
    d = middle - v0 * t - a0 * t**2 / 2
    e = (v1 - v0) * t - a0 * t**2
    f = (a1 - a0) * t**2
    c3, c4, c5 = 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2
    # Acceleration a0 t² + 6 c3 s + 12 c4 s² + 20 c5 s³ over t²: it turns where a quadratic is 0.
    cubic = np.stack([a0 * t**2, 6 * c3, 12 * c4, 20 * c5])
    root = np.sqrt(np.maximum(144 * c4**2 - 360 * c3 * c5, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = np.stack([(-12 * c4 + root) / (60 * c5), (-12 * c4 - root) / (60 * c5)])
    turns = np.where(np.isfinite(turns), np.clip(turns, 0.0, 1.0), 0.0)
    at_turns = cubic[0] + turns * (cubic[1] + turns * (cubic[2] + turns * cubic[3]))
    a = np.abs(np.vstack([at_turns / t**2, a0, a1])).max(axis=0)
    # Velocity turns where the acceleration is 0.
    companion = np.zeros((len(first), 3, 3))
    companion[:, 1, 0] = companion[:, 2, 1] = 1.0
    lead = np.where(np.abs(cubic[3]) > 1e-14, cubic[3], 1e-14)
    companion[:, :, 2] = -(cubic[:3] / lead).T
    roots = np.linalg.eigvals(companion)
    s = np.where(np.abs(roots.imag) < 1e-9, np.clip(roots.real, 0.0, 1.0), 0.0).T
    speed = v0 * t + s * (a0 * t**2 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
    v = np.abs(np.vstack([speed / t, v0, v1])).max(axis=0)
    return np.concatenate([v / velocity, a / acceleration])


def solve(waypoints, velocity, acceleration, lower):
    """Solve once from one start; returns the durations."""
    steps = np.diff(waypoints, axis=0)
    found = minimize(
        np.sum,
        np.full(3, 1.2),
        jac=lambda h: np.ones(3),
        method="SLSQP",
        bounds=[(lower, None)] * 3,
        constraints={"type": "ineq", "fun": lambda h: 1 - ratios(h, steps, velocity, acceleration)},
        options={"ftol": 1e-9},
    )
    return found.x
