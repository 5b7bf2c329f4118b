"""Intervals of curves in motion where derivatives are prescribed, and of joints that come back."""

from __future__ import annotations

import numpy as np
import pytest
from support.intervals import dense_best, judged
from trajgap.nlp.proofs.certifiers import certify, covered
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
)

DEGREES = ((3, 5, 3), (4, 3, 4), (5,), (5, 5), (3, 3, 3, 3))


def in_motion(seed: int) -> Problem:
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


def attack(seed: int) -> Outcome | None:
    problem = in_motion(seed)
    exact = exact_problem(problem)
    if covered(exact) is not None:
        return None
    found = certify(exact, gap=1e-3, seconds=1e4, boxes=20_000)
    return judged(problem, found, dense_best(problem))


@pytest.mark.parametrize("seed", [0, 2, 3, 4])
def test_random_durations_never_leave_the_interval(seed: int) -> None:
    assert attack(seed) is not None


@pytest.mark.slow
def test_random_durations_never_leave_the_interval_of_two_hundred_problems() -> None:
    outcomes = [attack(seed) for seed in (1, *range(5, 205))]
    assert outcomes.count(Outcome.CERTIFIED) + outcomes.count(Outcome.INFEASIBLE) >= 120
    assert outcomes.count(None) < 20
