"""Optimality conditions, with every active peak found again, and the ends of local searches.

`kkt` finds multipliers by non-negative least squares over all limits that are reached: dense, for
few segments. `sparse_kkt` takes those of the NLP.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...problem import QUANTITIES, Array, CurveError, Extremum, Problem, fit, peak_gradients
from ...problem.curves import Places, Trajectory
from .clock import time_up
from .limit_rows import ExactRows, along, exact_rows, limited

ACTIVE = 1e-7
"""Relative distance to a limit within which a peak counts as active."""
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


@dataclass(frozen=True)
class _Constraint:
    extremum: Extremum
    label: tuple[str | None, str, int, float | None]
    excess: float
    sign: float
    scale: float
    size: float
    """Of the limit, in scales."""


def _peaks_near_limit(
    problem: Problem, durations: Array, nodal: Array | None, near: float
) -> list[_Constraint]:
    found: list[_Constraint] = []
    for one in limited(problem, durations, nodal):
        e, quantity = one.extremum, ("position", *QUANTITIES)[one.extremum.order]
        if one.stretched:  # its excess is the logarithm of the stretch that it asks for
            excess, scale, size = float(np.expm1(e.order * one.excess)), one.limit, 1.0
        elif e.order == 0:
            scale = max(1.0, abs(one.limit))
            excess, size = one.excess * one.size / scale, abs(one.limit) / scale
        else:
            excess, scale, size = one.excess, one.size, 0.0
        if excess >= -near:
            segment = problem.curve.segment_of(durations, e)
            label = (problem.joints[e.joint], quantity, segment, e.time)
            found.append(_Constraint(e, label, excess, one.sign, scale, size))
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
        gradients = peak_gradients(problem, durations, [c.extremum for c in rows], nodal)
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
        if free:
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
