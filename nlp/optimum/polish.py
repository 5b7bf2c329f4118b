"""Newton steps on the optimality conditions of the reduced problem, on a known active set."""

from __future__ import annotations

import numpy as np

from ...problem import Array, CurveError, Extremum, Problem, check, extrema, fit, peak_gradients
from .clock import time_up
from .optimality import KKT, Active, kkt

_STEPS = 4
"""Newton steps: few are needed, since interior-point answers are near and it is quadratic."""
_DIFFERENCE = 1e-6
"""Step of the central differences in log durations: their truncation is 1e-12, rounding 1e-10."""


def polish(problem: Problem, durations: Array, report: KKT) -> tuple[Array, KKT]:
    """Sharpen a converged answer whose active limits are known.

    Interior-point answers keep a slack of the order of the last barrier parameter; Newton's method
    on stationarity and the active limits removes it. The answer is kept only if it is feasible
    and its KKT residual is smaller.

    Parameters
    ----------
    problem : Problem
        With a determined curve.
    durations : ndarray, shape (segments,)
    report : KKT
        Of these durations.

    Returns
    -------
    durations, report
        The better of what was given and what was found.
    """
    limited = [a for a in report.active if a.quantity in _ORDERS]
    pinned = [a.segment for a in report.active if a.quantity == "duration"]
    # A side of 0 has no size that an excess could be set beside.
    moves = np.ptp(problem.waypoints, axis=0) > 0
    odd = problem.curve.free or not (problem.limits.sides[:, moves] > 0).all()
    if odd or len(limited) < len(report.active) - len(pinned):
        return durations, report
    try:
        return _sharpened(problem, durations, report, limited, pinned)
    except (CurveError, np.linalg.LinAlgError):
        return durations, report  # beside the answer, rounding hides the curve or its curvature


def _sharpened(
    problem: Problem, durations: Array, report: KKT, limited: list[Active], pinned: list[int]
) -> tuple[Array, KKT]:
    """`polish` on these limits and bounds."""
    moving = np.setdiff1d(np.arange(problem.segments), pinned)
    active = [_nearest(problem, durations, a) for a in limited]
    weights = np.array([a.multiplier for a in limited])
    h = durations.copy()
    for _ in range(_STEPS):
        if time_up():
            return durations, report
        base, excess, columns = _conditions(problem, h, active, weights)
        hessian = np.empty((moving.size, moving.size))
        for i, k in enumerate(moving):
            if time_up():
                return durations, report
            step = np.zeros(h.size)
            step[k] = _DIFFERENCE
            ahead, _, _ = _conditions(problem, h * np.exp(step), active, weights)
            behind, _, _ = _conditions(problem, h * np.exp(-step), active, weights)
            hessian[:, i] = (ahead - behind)[moving] / (2 * _DIFFERENCE)
        block = columns[moving]
        size = len(active)
        system = np.block([[hessian, block], [block.T, np.zeros((size, size))]])
        right = -np.concatenate([base[moving], excess])
        step_all = np.linalg.lstsq(system, right, rcond=1e-12)[0]
        change = np.zeros(h.size)
        change[moving] = np.clip(step_all[: moving.size], -1e-3, 1e-3)
        h = h * np.exp(change)
        weights = weights + step_all[moving.size :]
    verdict = check(problem, h)
    if not verdict.stretch <= 1 + 1e-9:
        return durations, report
    h = np.clip(h * max(1.0, verdict.stretch), problem.duration_lower, problem.duration_upper)
    better = kkt(problem, h)
    allowed = max(1e-15, check(problem, durations).max_violation)
    if better.residual < report.residual and check(problem, h).max_violation <= allowed:
        return h, better
    return durations, report


_ORDERS = {"position": 0, "velocity": 1, "acceleration": 2, "jerk": 3}
"""Quantities whose active limit is a peak of this derivative."""


def _nearest(problem: Problem, h: Array, active: Active) -> Extremum:
    assert active.joint is not None
    assert active.time is not None
    time, curve = active.time, problem.curve
    points = extrema(
        fit(curve, problem.waypoints, h),
        problem.joints.index(active.joint),
        _ORDERS[active.quantity],
    )
    # Where a derivative jumps, two extrema share a time.
    own = [e for e in points if curve.segment_of(h, e) == active.segment]
    return min(own, key=lambda e: abs(e.time - time))


def _conditions(
    problem: Problem,
    h: Array,
    active: list[Extremum],
    weights: Array,
) -> tuple[Array, Array, Array]:
    """Lagrangian gradient in log durations, excess of the active limits, and their gradients."""
    trajectory = fit(problem.curve, problem.waypoints, h)
    points = []
    for a in active:
        same = [
            e
            for e in extrema(trajectory, a.joint, a.order)
            if e.segment == a.segment and (e.s in (0.0, 1.0)) == (a.s in (0.0, 1.0))
        ]
        points.append(min(same, key=lambda e: abs(e.s - a.s), default=a))
    sides = [_side(problem, e) for e in points]
    signs = np.array([sign for sign, _, _ in sides])
    excess = np.array([x for _, x, _ in sides])
    scales = np.array([scale for _, _, scale in sides])
    gradients = peak_gradients(problem, h, points).durations
    columns = (signs[:, None] * gradients * h / scales[:, None]).T
    return h + columns @ weights, excess, columns


def _side(problem: Problem, e: Extremum) -> tuple[float, float, float]:
    """Sign, excess and scale of an active extremum, scaled as in `kkt`."""
    limits, j = problem.limits, e.joint
    if e.order > 0:
        limit = float(limits.sides[int(e.value > 0.0), j, e.order - 1])
        return float(np.sign(e.value)), abs(e.value) / limit - 1.0, limit
    ends = (float(limits.position_lower[j]), float(limits.position_upper[j]))
    scale = max(1.0, *(abs(x) for x in ends if np.isfinite(x)))
    sign = -1.0 if abs(e.value - ends[0]) < abs(e.value - ends[1]) else 1.0
    return sign, sign * (e.value - ends[int(sign > 0)]) / scale, scale
