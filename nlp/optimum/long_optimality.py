"""Optimality conditions of problems of many segments, from the multipliers of a search."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...problem import QUANTITIES, Array, Problem, fit
from ...problem.curves import PERM, Places, Trajectory
from .optimality import MORE, Active

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


@dataclass(frozen=True, eq=False)
class LongKKT:
    """Scaled residual of the optimality conditions as `optimality.kkt` scales it."""

    residual: float
    active: tuple[Active, ...]


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


def long_kkt(problem: Problem, durations: Array, found: Multipliers, violation: float) -> LongKKT:
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
    LongKKT

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
    rate = limits.derivatives[j, np.maximum(places.order, 1) - 1]
    scale = np.where(position, np.maximum(1.0, np.abs(edge)), rate)
    values = adjoint.values(places)
    excess = np.where(position, side * (values - edge), side * values - rate) / scale
    weights = np.abs(found.limits) * np.where(position, scale, 1.0) / total
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
    return LongKKT(residual, tuple(active))
