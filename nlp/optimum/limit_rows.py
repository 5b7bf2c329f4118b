"""The limits at one duration vector: excess of every true extremum, and its gradient."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...problem import Array, CurveError, Extremum, Problem, extrema, fit, peak_gradients

NEAR = 0.3
"""Extrema below this share of their limit are left out: no step of a trust region reaches it."""


@dataclass(frozen=True, eq=False)
class ExactRows:
    """Limits to first order about one duration vector, in log durations.

    A stretch by c divides v, a, j by c, c², c³, so a derivative's excess is log(|value|/limit)/r:
    its gradient is −1 along a stretch, whatever the order and the units. A position's excess is
    counted in spans of the joint's way-points.

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
    """

    durations: Array
    excess: Array
    gradient: Array
    points: tuple[Extremum, ...]
    signs: Array

    @property
    def worst(self) -> float:
        """The largest excess."""
        return float(self.excess.max(initial=-np.inf))


def _limited(problem: Problem, h: Array) -> list[tuple[Extremum, float, float]]:
    """Extrema near a limit, with the side and the excess."""
    curve, limits, sizes = problem.curve, problem.limits, problem.limits.sides
    trajectory = fit(curve, problem.waypoints, h)
    every_break = len(curve.waypoint_breaks) == curve.segments + 1
    span = np.ptp(problem.waypoints, axis=0)
    found: list[tuple[Extremum, float, float]] = []
    for j in range(len(problem.joints)):
        for r in (1, 2, 3):
            if not np.isfinite(sizes[:, j, r - 1]).any():
                continue
            for e in extrema(trajectory, j, r):
                limit = float(sizes[int(e.value > 0.0), j, r - 1])
                if not np.isfinite(limit) or limit == 0.0:
                    continue
                size = abs(e.value) / limit
                repeated = e.s == 0.0 and e.segment > 0 and curve.smooth_order(e.segment) >= r
                if size > NEAR and not repeated:
                    found.append((e, float(np.sign(e.value)), float(np.log(size)) / r))
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
                    found.append((e, sign, excess))
    return found


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
        found = _limited(problem, h)
    except CurveError:
        nothing = np.zeros((1, h.size))
        return ExactRows(h, np.array([np.inf]), nothing, (), np.ones(1))
    points = [e for e, _, _ in found]
    signs = np.array([sign for _, sign, _ in found])
    excess = np.array([value for _, _, value in found])
    slope = peak_gradients(problem, h, points).durations * h if points else np.zeros((0, h.size))
    span = np.ptp(problem.waypoints, axis=0)
    sizes = [e.order * abs(e.value) if e.order else float(span[e.joint]) or 1.0 for e in points]
    scale = signs / np.array(sizes)
    return ExactRows(h, excess, slope * scale[:, None], tuple(points), signs)
