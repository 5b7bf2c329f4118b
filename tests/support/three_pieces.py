"""Small problems of three pieces, and a dense search for their least total."""

import numpy as np
from trajgap.problem import Limits, Problem, Verdict, check, evaluate, fit, three_five_three


def random_problem(seed: int) -> Problem:
    """Small 3-5-3 problem with unequal joints; every kind of limit and bound turns up."""
    rng = np.random.default_rng(seed)
    joints = int(rng.integers(1, 4))
    q = rng.normal(0.3, 1.0, (4, joints))
    scale = rng.uniform(0.3, 3.0, (3, joints))
    some = rng.random(3) < 0.6
    some[rng.integers(0, 3)] = True
    v, a, j = (scale[i] if some[i] else np.full(joints, np.inf) for i in range(3))
    low = np.full(joints, -np.inf)
    if rng.random() < 0.25:
        low = q.min(axis=0) - rng.uniform(0.05, 0.4)
    lower = rng.uniform(0.1, 1.5, 3) if rng.random() < 0.4 else 0.0
    upper = rng.uniform(4.0, 9.0, 3) if rng.random() < 0.3 else np.inf
    return Problem(
        q, Limits(v, a, j, low, np.full(joints, np.inf)), three_five_three(), lower, upper
    )


def dense_best(problem: Problem, count: int = 161) -> float:
    """Smallest total over a grid of directions, each stretched as little as it may be."""
    count = min(count, 41) if problem.limits.limits_position else count
    side = (np.arange(count) + 0.5) / count
    a, b = (g.ravel() for g in np.meshgrid(side, side))
    shares = np.stack([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)], axis=1)
    with np.errstate(divide="ignore"):
        stretch = np.maximum(
            evaluate(problem, shares).stretch, (problem.duration_lower / shares).max(axis=1)
        )
    totals = stretch * shares.sum(axis=1)
    totals[(shares * stretch[:, None] > problem.duration_upper).any(axis=1)] = np.inf
    if not problem.limits.limits_position:
        return float(totals.min())
    for i in np.argsort(totals):
        if not np.isfinite(totals[i]):
            break
        h = shares[i] * stretch[i]
        curve = fit(problem.curve, problem.waypoints, h)
        angle = np.stack([curve(x) for x in np.linspace(0.0, h.sum(), 60)])
        inside = (angle >= problem.limits.position_lower).all()
        if inside and check(problem, h).verdict is Verdict.PASS:
            return float(totals[i])
    return np.inf
