"""Points of a box, sampled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from trajgap.compare.audits.rounding import (
    Place,
    Point,
    RoundingBox,
    RoundingVerdict,
)
from trajgap.compare.documents import Rounding
from trajgap.problem import (
    Problem,
    Verdict,
    check,
    evaluate,
)


def boxes(durations: np.ndarray, half: float, waypoints: np.ndarray, angle: float):
    return (
        RoundingBox(durations, durations - half, durations + half),
        RoundingBox(waypoints, waypoints - angle, waypoints + angle),
    )


def sampled_worst(
    problem: Problem, h: RoundingBox, q: RoundingBox, rng, groups: int = 40, each: int = 50
):
    """Worst ratios at random points of the box, a quarter of them at its corners."""
    worst = []
    low = np.maximum(h.lower, problem.duration_lower)
    high = np.minimum(h.upper, problem.duration_upper)
    for g in range(groups):
        share = rng.uniform(size=q.value.shape)
        share = np.round(share) if g % 4 == 0 else share
        angles = np.clip(q.lower + share * (q.upper - q.lower), q.lower, q.upper)
        there = replace(problem, waypoints=angles)
        share = rng.uniform(size=(each, h.value.size))
        share[::4] = np.round(share[::4])
        durations = np.clip(low + share * (high - low), low, high)
        worst.append(evaluate(there, durations).ratios.max(axis=(1, 2)))
    return np.concatenate(worst)


def contradiction(
    problem: Problem, h: RoundingBox, q: RoundingBox, verdict: RoundingVerdict, seed: int
) -> str | None:
    """What a verdict states that some point of the box contradicts."""
    worst = sampled_worst(problem, h, q, np.random.default_rng(seed))
    bound = verdict.lower_bound_of_worst
    if bound is not None and worst.min() < bound * (1.0 - 1e-12):
        return f"a point of the box has ratio {worst.min()}, below {bound}"
    if verdict.verdict is Rounding.BREAKS:
        if not isinstance(verdict.exhibit, Place) or bound is None or bound <= 1.0 + 1e-9:
            return "no proof is exhibited"
        return None if worst.min() > 1.0 + 1e-9 else "a point of the box keeps the limits"
    if verdict.verdict in (Rounding.KEEPS, Rounding.CONSISTENT):
        point = verdict.exhibit
        if not isinstance(point, Point):
            return "no point is exhibited"
        for box, at in ((h, point.durations), (q, point.waypoints)):
            if not ((box.lower <= at) & (at <= box.upper)).all():
                return "the exhibited point lies outside the box"
        there = replace(problem, waypoints=point.waypoints)
        if check(there, point.durations).verdict is not Verdict.PASS:
            return "the exhibited point does not pass"
    return None
