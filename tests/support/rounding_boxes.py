"""Problems with rounded inputs, and what sampling of their boxes says of a verdict."""

from dataclasses import replace

import numpy as np
from trajgap.compare.audits.rounding import Place, Point, RoundingBox, RoundingVerdict
from trajgap.compare.documents import Rounding
from trajgap.problem import Interpolant, Limits, Problem, Verdict, check, evaluate, piecewise

MOVING_ENDS = piecewise((4, 3, 4), 2, ((1, 0.3), (2, -0.7)))


def rounded_problem(
    seed: int, interpolant: Interpolant, joints: int = 2
) -> tuple[Problem, np.ndarray]:
    """Shifted, unequal data under velocity, acceleration and, for C4, jerk limits."""
    rng = np.random.default_rng(seed)
    count = len(interpolant.waypoint_breaks)
    waypoints = np.round(0.7 + rng.normal(size=(count, joints)), 4)
    durations = np.round(rng.uniform(0.4, 1.3, interpolant.segments), 3)
    jerk = rng.uniform(80.0, 200.0, joints) if interpolant.continuity[0] > 2 else np.inf
    limits = Limits(rng.uniform(2.0, 4.0, joints), rng.uniform(8.0, 20.0, joints), jerk)
    return Problem(waypoints, limits, interpolant), durations


def boxes(durations: np.ndarray, half: float, waypoints: np.ndarray, angle: float):
    return (
        RoundingBox(durations, durations - half, durations + half),
        RoundingBox(waypoints, waypoints - angle, waypoints + angle),
    )


def sampled_worst(
    problem: Problem, h: RoundingBox, q: RoundingBox, rng, groups: int = 12, each: int = 50
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
        found = evaluate(there, durations)
        worst.append(np.maximum(found.ratios.max(axis=(1, 2)), found.positions.max(axis=1)))
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
