"""Paths of known answers, and how their durations are compared."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BPoly, PPoly
from support.puma import PUMA
from trajgap.nlp.retiming.toppra_check import Retiming
from trajgap.problem import Interpolant, Trajectory, fit

PUMA_353 = np.array([0.98201, 1.22974, 1.08496])
"""Optimal durations of the shared 3-5-3 problem, rounded up."""


def trajectory(coefficients: list[ArrayLike], durations: ArrayLike) -> Trajectory:
    """Segments from ascending coefficients in their own time, each of shape (powers, joints)."""
    h = np.asarray(durations, dtype=float)
    blocks = [np.asarray(c, dtype=float) for c in coefficients]
    scaled = np.zeros((h.size, 10, blocks[0].shape[1]))
    for k, c in enumerate(blocks):
        scaled[k, : len(c)] = c * h[k] ** np.arange(len(c))[:, None]
    return Trajectory(h, scaled, tuple(len(c) - 1 for c in blocks))


def hermite(times: ArrayLike, nodes: ArrayLike) -> Trajectory:
    """Through position, velocity, ... at every time; nodes of shape (times, orders, joints)."""
    t, n = np.asarray(times, dtype=float), np.asarray(nodes, dtype=float)
    rows = [
        PPoly.from_bernstein_basis(BPoly.from_derivatives(t, list(n[:, :, j]))).c[::-1]
        for j in range(n.shape[2])
    ]
    return trajectory([np.stack([c[:, k] for c in rows], 1) for k in range(t.size - 1)], np.diff(t))


def rest_to_rest_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> float:
    """Trapezoid or triangle on the straight line along ``distance``, all joints together."""
    d = np.abs(np.asarray(distance, dtype=float))
    v = float(np.min(np.asarray(velocity) / d))
    a = float(np.min(np.asarray(acceleration) / d))
    return 1.0 / v + v / a if v**2 < a else 2.0 / np.sqrt(a)


def close(found: Retiming, expected: float) -> bool:
    assert found.applicable, found.why
    assert found.error < 1e-3 * expected
    return abs(found.extrapolated - expected) <= found.error


def puma(interpolant: Interpolant, durations: ArrayLike) -> Trajectory:
    return fit(interpolant, PUMA, durations)
