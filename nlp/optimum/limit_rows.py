"""Limits at the true extrema of a motion: how far each is kept, and how that changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, CurveError, Extremum, Problem, extrema, fit, peak_gradients

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
    """Limits to first order about one duration vector, in log durations.

    A stretch by c divides v, a, j by c, c², c³, so a derivative's excess is log(|value|/limit)/r:
    its gradient is −1 along a stretch, whatever the order and the units. A position's excess is
    counted in spans of the joint's way-points; that of a derivative whose side is 0, in shares of
    the joint's mean rate.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    excess : ndarray, shape (rows,)
        Above 0 the limit is exceeded.
    gradient : ndarray, shape (rows, segments)
        d excess / d log duration.
    points : tuple of Extremum
    signs : ndarray, shape (rows,)
        Which side of its range a value is at.
    stretched : ndarray of bool, shape (rows,)
        Whether a stretch of all durations repairs the excess.
    """

    durations: Array
    excess: Array
    gradient: Array
    points: tuple[Extremum, ...]
    signs: Array
    stretched: NDArray[np.bool_]

    @property
    def worst(self) -> float:
        """The largest excess."""
        return float(self.excess.max(initial=-np.inf))

    def twin(self, e: Extremum, sign: float) -> int | None:
        """The row whose extremum continues one of another motion: the nearest of its segment."""
        found = [
            (abs(other.s - e.s), k)
            for k, other in enumerate(self.points)
            if (other.joint, other.order, other.segment) == (e.joint, e.order, e.segment)
            and (other.s in (0.0, 1.0)) == (e.s in (0.0, 1.0))
            and self.signs[k] == sign
        ]
        away, k = min(found, default=(np.inf, 0))
        return k if away <= MOVED else None


@dataclass(frozen=True)
class Near:
    """An extremum near its limit."""

    extremum: Extremum
    limit: float
    sign: float
    excess: float
    size: float
    """What a change of the value is set beside, so that it is a change of the excess."""
    stretched: bool
    """Whether a stretch of all durations repairs it."""


def limited(problem: Problem, h: Array, nodal: Array | None = None) -> list[Near]:
    """Extrema near a limit.

    Parameters
    ----------
    problem : Problem
    h : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), optional
    """
    curve, limits, sizes = problem.curve, problem.limits, problem.limits.sides
    trajectory = fit(curve, problem.waypoints, h, nodal)
    every_break = len(curve.waypoint_breaks) == curve.segments + 1
    span = np.ptp(problem.waypoints, axis=0)
    found: list[Near] = []
    for j in range(len(problem.joints)):
        for r in (1, 2, 3):
            if not np.isfinite(sizes[:, j, r - 1]).any():
                continue
            for e in extrema(trajectory, j, r):
                repeated = e.s == 0.0 and e.segment > 0 and curve.smooth_order(e.segment) >= r
                if repeated:
                    continue
                found += _beyond_nothing(e, sizes[:, j, r - 1], float(span[j]) / h.sum() ** r)
                limit = float(sizes[int(e.value > 0.0), j, r - 1])
                if not np.isfinite(limit) or limit == 0.0:
                    continue
                size = abs(e.value) / limit
                if size > NEAR:
                    excess = float(np.log(size)) / r
                    sign, size = float(np.sign(e.value)), r * abs(e.value)
                    found.append(Near(e, limit, sign, excess, size, True))
        sides = ((float(limits.position_lower[j]), -1.0), (float(limits.position_upper[j]), 1.0))
        if not any(np.isfinite(limit) for limit, _ in sides):
            continue
        size = float(span[j]) or 1.0
        for e in extrema(trajectory, j, 0):
            if e.s in (0.0, 1.0) and every_break:
                continue
            for limit, sign in sides:
                excess = sign * (e.value - limit) / size
                if np.isfinite(limit) and excess > NEAR - 1.0:
                    found.append(Near(e, limit, sign, excess, size, False))
    return found


def _beyond_nothing(e: Extremum, sides: Array, rate: float) -> Iterator[Near]:
    """The extremum of a derivative that must not leave 0 to one side, in shares of a mean rate.

    Parameters
    ----------
    e : Extremum
    sides : ndarray, shape (2,)
        Sizes of the limits below and above 0.
    rate : float
        What the derivative's excess is set beside: way over time to its order; 0 of a joint that
        stands still.
    """
    if rate == 0.0 or abs(e.value) <= STILL * rate:
        return
    for side, sign in ((0, -1.0), (1, 1.0)):
        excess = sign * e.value / rate + (INSIDE if sides[1 - side] > 0.0 else 0.0)
        if sides[side] == 0.0 and excess > NEAR - 1.0:
            yield Near(e, 0.0, sign, excess, rate, False)


def exact_rows(problem: Problem, h: Array) -> ExactRows:
    """Excesses and gradients at ``h``; one infinite excess if ``h`` defines no curve.

    Parameters
    ----------
    problem : Problem
        With a determined curve.
    h : ndarray, shape (segments,)
        s.

    Returns
    -------
    ExactRows
    """
    try:
        found = limited(problem, h)
        points = [near.extremum for near in found]
        slope = np.zeros((0, h.size))
        if points:
            slope = peak_gradients(problem, h, points).durations * h
    except CurveError:
        nothing = np.zeros((1, h.size))
        none = np.zeros(1, dtype=bool)
        return ExactRows(h, np.array([np.inf]), nothing, (), np.ones(1), none)
    signs = np.array([near.sign for near in found])
    excess = np.array([near.excess for near in found])
    scale = signs / np.array([near.size for near in found])
    stretched = np.array([near.stretched for near in found], dtype=bool)
    return ExactRows(h, excess, slope * scale[:, None], tuple(points), signs, stretched)
