"""Optimality conditions, with every active peak found again, and the ends of local searches.

`kkt` finds multipliers by non-negative least squares over all limits that are reached: dense, for
few segments. `sparse_kkt` takes those of the NLP.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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
from ...problem.curves import PERM, Places, Trajectory
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


NEWTON_STEPS = 4
"""Steps by which a place inside a segment is brought onto its extremum; it starts very near."""
COUNTS = 1e-6
"""Multiplier, in shares of the total of a mean segment, from which a limit is called active."""
REACHED = 1e-6
"""Relative distance to a limit within which a limit with a multiplier is called active."""


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers of limits at places, and of bounds on durations, as a search leaves them.

    Attributes
    ----------
    places : Places
    follows : ndarray of bool
        Which places belong to the extremum beside them; the others stay: where a derivative is all
        but constant, as on a plateau at its limit, any place does, but a multiplier belongs to its
        own.
    limits : ndarray
        Signed by the side, of limits in shares of themselves (positions in rad); s.
    walls : ndarray, shape (segments,)
        Of the bounds on durations, s per s, signed by the side.
    """

    places: Places
    follows: NDArray[np.bool_]
    limits: Array
    walls: Array


def along(trajectory: Trajectory, places: Places, further: int) -> Array:
    """Derivatives in s of order ``places.order + further`` at places."""
    a = trajectory.scaled[places.segment, :, places.joint]
    r = places.order + further
    out = np.zeros(places.s.size)
    for p in range(min(a.shape[1], len(PERM)) - 1, -1, -1):
        factor = PERM[p, np.minimum(r, PERM.shape[1] - 1)]
        out = np.where(p >= r, out * places.s + factor * a[:, p], out)
    return out


def on_extrema(trajectory: Trajectory, places: Places) -> Places:
    """Places inside segments moved onto the extrema beside them; those at ends stay."""
    inner = (places.s > 0.0) & (places.s < 1.0)
    s = places.s
    for _ in range(NEWTON_STEPS):
        now = replace(places, s=s)
        slope, bend = along(trajectory, now, 1), along(trajectory, now, 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(inner & (bend != 0.0), slope / bend, 0.0)
        s = np.clip(s - np.clip(step, -0.1, 0.1), 0.0, 1.0)
    return replace(places, s=s)


def sparse_kkt(problem: Problem, durations: Array, found: Multipliers, violation: float) -> KKT:
    """Optimality conditions at given multipliers: nothing is solved but one banded system.

    Parameters
    ----------
    problem : Problem
    durations : ndarray, shape (segments,)
        s.
    found : Multipliers
    violation : float
        Largest relative excess over any limit, from `check`.

    Returns
    -------
    KKT
        Scaled as `optimality.kkt` scales it.

    Notes
    -----
    The conditions are those of `optimality.kkt`. With multipliers w of the limits, Σ w_i ∂g_i/∂h is
    the gradient of one weighted sum of values, which one adjoint solve gives for all durations.
    Their limits need not be within a chosen distance: w_i g_i = 0 is part of the residual.
    """
    total = float(durations.sum())
    trajectory = fit(problem.curve, problem.waypoints, durations)
    moved = on_extrema(trajectory, found.places)
    places = replace(moved, s=np.where(found.follows, moved.s, found.places.s))
    adjoint = problem.piecewise.adjoint(problem.waypoints, durations)
    limits, j, position = problem.limits, places.joint, places.order == 0
    side = np.where(found.limits >= 0.0, 1.0, -1.0)
    edge = np.where(side > 0, limits.position_upper[j], limits.position_lower[j])
    edge = np.where(np.isfinite(edge), edge, 0.0)
    column = np.maximum(places.order, 1) - 1
    rate = limits.sides[(side > 0).astype(np.int64), j, column]
    # Rows are shares of the larger side; a limit of 0 has no other size.
    larger = np.where(np.isfinite(limits.sides), limits.sides, 0.0).max(axis=0)[j, column]
    larger = np.where(larger > 0.0, larger, 1.0)
    rate = np.where(np.isfinite(rate), rate, larger)
    own = np.where(rate > 0.0, rate, larger)
    scale = np.where(position, np.maximum(1.0, np.abs(edge)), own)
    values = adjoint.values(places)
    excess = np.where(position, side * (values - edge), side * values - rate) / scale
    weights = np.abs(found.limits) * np.where(position, scale, own / larger) / total
    walls = np.abs(found.walls) * durations / total
    low, high = problem.duration_lower, problem.duration_upper
    with np.errstate(divide="ignore", invalid="ignore"):
        gap = np.where(found.walls > 0, 1.0 - durations / high, durations / low - 1.0)
    gap = np.where(np.isfinite(gap), gap, 1.0)
    slope = adjoint.weighted(places, side * weights / scale)
    stationary = durations * (1.0 / total + slope) + np.sign(found.walls) * walls
    residual = max(
        float(np.abs(stationary).max()),
        float(np.abs(weights * excess).max(initial=0.0)),
        float(np.abs(walls * gap).max()),
        violation,
    )
    counts = COUNTS / problem.segments
    active = []
    breaks = trajectory.breaks
    size = np.where(position, np.abs(edge) / scale, 1.0)
    for i in np.flatnonzero((weights > counts) & (np.abs(excess) <= REACHED)).tolist():
        k, r, w = int(places.segment[i]), int(places.order[i]), float(weights[i] * total)
        quantity = "position" if r == 0 else QUANTITIES[r - 1]
        time = float(breaks[k] + places.s[i] * durations[k])
        if places.s[i] == 0.0 and k > 0 and problem.piecewise.smooth_order(k) >= r:
            k -= 1  # what both segments share belongs to the first, as in `optimality.kkt`
        joint = problem.joints[int(j[i])]
        active.append(Active(joint, quantity, k, time, w, -MORE * float(size[i]) * w))
    for k in np.flatnonzero((walls > counts) & (np.abs(gap) <= REACHED)).tolist():
        w = float(walls[k] * total)
        sign = float(np.sign(found.walls[k]))
        active.append(Active(None, "duration", k, None, w, -sign * MORE * w))
    return KKT(residual, tuple(active))


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
