"""Limits at the true extrema of a motion: how far each is kept, and how that changes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...problem import (
    BRAKING,
    QUANTITIES,
    Array,
    CurveError,
    Extremum,
    Problem,
    fit,
    peak_gradients,
)
from ...problem.checks import SidedPeaks, extrema_at
from ...problem.curves import MAX_COEFFICIENTS, Places, Trajectory

Indices = NDArray[np.int64]

NEAR = 0.3
"""Extrema below this share of their limit are left out: no step of a trust region reaches it."""
MOVED = 0.3
"""Share of its segment by which an extremum moves at most: further away is another one."""
STILL = 1e-13
"""Share of a joint's mean rate below which a derivative whose side is 0 counts as 0: rounding."""
INSIDE = 1e-11
"""Share of it by which a motion stays inside such a side: the checker allows no tolerance there,
and a descent keeps its rows to 1e-12."""


@dataclass(frozen=True, eq=False)
class ExactRows:
    """Limits to first order about one motion, in log durations and free derivatives.

    A stretch by c divides a derivative of order r by cʳ, so its excess is log(|value|/limit)/r:
    its gradient is −1 along a stretch, whatever the order and the units. A position's excess is
    counted in spans of the joint's way-points; that of a derivative whose side is 0, in shares of
    the joint's mean rate.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    excess : ndarray, shape (rows,)
        Above 0 the limit is exceeded.
    gradient : ndarray, shape (rows, segments + free · joints)
        d excess / d log duration, and by the free derivatives in units of their limits.
    points : tuple of Extremum
    signs : ndarray, shape (rows,)
        Which side of its range a value is at.
    stretched : ndarray of bool, shape (rows,)
        Whether a stretch of all durations repairs the excess.
    braking : ndarray of bool, shape (rows,)
        Whether it is one of deceleration, where that has a limit of its own.
    """

    durations: Array
    excess: Array
    gradient: Array
    points: tuple[Extremum, ...]
    signs: Array
    stretched: NDArray[np.bool_]
    braking: NDArray[np.bool_]

    @property
    def worst(self) -> float:
        """The largest excess."""
        return float(self.excess.max(initial=-np.inf))

    def longer(self, z: float) -> ExactRows:
        """The rows of the motion stretched by eᶻ in time: places and gradients are the same."""
        c = float(np.exp(z))
        points = tuple(replace(e, time=e.time * c, value=e.value / c**e.order) for e in self.points)
        excess = np.where(self.stretched, self.excess - z, self.excess)
        return replace(self, durations=self.durations * c, excess=excess, points=points)

    def quantity(self, row: int) -> str:
        """What a row limits."""
        return BRAKING if self.braking[row] else ("position", *QUANTITIES)[self.points[row].order]

    def twin(self, before: ExactRows, row: int) -> int | None:
        """The row whose extremum continues one of another motion: the nearest of its segment."""
        e = before.points[row]
        found = [
            (abs(other.s - e.s), k)
            for k, other in enumerate(self.points)
            if (other.joint, other.order, other.segment) == (e.joint, e.order, e.segment)
            and (other.s in (0.0, 1.0)) == (e.s in (0.0, 1.0))
            and (self.signs[k], self.braking[k]) == (before.signs[row], before.braking[row])
        ]
        away, k = min(found, default=(np.inf, 0))
        return k if away <= MOVED else None


def excesses(
    problem: Problem, total: float, joint: Indices, order: Indices, side: Array, value: Array
) -> tuple[Array, Array, Array]:
    """Excess of values (rad/sᵒʳᵈᵉʳ) over the limits to one side, as in `ExactRows`.

    Side 1 is the upper one, −1 the lower; the total of the motion is in s. Beside the excess:

    - the share of the limit; of others than derivatives with a limit above 0, 1 and the excess, and
      −inf if a joint stands still beside a side of 0;
    - what a small change of a value is divided by to be one of the excess.
    """
    limits, r, beyond = problem.limits, np.maximum(order, 1), side * value
    position, upper = order == 0, side > 0
    edge = np.where(upper, limits.position_upper[joint], -limits.position_lower[joint])
    below, above = limits.sides[:, joint, r - 1]
    limit, other = np.where(upper, above, below), np.where(upper, below, above)
    span = np.ptp(problem.waypoints, axis=0)[joint]
    rate = span / total**order
    with np.errstate(divide="ignore", invalid="ignore"):
        share = beyond / limit
        logs = np.where(share > NEAR, np.log(share), share - 1.0) / r
        rates = beyond / rate + np.where(other > 0.0, INSIDE, 0.0)
    still = (span == 0.0) | (np.abs(value) <= STILL * rate)
    nothing, span = ~position & (limit == 0.0), np.where(span > 0.0, span, 1.0)
    excess = np.where(nothing, np.where(still, 0.0, rates), logs)
    excess = np.where(position, (beyond - edge) / span, excess)
    size = np.where(position, span, np.where(nothing, rate, r * np.abs(value)))
    share = np.where(nothing | position, 1.0 + excess, share)
    return excess, np.where(nothing & still, -np.inf, share), size


def near_limits(
    problem: Problem, trajectory: Trajectory, near: float
) -> tuple[Places, Array, Array, Array, Array]:
    """Extrema above a share of their limit, as the shares of `excesses`: 0 for all on its side.

    Their places, then values (rad/sᵒʳᵈᵉʳ), sides, excesses and sizes, the last two as in
    `excesses`.
    """
    curve, limits, apart = problem.curve, problem.limits, problem.limits.braking
    inner = range(1, trajectory.durations.size)
    smooth = np.array([curve.smooth_order(b) for b in inner], dtype=np.int64)
    degrees = np.array(trajectory.degrees)
    every_break = len(curve.waypoint_breaks) == curve.segments + 1
    found = [np.zeros((5, 0))]
    for r in (*range(1, 1 + limits.sides.shape[2]), 0):
        low, high = (
            limits.sides[..., r - 1] if r else (-limits.position_lower, limits.position_upper)
        )
        wanted = (np.isfinite(low) | np.isfinite(high)) & ~(apart & (r == 2))
        if not wanted.any():
            continue
        places, values = trajectory.turns(r)
        there = ~np.isnan(places) & wanted
        there[0, 1:] &= (smooth < r)[:, None]  # the same one ends the piece before
        if trajectory.polynomial_in_time:
            there[-1] &= (degrees > r)[:, None]  # a constant is met at the left end
        if r == 0 and every_break:
            there[[0, -1]] = False  # way-points
        j, k, i = np.nonzero(there.transpose(2, 1, 0))
        found.append(np.array([j, k, np.full(i.size, r), places[i, k, j], values[i, k, j]]))
    whole = np.repeat(np.hstack(found), 2, axis=1)
    joint, piece, order = whole[:3].astype(np.int64)
    side = np.tile([1.0, -1.0], joint.size // 2)
    excess, share, size = excesses(problem, trajectory.total_time, joint, order, side, whole[4])
    at = np.flatnonzero(share > near)
    where = Places(joint[at], piece[at], order[at], whole[3, at])
    return where, whole[4, at], side[at], excess[at], size[at]


def exact_rows(problem: Problem, h: Array, nodal: Array | None = None) -> ExactRows:
    """Excesses near or above 0 and their gradients; one infinite excess where there is no curve.

    Durations are in s, shape (segments,); free derivatives have the shape (free, joints).
    """
    free = 0 if nodal is None else nodal.size
    try:
        trajectory = fit(problem.curve, problem.waypoints, h, nodal)
        at, value, side, excess, size = near_limits(problem, trajectory, NEAR)
        parts = SidedPeaks.of(problem, trajectory, NEAR)
        points = extrema_at(trajectory, at, value) + parts.points(trajectory)
        side = np.append(side, np.sign(parts.value))
        excess = np.append(excess, np.log(parts.ratio) / 2.0)
        size = np.append(size, 2.0 * np.abs(parts.value))
        slope = np.zeros((0, h.size + free))
        if points:
            found = peak_gradients(problem, h, points, nodal)
            slope = found.durations * h
            if parts.turning.any():
                moved = parts.moved(problem, h, trajectory, nodal)
                slope[len(at.s) :][parts.turning] -= moved * h
            if free:
                slope = np.hstack([slope, _by_nodal(problem, points, found.nodal)])
    except CurveError:
        nothing, none = np.zeros((1, h.size + free)), np.zeros(1, dtype=bool)
        return ExactRows(h, np.array([np.inf]), nothing, (), np.ones(1), none, none)
    own = side[: len(at.s)]
    limit = problem.limits.sides[(own > 0).astype(int), at.joint, np.maximum(at.order, 1) - 1]
    stretched = np.append((at.order > 0) & (limit > 0.0), np.ones(parts.ratio.size, dtype=bool))
    braking = np.append(np.zeros(len(at.s), dtype=bool), parts.braking)
    slope = slope * (side / size)[:, None]
    return ExactRows(h, excess, slope, tuple(points), side, stretched, braking)


def _by_nodal(problem: Problem, points: list[Extremum], slope: Array) -> Array:
    """Gradients by the free derivatives of all joints, (points, free · joints), in their limits."""
    own = np.eye(len(problem.joints))[[e.joint for e in points]]
    units, widest = np.ones((MAX_COEFFICIENTS, len(problem.joints))), problem.limits.widest.T
    units[1 : 1 + len(widest)] = np.where(np.isfinite(widest), widest, 1.0)
    orders = [order for _, order in problem.piecewise.free_derivatives]
    return np.asarray(slope[:, :, None] * own[:, None] * units[orders]).reshape(len(points), -1)
