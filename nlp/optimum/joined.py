"""Motions that are smooth at the way-points for some ratios of durations only, in closed form.

Where each segment depends on its own duration alone, a derivative of order r is a number of the
path over hʳ on each side of a break. That the two agree bounds the ratio of the two durations, and
every limit bounds one duration from below. Of all logarithms of durations that keep such bounds on
differences the least in every component is one of them: it is the optimum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import Array, Problem, extrema
from ...verify import shown_bound
from .feasibility import SURE, apart

AGREE = 1e-9
"""Share of their terms by which the checker lets two sides of a break differ."""
WITHIN = 0.5
"""Share of the checker's room for a jump that an answer uses."""
BEYOND = 1e3
"""Multiple of that room that a proof grants: the bounds on rounding are those at unit durations."""
RESOLVED = 20.0
"""Log ratio of two durations up to which an answer is given: beyond, rounding alone sets it."""


@dataclass(frozen=True, eq=False)
class _Ratios:
    """Bounds on the logarithm of each duration over the one before, and what sets the upper one."""

    low: Array
    high: Array
    reasons: tuple[str, ...]


def joined(problem: Problem) -> Array | str | None:
    """The shortest durations without a jump, why there are none, or None if no ratio is bounded.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    ndarray, shape (segments,), or str, or None
        s; the reason is a proof.
    """
    if problem.curve.piecewise is None or not apart(problem):
        return None
    wide = _ratios(problem, BEYOND)
    if np.isneginf(wide.low).all() and np.isposinf(wide.high).all():
        return None
    low, high = _box(problem)
    for k, reason in enumerate(wide.reasons):
        if not wide.low[k] <= wide.high[k] or np.isposinf(wide.low[k]):
            return f"the {reason} jumps at way-point {k + 1}, whatever the durations"
    slack = float(np.log(SURE))
    late = np.flatnonzero(_least(low, wide) > high + slack)
    if late.size:
        k = int(late[0])
        least = shown_bound(np.exp(_least(low, wide)[k]), "lower")
        return (
            f"without a jump of {_first(wide, k)} segment {k + 1} takes at least "
            f"{least} s within the limits and the duration bounds; "
            f"its upper bound is {problem.duration_upper[k]:.6g} s"
        )
    close = _ratios(problem, WITHIN)
    z = _least(low, close)
    if not np.ptp(z) < RESOLVED:
        return None
    if not (np.isfinite(z).all() and (close.low <= close.high).all() and (z <= high).all()):
        return None
    return np.asarray(np.maximum(np.exp(z), problem.duration_lower))


def _first(ratios: _Ratios, k: int) -> str:
    """What is smooth at a bounded break next to a segment, or at the nearest one."""
    bounded = np.flatnonzero(np.isfinite(ratios.low) | np.isfinite(ratios.high))
    return ratios.reasons[int(bounded[np.argmin(np.abs(bounded - k))])]


def _ratios(problem: Problem, share: float) -> _Ratios:
    """Bounds on log ratios of durations, by a share of the room that the checker leaves a jump.

    With x = h₁⁻ʳ, y = h₂⁻ʳ the two sides are Lx and Ry, and the checker asks for
    |Lx − Ry| ≤ Ex + Fy: with L ≥ 0, x(L − E) ≤ y(R + F) and x(L + E) ≥ y(R − F).
    """
    n = problem.segments
    found = problem.curve.enclosed(problem.waypoints, np.ones(n))
    low, high = np.full(n - 1, -np.inf), np.full(n - 1, np.inf)
    reasons = ["velocity"] * (n - 1)
    for k in range(n - 1):
        for j, joint in enumerate(problem.joints):
            for order in (1, 2) if problem.limits.limited[j, 2] else (1,):
                sides = [found.trajectory.derivative(k + i, j, order) for i in (0, 1)]
                # A joint that stands still has no derivative: rounding has no part in that.
                still = np.diff(problem.waypoints[k : k + 3, j]) == 0.0
                room = [
                    share * (float(found.error[k + i, order, j]) + AGREE * float(np.abs(s).sum()))
                    if not still[i]
                    else 0.0
                    for i, s in enumerate(sides)
                ]
                least, most = _ratio(float(sides[0].sum()), float(sides[1][0]), *room)
                if least > np.exp(order * low[k]) or most < np.exp(order * high[k]):
                    quantity = "velocity" if order == 1 else "acceleration"
                    reasons[k] = f"{quantity} of joint {joint}"
                with np.errstate(divide="ignore"):
                    low[k] = max(low[k], float(np.log(least)) / order)
                    high[k] = min(high[k], float(np.log(most)) / order)
    return _Ratios(low, high, tuple(reasons))


def _ratio(left: float, right: float, room: float, other: float) -> tuple[float, float]:
    """Least and largest x/y = (h₂/h₁)ʳ; the least above the largest where there is none."""
    if left < 0.0:
        left, right = -left, -right
    least, most = 0.0, np.inf
    if right > other:
        least = (right - other) / (left + room) if left + room > 0.0 else np.inf
    if left > room:
        most = max(0.0, (right + other) / (left - room))
        if most == 0.0:
            return np.inf, 0.0
    elif right < -other:
        least = -(right + other) / (room - left) if room > left else np.inf
    return least, most


def _box(problem: Problem) -> tuple[Array, Array]:
    """Bounds on log durations by limits and duration bounds, segment by segment."""
    least = np.array(problem.duration_lower)
    trajectory = problem.curve.fitted(problem.waypoints, np.ones(problem.segments))
    for j in range(len(problem.joints)):
        for r in (1, 2, 3):
            sizes = problem.limits.sides[:, j, r - 1]
            for e in extrema(trajectory, j, r) if np.isfinite(sizes).any() else ():
                limit = float(sizes[int(e.value > 0.0)])
                if not np.isfinite(limit) or limit == 0.0:
                    continue
                least[e.segment] = max(least[e.segment], (abs(e.value) / limit) ** (1.0 / r))
    with np.errstate(divide="ignore"):
        return np.log(least), np.log(problem.duration_upper)


def _least(low: Array, ratios: _Ratios) -> Array:
    """The least log durations above ``low`` whose differences keep their bounds from below.

    z₂ ≥ z₁ + low and z₁ ≥ z₂ − high: along a chain one pass each way reaches the fixed point.
    """
    z = low.copy()
    for k in range(z.size - 1):
        z[k + 1] = max(z[k + 1], z[k] + ratios.low[k])
    for k in range(z.size - 2, -1, -1):
        z[k] = max(z[k], z[k + 1] - ratios.high[k])
    for k in range(z.size - 1):
        z[k + 1] = max(z[k + 1], z[k] + ratios.low[k])
    return z
