"""Determined curves that may jump: ratios of durations at which they happen not to.

Where a limit forbids a jump that the declaration allows and nothing is free, each jump is an
equation for the ratios of the durations. A uniform stretch keeps them: what is found is stretched
until it is tight.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from ...problem import Array, CurveError, Problem, check, fit
from .clock import time_up
from .decided import decided, kept
from .feasibility import apart

TRIES = 24
"""Random ratios from which the equations are solved: a problem with an answer has one or two, and
about every third start ends at one."""
STEPS = 40
"""Steps of one try: those that end at an answer need fewer, the others run into the bounds."""
LAST_BITS = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
"""Tolerances that leave rounding alone."""
SPREAD, WIDEST = 2.0, 6.0
"""Log ratios of the starts, and at most: a factor of 7, and of 400."""
MATCHED = 1e-10
"""Jump, relative to its terms, that counts as none: a tenth of what the checker grants."""
APART = 1e-6
"""Log ratios that lie further apart are other solutions."""


def matched(problem: Problem, seed: int) -> list[Array]:
    """Durations of motions that pass although their declaration lets them jump, shortest first.

    Parameters
    ----------
    problem : Problem
    seed : int

    Returns
    -------
    list of ndarray, shape (segments,)
        s. None found proves nothing.
    """
    curve, n = problem.curve.piecewise, problem.segments
    places = _places(problem)
    if curve is None or curve.free or apart(problem) or not curve.homogeneous or not places:
        return []

    def jumps(ratios: Array) -> Array:
        try:
            moved = fit(problem.curve, problem.waypoints, np.exp(np.append(0.0, ratios)))
        except CurveError:
            return np.ones(len(places))
        sides = [moved.sides(b, j, order) for b, j, order in places]
        return np.array([(right - left) / (scale or 1.0) for left, right, scale in sides])

    generator = np.random.default_rng(seed)
    ratios: list[Array] = []
    found: list[Array] = []
    for _ in range(TRIES):
        if time_up():
            break
        start = generator.uniform(-SPREAD, SPREAD, n - 1)
        end = least_squares(jumps, start, bounds=(-WIDEST, WIDEST), max_nfev=STEPS, **LAST_BITS)
        new = all(np.abs(end.x - other).max() > APART for other in ratios)
        if new and np.abs(end.fun).max() <= MATCHED:
            ratios.append(end.x)
            h = np.exp(np.append(0.0, end.x))
            h *= np.max(problem.duration_lower / h, initial=_stretch(problem, h))
            local = decided(problem, h)
            if local is not None and kept(problem, check(problem, local.durations)):
                found.append(local.durations)
    return sorted(found, key=lambda one: float(one.sum()))


def _stretch(problem: Problem, h: Array) -> float:
    return float(check(problem, h).stretch)


def _places(problem: Problem) -> list[tuple[int, int, int]]:
    """Break, joint and order of each jump that the declaration allows and the limits forbid."""
    curve = problem.curve.piecewise
    if curve is None:
        return []
    return [
        (b, j, order)
        for b in range(1, curve.segments)
        for j in range(len(problem.joints))
        for order in (1, 2)
        if order > curve.continuity[b - 1]
        and (order == 1 or np.isfinite(problem.limits.jerk[j]))
        and np.ptp(problem.waypoints[:, j]) > 0
    ]
