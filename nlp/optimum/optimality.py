"""KKT residual and multipliers of the reduced problem, with every active peak found again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import (
    QUANTITIES,
    Array,
    CurveError,
    Extremum,
    Problem,
    extrema,
    fit,
    peak_gradients,
)
from .limit_rows import beyond_nothing

ACTIVE = 1e-7
"""Relative distance to a limit within which a peak counts as active."""
MORE = 0.1
"""Sensitivities say what this much more of a limit would buy, to first order."""


@dataclass(frozen=True)
class Active:
    """A limit that is reached, with what it costs.

    Attributes
    ----------
    joint : str or None
        Joint label; None for a bound on a segment duration.
    quantity : str
        "velocity", "acceleration", "jerk", "position", "duration" (lower or upper bound).
    segment : int
        Segment, from 0.
    time : float or None
        Where on the trajectory, s.
    multiplier : float
        Lagrange multiplier of ratio ≤ 1, s; of a position of its excess over the limit's size, or
        over 1 rad or m where that is larger.
    sensitivity : float
        First-order change of the total time for 10 % more of this limit, s; of a position for a
        range that is wider by 10 % of the limit's size.
    """

    joint: str | None
    quantity: str
    segment: int
    time: float | None
    multiplier: float
    sensitivity: float


@dataclass(frozen=True)
class KKT:
    """Scaled residual of the optimality conditions, and the active limits.

    ``residual`` is the largest of stationarity (in log durations, relative to the total),
    complementarity and relative violation.
    """

    residual: float
    active: tuple[Active, ...]


UNKNOWN = KKT(np.inf, ())
"""Of durations at which rounding hides the curve or its gradients: no condition is met."""


@dataclass(frozen=True)
class _Constraint:
    extremum: Extremum | None
    label: tuple[str | None, str, int, float | None]
    excess: float
    sign: float
    scale: float
    size: float
    """Of the limit, in scales."""


def _peaks_near_limit(
    problem: Problem, durations: Array, nodal: Array | None, near: float
) -> list[_Constraint]:
    trajectory = fit(problem.curve, problem.waypoints, durations, nodal)
    limits, sides = problem.limits, problem.limits.sides
    curve = problem.curve
    every_break = len(curve.waypoint_breaks) == curve.segments + 1
    span = np.ptp(problem.waypoints, axis=0)
    found: list[_Constraint] = []
    for j, name in enumerate(problem.joints):
        for r, quantity in enumerate(QUANTITIES, start=1):
            if not np.isfinite(sides[:, j, r - 1]).any():
                continue
            for e in extrema(trajectory, j, r):
                repeated = e.s == 0.0 and e.segment > 0 and curve.smooth_order(e.segment) >= r
                if repeated:
                    continue
                label = (name, quantity, curve.segment_of(durations, e), e.time)
                rate = float(span[j]) / float(durations.sum()) ** r
                for at in beyond_nothing(e, sides[:, j, r - 1], rate):
                    if at.excess >= -near:
                        found.append(_Constraint(e, label, at.excess, at.sign, at.size, 0.0))
                limit = float(sides[int(e.value > 0.0), j, r - 1])
                if not np.isfinite(limit) or limit == 0:
                    continue
                excess = abs(e.value) / limit - 1
                if excess >= -near:
                    sign = float(np.sign(e.value))
                    found.append(_Constraint(e, label, excess, sign, limit, 1.0))
        low, high = float(limits.position_lower[j]), float(limits.position_upper[j])
        if np.isfinite(low) or np.isfinite(high):
            for e in extrema(trajectory, j, 0):
                given = e.s in (0.0, 1.0) and every_break
                for limit, sign in ((low, -1.0), (high, 1.0)):
                    if given or not np.isfinite(limit):
                        continue
                    scale = max(1.0, abs(limit))
                    excess = sign * (e.value - limit) / scale
                    if excess >= -near:
                        label = (name, "position", curve.segment_of(durations, e), e.time)
                        size = abs(limit) / scale
                        found.append(_Constraint(e, label, excess, sign, scale, size))
    return found


def kkt(
    problem: Problem,
    durations: Array,
    nodal: Array | None = None,
    active: float = ACTIVE,
) -> KKT:
    """Optimality conditions of min Σh over durations (and free nodal derivatives).

    Parameters
    ----------
    problem : Problem
    durations : ndarray, shape (segments,)
    nodal : ndarray, shape (free, joints), optional
    active : float
        Relative distance at which a limit counts as reached.

    Returns
    -------
    KKT
        Multipliers by non-negative least squares on the envelope gradients; an infinite residual
        where rounding hides the curve.

    Notes
    -----
    In log durations z = log h and free nodal derivatives x, in units of their limits, with T = Σh,

        min log T  subject to  g_i = ratio_i − 1 ≤ 0:
        h_k/T + Σ_i w_i ∂g_i/∂z_k = 0,  Σ_i w_i ∂g_i/∂x = 0,  w ≥ 0,  w_i g_i = 0.

    A peak's gradient is that of the derivative at its fixed place (envelope theorem), and
    ∂/∂z_k = h_k ∂/∂h_k. A bound of a duration is g = ±(z_k − log bound). Since d(log T) = dT/T, the
    multiplier of T itself is w_i T; easing limit i by a share ε changes T by −ε w_i T. Where ratios
    are fixed, log T is the one unknown: all z_k change alike, and their equations are added up.
    """
    n, total = problem.segments, float(durations.sum())
    joints = problem.waypoints.shape[1]
    free = problem.curve.free
    try:
        rows = _peaks_near_limit(problem, durations, nodal, active)
        points = [c.extremum for c in rows if c.extremum is not None]
        gradients = peak_gradients(problem, durations, points, nodal)
    except CurveError:
        return UNKNOWN
    columns = np.zeros((n + free * joints, len(rows)))
    nodal_scale = np.ones((free, joints))
    for i, (_, order) in enumerate(problem.piecewise.free_derivatives if free else ()):
        if 1 <= order <= 3:
            limit = problem.limits.widest[:, order - 1]
            nodal_scale[i] = np.where(np.isfinite(limit), limit, 1.0)
    for i, c in enumerate(rows):
        columns[:n, i] = c.sign * gradients.durations[i] * durations / c.scale
        if c.extremum is not None and free:
            block = np.zeros((free, joints))
            block[:, c.extremum.joint] = c.sign * gradients.nodal[i] / c.scale
            columns[n:, i] = (block * nodal_scale).ravel()
    bounds: list[tuple[int, float, float]] = []
    for k in range(n):
        low, high = problem.duration_lower[k], problem.duration_upper[k]
        if low > 0 and durations[k] <= low * (1 + active):
            bounds.append((k, -1.0, durations[k] / low - 1))
        if np.isfinite(high) and durations[k] >= high * (1 - active):
            bounds.append((k, 1.0, 1 - durations[k] / high))
    walls = np.zeros((n + free * joints, len(bounds)))
    for i, (k, sign, _) in enumerate(bounds):
        walls[k, i] = sign
    objective = np.concatenate([durations / total, np.zeros(free * joints)])
    matrix = np.hstack([columns, walls])
    if problem.ratios is not None:
        objective, matrix = objective.sum(keepdims=True), matrix.sum(axis=0, keepdims=True)
    if matrix.shape[1]:
        from scipy.optimize import nnls  # a quarter of a second; a check does without

        try:
            weights, _ = nnls(matrix, -objective, maxiter=30 * matrix.shape[1] + 100)
        except RuntimeError:  # too many iterations: rounding hides which limits hold the motion
            return UNKNOWN
    else:
        weights = np.zeros(0)
    stationarity = float(np.abs(matrix @ weights + objective).max())
    gaps = np.array([c.excess for c in rows] + [gap for _, _, gap in bounds])
    slack = float(np.abs(weights * gaps).max(initial=0.0))
    violation = max([0.0, *(c.excess for c in rows)])
    reached: list[Active] = []
    for c, w in zip(rows, weights, strict=False):
        joint, quantity, segment, time = c.label
        multiplier = float(w * total)
        more = MORE * c.size
        if multiplier > 0:
            reached.append(Active(joint, quantity, segment, time, multiplier, -more * multiplier))
    for (k, sign, _), w in zip(bounds, weights[len(rows) :], strict=True):
        multiplier = float(w * total)
        if multiplier > 0:
            reached.append(Active(None, "duration", k, None, multiplier, -sign * MORE * multiplier))
    return KKT(max(stationarity, slack, violation), tuple(reached))
