"""B-spline problems on shifted, unequal way-points, and the uniform ones once more by scipy."""

import numpy as np
from scipy.interpolate import BSpline, CubicSpline
from scipy.optimize import brentq
from support.papers.motions import vertices
from support.samples import drawn_limits
from trajgap.problem import ClampedBSpline, Problem, uniform_cubic_b_spline

NATURAL = "timed, with natural ends of time"
"""The third reading of time, beside those of `Timing`."""


def clamped(kind, seed: int = 0, count: int = 8, joints: int = 3):
    """Shifted, unequal way-points; durations near the chords' proportions."""
    degree, knots, parameters, time = kind
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.5, 1.0, (count, joints)) * rng.choice([-1, 1], (count, joints))
    q = steps.cumsum(axis=0) * rng.uniform(0.3, 2, joints) + rng.uniform(-3, 3, joints)
    limits = drawn_limits(rng, joints)
    h = rng.uniform(0.9, 1.1, count - 1)
    curve = ClampedBSpline(count, degree, knots, parameters, time)
    return Problem(q, limits, curve), h


def uniform(time: str, seed: int = 0, count: int = 6, joints: int = 3, spread: float = 0.25):
    """Shifted, unequal way-points, limits on v, a and j, and durations of about 1 s."""
    rng = np.random.default_rng(seed)
    q = rng.normal(size=(count, joints)) * rng.uniform(0.3, 2, joints) + rng.uniform(-3, 3, joints)
    limits = drawn_limits(rng, joints)
    h = rng.uniform(1 - spread, 1 + spread, count - 1)
    natural = time == NATURAL
    curve = uniform_cubic_b_spline(count, "timed" if natural else time, natural)
    return Problem(q, limits, curve), h


Q = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1], [0.1, 0.42]])
H = np.array([0.83, 1.12, 0.74, 1.21])
SHARES = (0.0, 0.19, 0.48, 0.71, 1.0)
"""Printed parameters of the five way-points ``Q``."""
INNER = {
    3: (0.08, 0.27, 0.46, 0.71, 0.85),
    4: (0.13, 0.3, 0.62, 0.85),
    5: (0.2, 0.45, 0.7),
    6: (0.3, 0.64),
    7: (0.55,),
}
"""Printed inner knots by degree."""


def vector(degree: int, first: float = 0.0, last: float = 1.0) -> tuple[float, ...]:
    """A whole printed knot vector on any scale."""
    inner = [first + (last - first) * u for u in INNER[degree]]
    return (*[first] * (degree + 1), *inner, *[last] * (degree + 1))


def given(degree: int) -> ClampedBSpline:
    """Printed knots, way-points at their times."""
    return ClampedBSpline(5, degree, "given", "times", knot_vector=vector(degree))


def printed(degree: int) -> ClampedBSpline:
    """Printed knots, way-points at printed parameters, each segment stretched by itself."""
    whole = vector(degree)
    return ClampedBSpline(
        5, degree, "given", "given", "stretched", fractions=(SHARES,), knot_vector=whole
    )


def spline_by_scipy(w: np.ndarray) -> BSpline:
    """The same curve over e in [0, m − 1] as scipy's B-spline on integer knots."""
    m = w.shape[0]
    return BSpline(np.arange(-3.0, m + 3.0), vertices(w), 3)


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
