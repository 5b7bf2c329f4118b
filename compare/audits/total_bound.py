"""A proof that no motion within the limits takes so little time."""

from __future__ import annotations

import numpy as np

from ...nlp.enclosure import Ball, bound_ratio
from ...problem import TOLERANCE, Array, Problem
from .rounding import FEW_ROUNDINGS, RoundingBox

BOXES = 1000
"""Boxes of durations that are examined, each in milliseconds: a few seconds at most, and the result
does not depend on the machine."""


def excludes_total(
    problem: Problem, total: float, waypoints: RoundingBox | None = None, boxes: int = BOXES
) -> bool | None:
    """Prove that no durations of a total or less keep the limits, for all way-points of a box.

    It is True if that is proved, False if nothing is said, None if it would take more boxes.

    Parameters
    ----------
    problem : Problem
        With its limits and bounds on durations where they allow most.
    total : float
        s.
    waypoints : RoundingBox, shape (way-points, joints), optional
        rad; those of the problem, exactly, by default.
    boxes : int
        Largest number of boxes of durations that are examined.

    Notes
    -----
    Branch and bound over the durations: the mean speed between way-points bounds each of them
    from below, and each box either holds no durations so short or has a worst ratio above 1,
    proved as for `breaks`.
    """
    q = RoundingBox.exact(problem.waypoints) if waypoints is None else waypoints
    ball = Ball.between(q.lower, q.upper)
    target = 1.0 + TOLERANCE
    low = _least_durations(problem, q) / target * (1.0 - FEW_ROUNDINGS)
    low = np.maximum(low, problem.duration_lower / target * (1.0 - FEW_ROUNDINGS))
    total *= 1.0 + FEW_ROUNDINGS
    if low.sum() > total:
        return True
    # Where coefficients are free, durations alone have no ratios to bound.
    # 8: segments above which splitting boxes of durations cannot come to an end in time.
    if problem.curve.free or not (low > 0.0).all() or problem.segments > 8:
        return False
    todo = [(low, np.minimum(total - (low.sum() - low), problem.duration_upper * target))]
    looked = 0
    while todo:
        looked += 1
        if looked > boxes:
            return None
        least, most = todo.pop()
        # No duration is longer than what the total leaves beside the least of all others.
        most = np.minimum(most, total - (least.sum() - least))
        if (most < least).any():
            continue
        bound = bound_ratio(problem, least, most, ball)
        if bound.value > target:
            continue
        widths = most / least
        k = int(np.argmax(widths))
        if widths[k] <= 1.0 + 1e-6:
            return False
        cut = float(np.sqrt(least[k] * most[k]))
        for side in (0, 1):
            lower, upper = least.copy(), most.copy()
            (upper if side == 0 else lower)[k] = cut
            todo.append((lower, upper))
    return True


def _least_durations(problem: Problem, waypoints: RoundingBox) -> Array:
    """Durations below which the mean speed between two way-points exceeds a velocity limit."""
    least = np.zeros(problem.segments)
    breaks = problem.curve.waypoint_breaks
    most = problem.limits.widest[:, 0]
    speed = np.where(most > 0.0, most, np.inf)
    for w, ways in enumerate(waypoints.steps[0]):
        if breaks[w + 1] - breaks[w] == 1:
            least[breaks[w]] = float((ways / speed).max())
    return least
