"""Optimality conditions of min Σh, with every active peak found again.

In log durations z = log h and free nodal derivatives x, in units of their limits, with T = Σh,

    min log T  subject to  g_i = ratio_i − 1 ≤ 0:
    h_k/T + Σ_i w_i ∂g_i/∂z_k = 0,  Σ_i w_i ∂g_i/∂x = 0,  w ≥ 0,  w_i g_i = 0.

A peak's gradient is that of the derivative at its fixed place (envelope theorem), and
∂/∂z_k = h_k ∂/∂h_k. A bound of a duration is g = ±(z_k − log bound). Since d(log T) = dT/T, the
multiplier of T itself is w_i T; easing limit i by a share ε changes T by −ε w_i T.

`kkt` finds multipliers by non-negative least squares over all limits that are reached: dense, for
few segments. `sparse_kkt` takes those of the NLP.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import QUANTITIES, Array, Extremum, Problem
from ...problem.curves import Places
from ..clock import time_up
from .limit_rows import ExactRows, Indices, exact_rows, excesses

ACTIVE = 1e-7
"""Relative distance to a limit within which a peak counts as active. What a multiplier is of the
mean segment's share of the total counts from the same number on: a barrier leaves some on all."""
KKT_TOLERANCE = 1e-8
"""Scaled KKT residual up to which an answer is called converged: IPOPT's own usual tolerance."""
MORE = 0.1
"""Sensitivities say what this much more of a limit would buy, to first order."""


@dataclass(frozen=True)
class Active:
    """A limit that is reached, with its multiplier.

    Attributes
    ----------
    joint : str or None
        Joint label; None for a bound on a segment duration.
    quantity : str
        One of `Limits.quantities`, "deceleration", "position", "duration" (lower or upper bound).
    segment : int
        Segment, from 0.
    time : float or None
        Time on the trajectory, s.
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

    @property
    def unmet(self) -> str | None:
        """Why the conditions are not met, if they are not."""
        if self.residual <= KKT_TOLERANCE:
            return None
        if np.isinf(self.residual):
            return "the search ended before it met the conditions of an optimum"
        return f"KKT residual {self.residual:.1e}, above {KKT_TOLERANCE:g}"


UNKNOWN = KKT(np.inf, ())
"""Of durations at which rounding hides the curve or its gradients: no condition is met."""


@dataclass(frozen=True, eq=False)
class _Weighed:
    """Limits and bounds of durations that are reached, with least-squares multipliers for log T.

    The limits by their numbers among the exact rows, and after them the bounds by segment and side,
    each with its slope and its weight; then what is left of the gradient of the Lagrangian.
    """

    near: Indices
    segments: Indices
    sides: Array
    slopes: Array
    weights: Array
    stationary: Array

    @classmethod
    def of(cls, problem: Problem, rows: ExactRows, active: float) -> _Weighed | None:
        """Multipliers of all that is nearer than ``active``; None where rounding hides them."""
        h, unknowns = rows.durations, rows.gradient.shape[1]
        near = np.flatnonzero(rows.excess >= -active)
        low = np.flatnonzero(h <= problem.duration_lower * (1 + active))
        high = np.flatnonzero(h >= problem.duration_upper * (1 - active))
        segments, sides = np.append(low, high), np.repeat([-1.0, 1.0], [low.size, high.size])
        walls = sides[:, None] * np.eye(unknowns)[segments]
        slopes = np.vstack([rows.gradient[near], walls])
        objective = np.append(h / h.sum(), np.zeros(unknowns - h.size))
        if problem.ratios is not None:
            slopes, objective = slopes.sum(axis=1, keepdims=True), objective.sum(keepdims=True)
        weights = np.zeros(len(slopes))
        if weights.size:
            from scipy.optimize import nnls  # a quarter of a second; a check does without

            try:
                weights, _ = nnls(slopes.T, -objective, maxiter=30 * weights.size + 100)
            except RuntimeError:  # too many iterations
                return None
        stationary = objective + weights @ slopes
        return cls(near, segments, sides, slopes, weights, stationary)


def kkt(
    problem: Problem, durations: Array, nodal: Array | None = None, active: float = ACTIVE
) -> KKT:
    """Optimality conditions over durations (and free nodal derivatives).

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
        Multipliers by non-negative least squares; an infinite residual if rounding errors hide the
        curve.

    Notes
    -----
    If ratios are fixed, log T is the only unknown: all z_k change equally, and their equations are
    added.
    """
    rows = exact_rows(problem, durations, nodal)
    found = _Weighed.of(problem, rows, active) if rows.worst < np.inf else None
    if found is None:
        return UNKNOWN
    of_limits, of_bounds = np.split(found.weights, [found.near.size])
    excess = rows.excess[found.near]
    walls = np.zeros((2, problem.segments))
    np.add.at(walls, ((found.sides > 0).astype(int), found.segments), of_bounds)
    limits = [
        (rows.points[i], rows.quantity(i), float(rows.signs[i]), w)
        for i, w in zip(found.near, of_limits, strict=True)
        if w > 0
    ]
    return _report(problem, durations, found.stationary, excess, of_limits, limits, walls)


def sparse_kkt(
    problem: Problem, durations: Array, places: Places, limits: Array, bounds: Array
) -> KKT:
    """Optimality conditions at given multipliers: nothing is solved but one banded system.

    With multipliers w of the limits, Σ w_i ∂g_i/∂h is the gradient of one weighted sum of values,
    which one adjoint solve gives for all durations. The limits need not be within a chosen
    distance: w_i g_i = 0 is part of the residual.

    Parameters
    ----------
    problem : Problem
        With a determined declaration.
    durations : ndarray, shape (segments,)
        s.
    places : Places
        Of limits. One of a derivative that is all but constant, as on a plateau at its limit, need
        not be an extremum: any place does, but a multiplier belongs to its own.
    limits : ndarray
        Multipliers, signed by the side, of limits in shares of the larger side (positions in rad).
    bounds : ndarray, shape (segments,)
        Of the bounds on durations, s per s, signed by the side.
    """
    total, joint, order = float(durations.sum()), places.joint, places.order
    adjoint = problem.piecewise.adjoint(problem.waypoints, durations)
    values, sign = adjoint.values(places), np.where(limits >= 0.0, 1.0, -1.0)
    excess, _, size = excesses(problem, total, joint, order, sign, values)
    excess = np.maximum(excess, -1.0)  # a sign may be that of a side without a limit, by rounding
    sizes = problem.limits.sides[:, joint, np.maximum(order, 1) - 1]
    larger = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0)
    slopes = limits / (np.where((order == 0) | (larger == 0.0), 1.0, larger) * total)
    weights = np.abs(slopes) * size
    stationary = durations * ((1.0 + bounds) / total + adjoint.weighted(places, slopes))
    walls = np.maximum([-bounds, bounds], 0.0) * durations / total
    starts = np.append(0.0, np.cumsum(durations))
    active = []
    for i in np.flatnonzero(np.abs(excess) <= ACTIVE).tolist():
        k, r, s = int(places.segment[i]), int(order[i]), float(places.s[i])
        time = float(starts[k] + s * durations[k])
        # What both segments share belongs to the first, as in `kkt`.
        k -= int(s == 0.0 and k > 0 and problem.piecewise.smooth_order(k) >= r)
        e = Extremum(int(joint[i]), k, r, s, time, float(values[i]))
        quantity = ("position", *QUANTITIES)[r]
        active.append((e, quantity, float(sign[i]), float(weights[i])))
    return _report(problem, durations, stationary, excess, weights, active, walls)


def _report(
    problem: Problem,
    durations: Array,
    stationary: Array,
    excess: Array,
    weights: Array,
    limits: list[tuple[Extremum, str, float, float]],
    walls: Array,
) -> KKT:
    """The conditions of limits and bounds, and those that are active.

    From the gradient of the Lagrangian of log T, excess and weights of the limits, those that are
    reached with their quantities, sides and weights, and the weights of bounds of durations.
    """
    total, least = float(durations.sum()), ACTIVE / problem.segments
    with np.errstate(divide="ignore"):
        gaps = np.stack(
            [durations / problem.duration_lower - 1.0, 1.0 - durations / problem.duration_upper]
        )
    gaps = np.where(np.isfinite(gaps), gaps, 1.0)
    parts = (stationary, weights * excess, walls * gaps)
    residual = max(float(np.abs(part).max(initial=0.0)) for part in parts)
    active, span = [], np.ptp(problem.waypoints, axis=0)
    for e, quantity, sign, weight in limits:
        if weight <= least:
            continue
        if e.order == 0:
            ends = problem.limits.position_lower, problem.limits.position_upper
            edge = abs(float(ends[int(sign > 0)][e.joint]))
            w = weight * total * max(1.0, edge) / (float(span[e.joint]) or 1.0)
            gain = edge / max(1.0, edge)
        else:
            w = weight * total / e.order
            gain = float(problem.limits.sides[int(sign > 0), e.joint, e.order - 1] > 0.0)
        segment = problem.curve.segment_of(durations, e)
        label = problem.joints[e.joint], quantity, segment, e.time
        active.append(Active(*label, w, -MORE * gain * w))
    for side, k in np.argwhere((walls > least) & (gaps <= ACTIVE)).tolist():
        w = float(walls[side, k] * total)
        active.append(Active(None, "duration", k, None, w, (MORE - 2 * MORE * side) * w))
    return KKT(max(residual, float(excess.max(initial=0.0))), tuple(active))


SHARP = 1e-10
"""Residual that is left as it is, and rounding of differences of gradients: a total is settled to
the last digit long before."""
DIFFERENCE = 1e-6
"""Step of differences of gradients in log durations: they err by about as much, relatively, and a
Newton step leaves this share of a residual that was small before."""

NEAR_BY = 1e-3
"""Log durations by which one of its steps changes a duration at most: an answer is very near."""


def sharpened(problem: Problem, durations: Array) -> Array | None:
    """Newton steps on stationarity and the active limits; None if they lead nowhere.

    A search ends where rounding hides what it gains, before the gradient vanishes as far as it can.
    Four steps are plenty from near by, because each leaves little of the residual. The curve is
    determined.
    """
    first = rows = exact_rows(problem, durations)
    found = _Weighed.of(problem, first, ACTIVE)
    if found is None or not found.weights.size:
        return None
    loaded = found.weights > 0
    limits, bounds = np.split(loaded, [found.near.size])
    active, weights = found.near[limits], found.weights[: found.near.size][limits]
    free = ~np.isin(np.arange(durations.size), found.segments[bounds])
    h, n, z, one = durations, int(free.sum()), active.size, np.eye(durations.size)
    for _ in range(4):
        now = _conditions(rows, first, active, weights)
        if now is None or time_up():
            return None
        slope, excess, columns = now
        if max(np.abs(slope[free]).max(initial=0.0), np.abs(excess).max(initial=0.0)) <= SHARP:
            break
        bends = []
        for k in np.flatnonzero(free):
            step = exact_rows(problem, h * np.exp(DIFFERENCE * one[k]))
            ahead = _conditions(step, first, active, weights)
            if ahead is None:
                return None
            bends.append((ahead[0] - slope)[free] / DIFFERENCE)
        block = columns[:, free]
        system = np.block([[np.reshape(bends, (n, n)).T, block.T], [block, np.zeros((z, z))]])
        try:
            change = np.linalg.lstsq(system, -np.append(slope[free], excess), rcond=SHARP)[0]
        except np.linalg.LinAlgError:
            return None
        h = h * np.exp(one[free].T @ np.clip(change[:n], -NEAR_BY, NEAR_BY))
        weights, rows = weights + change[n:], exact_rows(problem, h)
    return h


def _conditions(
    rows: ExactRows, first: ExactRows, active: Indices, weights: Array
) -> tuple[Array, Array, Array] | None:
    """Slope of the Lagrangian in log durations, excess of the active limits, and their slopes."""
    h = rows.durations
    twins = [rows.twin(first, i) for i in active]
    if None in twins:
        return None
    at = np.array(twins, dtype=np.int64)
    return h / h.sum() + weights @ rows.gradient[at], rows.excess[at], rows.gradient[at]
