"""Small problems of three pieces."""

import numpy as np
from trajgap.problem import Limits, Problem, three_five_three


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
