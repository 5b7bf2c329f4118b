"""Optimality conditions of min Σh, with every active peak found again, and ends of searches.

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
from numpy.typing import NDArray

from ...problem import QUANTITIES, Array, CurveError, Problem, peak_gradients
from ...problem.curves import MAX_COEFFICIENTS, Places, places_of
from .clock import time_up
from .limit_rows import ExactRows, exact_rows, limited

ACTIVE = 1e-7
"""Relative distance to a limit within which a peak counts as active. What a multiplier is of the
mean segment's share of the total counts from the same number on: a barrier leaves some on all."""
KKT_TOLERANCE = 1e-8
"""Scaled KKT residual up to which an answer is called converged: IPOPT's own usual tolerance."""
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


def unmet(residual: float) -> str:
    """Why an answer is not called converged, of its KKT residual."""
    if np.isinf(residual):
        return "the search ended before it met the conditions of an optimum"
    return f"KKT residual {residual:.1e}, above {KKT_TOLERANCE:g}"


UNKNOWN = KKT(np.inf, ())
"""Of durations at which rounding hides the curve or its gradients: no condition is met."""


@dataclass(frozen=True, eq=False)
class _Reached:
    """Limits that a motion reaches, or comes near.

    Attributes
    ----------
    places : Places
    side : ndarray
        1 for the upper side, −1 for the lower.
    excess : ndarray
        Over the limit, in scales.
    scale, size : ndarray
        The limit's size, of a position at least 1 and of a limit of 0 the other side's; and the
        limit's own size in scales.
    """

    places: Places
    side: Array
    excess: Array
    scale: Array
    size: Array

    @classmethod
    def at(cls, problem: Problem, places: Places, side: Array, values: Array) -> _Reached:
        """The limits on one side of values at places."""
        limits, j, position = problem.limits, places.joint, places.order == 0
        edge = np.where(side > 0, limits.position_upper[j], limits.position_lower[j])
        sizes = limits.sides[:, j, np.maximum(places.order, 1) - 1]
        larger = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0, initial=0.0)
        larger = np.where(larger > 0.0, larger, 1.0)
        own = np.where(position, edge, np.where(side > 0, sizes[1], sizes[0]))
        own = np.where(np.isfinite(own), own, np.where(position, 0.0, larger))
        size = np.abs(own)
        scale = np.where(position, np.maximum(1.0, size), np.where(size > 0.0, size, larger))
        excess = (side * values - np.where(position, side * own, own)) / scale
        return cls(places, side, excess, scale, size / scale)

    def picked(self, at: NDArray[np.bool_]) -> _Reached:
        """Some of them."""
        p = self.places
        places = Places(p.joint[at], p.segment[at], p.order[at], p.s[at])
        return _Reached(places, self.side[at], self.excess[at], self.scale[at], self.size[at])


@dataclass(frozen=True, eq=False)
class _Walls:
    """Bounds of durations: segments, sides, relative distances to the bound."""

    segment: NDArray[np.int64]
    side: Array
    gap: Array

    @classmethod
    def of(
        cls, problem: Problem, durations: Array, segment: NDArray[np.int64], side: Array
    ) -> _Walls:
        """The bounds on one side of some durations."""
        h, low = durations[segment], problem.duration_lower[segment]
        with np.errstate(divide="ignore"):
            gap = np.where(side > 0, 1.0 - h / problem.duration_upper[segment], h / low - 1.0)
        return cls(segment, side, np.where(np.isfinite(gap), gap, 1.0))


def kkt(
    problem: Problem,
    durations: Array,
    nodal: Array | None = None,
    active: float = ACTIVE,
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
        Multipliers by non-negative least squares on the envelope gradients; an infinite residual
        where rounding hides the curve.

    Notes
    -----
    Where ratios are fixed, log T is the one unknown: all z_k change alike, and their equations are
    added up.
    """
    n, joints, free = problem.segments, problem.waypoints.shape[1], problem.curve.free
    try:
        found = limited(problem, durations, nodal)
        points = [one.extremum for one in found]
        side, values = np.array([[one.sign, one.extremum.value] for one in found]).reshape(-1, 2).T
        reached = _Reached.at(problem, places_of(points), side, values)
        near = reached.excess >= -active
        points, reached = [points[i] for i in np.flatnonzero(near)], reached.picked(near)
        gradients = peak_gradients(problem, durations, points, nodal)
    except CurveError:
        return UNKNOWN
    own = np.eye(joints)[reached.places.joint]
    units, widest = np.ones((MAX_COEFFICIENTS, joints)), problem.limits.widest.T
    units[1:4] = np.where(np.isfinite(widest), widest, 1.0)
    orders = [order for _, order in problem.piecewise.free_derivatives] if free else []
    by_nodal = gradients.nodal[:, :, None] * own[:, None] * units[orders]
    rows = np.hstack(
        [gradients.durations * durations, by_nodal.reshape(len(points), free * joints)]
    )
    low = np.flatnonzero(durations <= problem.duration_lower * (1 + active))
    high = np.flatnonzero(durations >= problem.duration_upper * (1 - active))
    sides = np.repeat([-1.0, 1.0], [low.size, high.size])
    walls = _Walls.of(problem, durations, np.append(low, high), sides)
    bounds = sides[:, None] * np.eye(n + free * joints)[walls.segment]
    matrix = np.vstack([rows * (reached.side / reached.scale)[:, None], bounds]).T
    objective = np.append(durations / durations.sum(), np.zeros(free * joints))
    if problem.ratios is not None:
        objective, matrix = objective.sum(keepdims=True), matrix.sum(axis=0, keepdims=True)
    weights = np.zeros(matrix.shape[1])
    if weights.size:
        from scipy.optimize import nnls  # a quarter of a second; a check does without

        try:
            weights, _ = nnls(matrix, -objective, maxiter=30 * weights.size + 100)
        except RuntimeError:  # too many iterations: rounding hides which limits hold the motion
            return UNKNOWN
    of_limits, of_bounds = np.split(weights, [len(points)])
    segments = [problem.curve.segment_of(durations, e) for e in points]
    labels = list(zip(segments, [e.time for e in points], strict=True))
    stationary = matrix @ weights + objective
    return _report(problem, durations, stationary, (reached, of_limits, labels), (walls, of_bounds))


def sparse_kkt(
    problem: Problem, durations: Array, places: Places, limits: Array, bounds: Array
) -> KKT:
    """Optimality conditions at given multipliers: nothing is solved but one banded system.

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

    Returns
    -------
    KKT

    Notes
    -----
    With multipliers w of the limits, Σ w_i ∂g_i/∂h is the gradient of one weighted sum of values,
    which one adjoint solve gives for all durations. Their limits need not be within a chosen
    distance: w_i g_i = 0 is part of the residual.
    """
    total = float(durations.sum())
    adjoint = problem.piecewise.adjoint(problem.waypoints, durations)
    side = np.where(limits >= 0.0, 1.0, -1.0)
    reached = _Reached.at(problem, places, side, adjoint.values(places))
    sizes = problem.limits.sides[:, places.joint, np.maximum(places.order, 1) - 1]
    larger = np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0)
    larger = np.where(places.order == 0, 1.0, np.where(larger > 0.0, larger, 1.0))
    weights = np.abs(limits) * reached.scale / (larger * total)
    walls = _Walls.of(problem, durations, np.arange(durations.size), np.sign(bounds))
    of_bounds = np.abs(bounds) * durations / total
    slope = adjoint.weighted(places, side * weights / reached.scale)
    stationary = durations * (1.0 / total + slope) + walls.side * of_bounds
    segments, starts = [], np.concatenate([[0.0], np.cumsum(durations)])
    for k, r, s in zip(places.segment.tolist(), places.order.tolist(), places.s, strict=True):
        # What both segments share belongs to the first, as in `kkt`.
        shared = s == 0.0 and k > 0 and problem.piecewise.smooth_order(k) >= r
        segments.append(k - int(shared))
    times = starts[places.segment] + places.s * durations[places.segment]
    labels = list(zip(segments, times.tolist(), strict=True))
    return _report(problem, durations, stationary, (reached, weights, labels), (walls, of_bounds))


def _report(
    problem: Problem,
    durations: Array,
    stationary: Array,
    limits: tuple[_Reached, Array, list[tuple[int, float]]],
    bounds: tuple[_Walls, Array],
) -> KKT:
    """The conditions, of limits with their weights, segments and times, and of bounds with theirs.

    A violation counts as far as these limits show it; `check` looks at all.
    """
    reached, weights, labels = limits
    walls, of_bounds = bounds
    residual = max(
        float(np.abs(stationary).max()),
        float(np.abs(weights * reached.excess).max(initial=0.0)),
        float(np.abs(of_bounds * walls.gap).max(initial=0.0)),
        float(reached.excess.max(initial=0.0)),
    )
    total, least = float(durations.sum()), ACTIVE / problem.segments
    active = []
    for i in np.flatnonzero((weights > least) & (np.abs(reached.excess) <= ACTIVE)).tolist():
        p, w, (segment, time) = reached.places, float(weights[i] * total), labels[i]
        quantity = ("position", *QUANTITIES)[p.order[i]]
        gain = -MORE * float(reached.size[i]) * w
        active.append(Active(problem.joints[p.joint[i]], quantity, segment, time, w, gain))
    for i in np.flatnonzero((of_bounds > least) & (np.abs(walls.gap) <= ACTIVE)).tolist():
        w = float(of_bounds[i] * total)
        more = -float(walls.side[i]) * MORE * w
        active.append(Active(None, "duration", int(walls.segment[i]), None, w, more))
    return KKT(residual, tuple(active))


SHARP = 1e-12
"""Residual that `sharpened` leaves as it is: rounding of gradients."""
SHARPENINGS = 4
"""Newton steps of `sharpened`: few are needed from near by, since it is quadratic."""
DIFFERENCE = 1e-6
"""Step of its central differences in log durations: they err by 1e-12, their rounding by 1e-10."""
NEAR_BY = 1e-3
"""Log durations by which one of its steps changes a duration at most: an answer is very near."""


def sharpened(problem: Problem, durations: Array) -> Array | None:
    """Newton steps on stationarity and the active limits; None where they lead nowhere.

    A search ends where rounding hides what it gains, before the gradient vanishes as far as it can.

    Parameters
    ----------
    problem : Problem
        With a determined curve.
    durations : ndarray, shape (segments,)
        s.
    """
    from scipy.optimize import nnls  # a quarter of a second; a check does without

    first = exact_rows(problem, durations)
    near = np.flatnonzero(first.excess > -ACTIVE)
    one = np.eye(durations.size)
    low = (durations <= problem.duration_lower * (1 + ACTIVE)).nonzero()[0]
    high = (durations >= problem.duration_upper * (1 - ACTIVE)).nonzero()[0]
    walls = np.vstack([-one[low], one[high]])
    slopes = np.vstack([first.gradient[near], walls])
    if not slopes.size:
        return None
    try:
        weights, _ = nnls(slopes.T, -durations / durations.sum())
    except RuntimeError:  # rounding hides which limits hold the motion
        return None
    loaded = weights[: near.size] > 0
    active, weights, held = near[loaded], weights[: near.size][loaded], weights[near.size :] > 0
    free = ~walls[held].any(axis=0)
    h, n, z = durations, int(free.sum()), active.size
    for _ in range(SHARPENINGS):
        now = _conditions(problem, h, first, active, weights)
        if now is None or time_up():
            return None
        slope, excess, columns = now
        if max(np.abs(slope[free]).max(initial=0.0), np.abs(excess).max(initial=0.0)) <= SHARP:
            break
        bends = []
        for k in np.flatnonzero(free):
            step = np.exp(DIFFERENCE * one[k])
            ahead, behind = (
                _conditions(problem, x, first, active, weights) for x in (h * step, h / step)
            )
            if ahead is None or behind is None:
                return None
            bends.append((ahead[0] - behind[0])[free] / (2 * DIFFERENCE))
        block = columns[:, free]
        system = np.block([[np.reshape(bends, (n, n)).T, block.T], [block, np.zeros((z, z))]])
        try:
            change = np.linalg.lstsq(system, -np.append(slope[free], excess), rcond=1e-12)[0]
        except np.linalg.LinAlgError:
            return None
        h = h * np.exp(one[free].T @ np.clip(change[:n], -NEAR_BY, NEAR_BY))
        weights = weights + change[n:]
    return h


def _conditions(
    problem: Problem, h: Array, first: ExactRows, active: NDArray[np.int64], weights: Array
) -> tuple[Array, Array, Array] | None:
    """Slope of the Lagrangian in log durations, excess of the active limits, and their slopes."""
    rows = exact_rows(problem, h)
    twins = [rows.twin(first.points[i], first.signs[i]) for i in active]
    if None in twins:
        return None
    at = np.array(twins, dtype=np.int64)
    return h / h.sum() + weights @ rows.gradient[at], rows.excess[at], rows.gradient[at]


@dataclass(frozen=True, eq=False)
class Local:
    """The end of a local search.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), or None
        Free derivatives, where the declaration leaves some.
    total : float
        s.
    converged : bool
        Whether the search ended because no step gained any more.
    feasible : bool
        Whether `check` passes the motion.
    iterations : int
    tight : (durations, nodal) or None
        What was moved inside its limits so that rounding errors do not decide, if anything was.
    report : KKT or None
        The optimality conditions, where the search knows them already.
    build_seconds : float
    """

    durations: Array
    nodal: Array | None
    total: float
    converged: bool
    feasible: bool
    iterations: int
    tight: tuple[Array, Array | None] | None = None
    report: KKT | None = None
    build_seconds: float = 0.0
