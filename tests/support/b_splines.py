"""B-spline problems on shifted, unequal way-points, and the uniform ones once more by scipy."""

import numpy as np
from scipy.interpolate import BSpline, CubicSpline
from scipy.optimize import brentq
from trajgap.problem import ClampedBSpline, Limits, Problem, uniform_cubic_b_spline

NATURAL = "timed, with natural ends of time"
"""The third reading of time, beside those of `Timing`."""


def clamped(kind, seed: int = 0, count: int = 8, joints: int = 3):
    """Shifted, unequal way-points; durations near the chords' proportions."""
    degree, knots, parameters, time = kind
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.5, 1.0, (count, joints)) * rng.choice([-1, 1], (count, joints))
    q = steps.cumsum(axis=0) * rng.uniform(0.3, 2, joints) + rng.uniform(-3, 3, joints)
    limits = Limits(
        rng.uniform(1, 4, joints), rng.uniform(2, 9, joints), rng.uniform(20, 90, joints)
    )
    h = rng.uniform(0.9, 1.1, count - 1)
    curve = ClampedBSpline(count, degree, knots, parameters, time)
    return Problem(q, limits, curve), h


def uniform(time: str, seed: int = 0, count: int = 6, joints: int = 3, spread: float = 0.25):
    """Shifted, unequal way-points, limits on v, a and j, and durations of about 1 s."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(count, joints)) * rng.uniform(0.3, 2, joints) + rng.uniform(-3, 3, joints)
    limits = Limits(
        rng.uniform(1, 4, joints), rng.uniform(2, 9, joints), rng.uniform(20, 90, joints)
    )
    h = rng.uniform(1 - spread, 1 + spread, count - 1)
    natural = time == NATURAL
    curve = uniform_cubic_b_spline(count, "timed" if natural else time, natural)
    return Problem(q, limits, curve), h


def vertices_by_solving(w: np.ndarray) -> np.ndarray:
    """(2) and (3) as a dense system in all m + 2 vertices, closing conditions included."""
    m = w.shape[0]
    matrix = np.zeros((m + 2, m + 2))
    for i in range(m):
        matrix[i, i : i + 3] = np.array([1, 4, 1]) / 6
    matrix[m, :2] = (1, -1)
    matrix[m + 1, -2:] = (1, -1)
    return np.linalg.solve(matrix, np.vstack([w, np.zeros((2, w.shape[1]))]))


def spline_by_scipy(w: np.ndarray) -> BSpline:
    """The same curve over e in [0, m − 1] as scipy's B-spline on integer knots."""
    m = w.shape[0]
    return BSpline(np.arange(-3.0, m + 3.0), vertices_by_solving(w), 3)


class ByScipy:
    """Motion in time from scipy's B-splines of q and t, inverted by bracketing."""

    def __init__(self, q: np.ndarray, h: np.ndarray, natural: bool = False) -> None:
        self.q = spline_by_scipy(q)
        nodes = np.concatenate([[0.0], np.cumsum(h)])[:, None]
        self.t = spline_by_scipy(nodes)
        if natural:
            self.t = CubicSpline(np.arange(len(nodes)), nodes, bc_type="natural")
        self.last = len(h)

    def time(self, e: float) -> float:
        return float(self.t(e)[0])

    def position(self, time: float) -> np.ndarray:
        e = brentq(lambda e: self.time(e) - time, 0.0, self.last, xtol=1e-15, rtol=1e-15)
        return self.q(e)
