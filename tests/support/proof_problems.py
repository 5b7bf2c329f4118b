"""Random problems of a few segments and joints, on which each kind of proof is tried."""

import numpy as np
from trajgap.problem import Interpolant, Limits, Problem, curves

NATURAL = ((2, 0.0),)
_WAY = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
QUINTIC = Problem(_WAY, Limits([1.0, 0.9], [2.0, 1.5]), curves.quintic_spline(3))


def _cubic_curve(rng: np.random.Generator) -> Interpolant:
    kind = int(rng.integers(0, 4))
    if kind == 3:
        return curves.cubic_spline_virtual(3)
    count = int(rng.integers(2, 4))
    curve = curves.cubic_spline(count, NATURAL if kind == 1 else ((1, 0.0),))
    if kind < 2:
        return curve
    ends = (curve.prescribed[0], *curve.prescribed[1:-1], NATURAL)
    return Interpolant(curve.degrees, curve.continuity, ends, name="clamped, then natural")


def random_cubic(seed: int) -> Problem:
    """Small problem with unequal joints; every kind of limit, bound and end turns up."""
    rng = np.random.default_rng(seed)
    curve, joints = _cubic_curve(rng), int(rng.integers(1, 3))
    waypoints = curve.segments + 1 - len(curve.virtual)
    q = rng.normal(0.3, 1.0, (waypoints, joints))
    scale = rng.uniform(0.3, 3.0, (3, joints))
    some = rng.random(3) < 0.6
    some[0] |= not some.any() or curve.prescribed[0] == NATURAL
    v, a, j = (scale[i] if some[i] else np.full(joints, np.inf) for i in range(3))
    lower = rng.uniform(0.1, 1.0, curve.segments) if rng.random() < 0.4 else 0.0
    upper = rng.uniform(4.0, 9.0, curve.segments) if rng.random() < 0.3 else np.inf
    return Problem(q, Limits(v, a, j), curve, lower, upper)


def random_quintic(seed: int) -> Problem:
    """Few segments and joints; some limits absent, some durations bounded from below."""
    rng = np.random.default_rng(seed)
    n, joints = int(rng.integers(2, 4)), int(rng.integers(1, 3))
    v, a, j = np.exp(rng.uniform(-0.7, 0.7, (3, joints))) * np.array([[1.0], [2.0], [12.0]])
    j = np.where(rng.random(joints) < 0.7, np.inf, j)
    v = np.where(rng.random(joints) < 0.2, np.inf, v)
    shortest = np.where(rng.random(n) < 0.2, 0.8, 0.0)
    waypoints = rng.uniform(-1.5, 1.5, (n + 1, joints))
    return Problem(waypoints, Limits(v, a, j), curves.quintic_spline(n), shortest)


def random_declared(seed: int) -> Problem:
    """3-5-3 or 4-3-4: every kind of limit and bound, unequal sides among them."""
    rng, other = np.random.default_rng(seed), np.random.default_rng([seed, 5])
    joints = int(rng.integers(1, 4))
    q = rng.normal(0.3, 1.0, (4, joints))
    scale = rng.uniform(0.3, 3.0, (3, joints))
    some = rng.random(3) < 0.6
    some[rng.integers(0, 3)] = True
    high = np.where(some[:, None], scale, np.inf)
    bottom = q.min(axis=0) - rng.uniform(0.05, 0.4) if rng.random() < 0.25 else -np.inf
    lower = rng.uniform(0.1, 1.5, 3) if rng.random() < 0.4 else 0.0
    upper = rng.uniform(4.0, 9.0, 3) if rng.random() < 0.3 else np.inf
    low = -high if other.random() < 0.7 else -high * other.uniform(0.5, 1.5, high.shape)
    limits = Limits(*np.stack([low, high], axis=2), bottom, joints=joints)
    curve = (curves.three_five_three(), curves.piecewise((4, 3, 4)))[seed % 2]
    return Problem(q, limits, curve, lower, upper)


DEGREES = ((3, 5, 3), (4, 3, 4), (5,), (5, 5), (3, 3, 3, 3))


def random_in_motion(seed: int) -> Problem:
    """Unequal joints and ends; every kind of limit and bound turns up, unequal sides among them."""
    rng = np.random.default_rng([seed, 27])
    degrees = DEGREES[seed % len(DEGREES)]
    n, joints = len(degrees), int(rng.integers(1, 3))
    orders = (1,) if degrees[0] == 3 and n == 4 else (1, 2)
    scale = rng.uniform(0.5, 2.0, (3, joints)) * np.array([[1.0], [2.0], [9.0]])
    high = np.where(rng.random((3, 1)) < 0.7, scale, np.inf)
    high[rng.integers(0, 2)] = scale[0]
    low = -high * rng.uniform(0.8, 1.2, (3, joints)) if rng.random() < 0.3 else -high
    ends = [
        tuple((r, tuple(rng.uniform(-0.4, 0.4, joints) * (rng.random() < 0.8))) for r in orders)
        for _ in range(2)
    ]
    smooth = 4 if degrees == (5, 5) else 2
    curve = Interpolant(degrees, (smooth,) * (n - 1), (ends[0], *((),) * (n - 1), ends[1]))
    q = rng.normal(0.3, 1.0, (n + 1, joints))
    reach = (-np.inf, np.inf)
    if rng.random() < 0.4:
        reach = q.min(axis=0) - rng.uniform(0.05, 0.4), q.max(axis=0) + rng.uniform(0.05, 0.4)
    limits = Limits(*np.stack([low, high], axis=2), *np.broadcast_arrays(*reach, q[0])[:2])
    lower = rng.uniform(0.05, 0.5, n) if rng.random() < 0.4 else 0.0
    upper = rng.uniform(3.0, 6.0, n) if rng.random() < 0.3 else np.inf
    return Problem(q, limits, curve, lower, upper)


def cubic_problem() -> Problem:
    """Two joints and virtual way-points, every derivative limited."""
    q = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
    return Problem(q, Limits([1.1, 0.9], [1.9, 2.3], [7.0, 9.0]), curves.cubic_spline_virtual(3))
