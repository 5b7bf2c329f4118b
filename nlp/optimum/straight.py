"""Straight motions at constant speed: without limits on velocity they take no time at all.

Durations in proportion to the way let every joint move linearly in time, if the way-points lie on a
line in one direction and no end of the curve prescribes a velocity. Acceleration and jerk are 0
for every total: the infimum is 0.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np

from ...problem import Array, Problem, check
from .decided import kept
from .starts import equal_start

HALVINGS = 60
"""Times that the total is halved while `check` still sees that nothing exceeds its limit."""


def straight_durations(problem: Problem) -> Array | None:
    """Durations in proportion to the way, s, if a total of any length keeps every limit; or None.

    The decision is exact. Joints that nothing limits but their position are left out, and so is a
    problem with a positive lower bound on a duration.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    ndarray, shape (segments,), or None
        The shortest halving that the checker passes.
    """
    curve = problem.curve.piecewise
    if curve is None or curve.free or curve.virtual or problem.duration_lower.any():
        return None
    given = [entry for b in range(curve.segments + 1) for entry in curve.prescribed_at(b)]
    if any(order < 2 or value != 0.0 for order, value in given):
        return None
    moving = np.ptp(problem.waypoints, axis=0) > 0
    limited = problem.limits.limited
    bound = limited.any(axis=1)
    if (moving & limited[:, 0]).any() or not (moving & bound).any():
        return None
    ways = [
        [Fraction(float(b)) - Fraction(float(a)) for a, b in pairwise(q)]
        for q in problem.waypoints.T[moving & bound]
    ]
    first = ways[0]
    forth = all(way * first[0] > 0 for way in first)
    if not forth or any(w[k] * first[0] != w[0] * first[k] for w in ways for k in range(len(w))):
        return None
    share = np.array([float(way / sum(first)) for way in first])
    return _shortest(problem, share)


def _shortest(problem: Problem, share: Array) -> Array | None:
    """The shortest total that the checker passes, by halving; None if it passes none."""
    with np.errstate(divide="ignore"):
        room = float((problem.duration_upper / share).min())
    total, best = min(float(equal_start(problem).sum()), room), None
    for _ in range(HALVINGS):
        if not kept(problem, check(problem, total * share)):
            break
        best, total = total * share, 0.5 * total
    return best
