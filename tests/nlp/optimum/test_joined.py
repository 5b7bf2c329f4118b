"""Motions that are smooth for some ratios of durations only: the closed form, and its proofs."""

from __future__ import annotations

import numpy as np
import pytest
from trajgap.nlp import Status, solve
from trajgap.nlp.optimum.joined import joined
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    piecewise,
    rest_to_rest,
)

TURNING = Problem(
    np.array([[1302.26], [52.133], [58.6694]]),
    Limits(4118.4, joints=1),
    piecewise((1, 1), 0, ()),
    [0.2874992984580243, 0.604646646043441],
    [0.3042336391316181, 0.659779283964719],
)
"""Straight there and back: the velocity changes its sign at the way-point."""
UNEQUAL = Problem(
    np.array([[0.0944701], [-0.0249676], [0.299409]]),
    Limits(jerk=6.04733, joints=1),
    rest_to_rest(2, 3),
    [1.4611078233479549, 1.016999735848937],
    [1.7035952883424936, 1.0914763609431977],
)
"""The acceleration agrees where h₂/h₁ = √(0.324/0.119), which the bounds exclude."""


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (TURNING, "the velocity of joint 1 jumps at way-point 1, whatever the durations"),
        (UNEQUAL, "without a jump of acceleration of joint 1 segment 2 takes at least 2.40788 s"),
    ],
)
def test_a_jump_that_no_durations_avoid_is_a_proof(problem: Problem, reason: str) -> None:
    solution = solve(problem)
    assert solution.status is Status.INFEASIBLE
    assert reason in str(solution.why)
    # A second route: of a grid over the bounds every motion jumps, though many keep the limits.
    sides = np.linspace(problem.duration_lower, problem.duration_upper, 7).T
    grid = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    verdicts = [check(problem, h) for h in grid]
    assert all(one.verdict is not Verdict.PASS for one in verdicts)
    assert any(one.limits is Verdict.PASS for one in verdicts)
    way = np.abs(np.diff(problem.waypoints[:, 0]))
    if problem is UNEQUAL:
        least = problem.duration_lower[0] * np.sqrt(way[1] / way[0])
        assert least == pytest.approx(2.40788, rel=1e-5)


def test_a_still_segment_beside_a_moving_one_jumps() -> None:
    problem = Problem(np.array([[0.2], [0.2], [1.0]]), Limits(1.0, 2.0, 3.0), rest_to_rest(2, 3))
    assert (
        joined(problem)
        == "the acceleration of joint 1 jumps at way-point 1, whatever the durations"
    )
    two = Problem(
        np.array([[0.2, 1.0], [0.5, 1.4], [1.0, 1.7]]),
        Limits(1.0, joints=2),
        piecewise((1, 1), 0, ()),
    )
    assert "the velocity of joint 2 jumps at way-point 1" in str(joined(two))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("curve", "power"), [(piecewise((1, 1, 1), 0, ()), 1.0), (rest_to_rest(3, 3), 0.5)]
)
def test_the_least_durations_without_a_jump_are_proportional_to_the_way(
    curve: Interpolant, power: float, seed: int
) -> None:
    """h ∝ |Δq| keeps the velocity of straight segments, h ∝ √|Δq| the acceleration of cubics."""
    generator = np.random.default_rng(seed)
    way = generator.uniform(0.2, 2.0, 3)
    sign = 1.0 if power == 1.0 else -1.0
    q = 0.7 + np.concatenate([[0.0], np.cumsum(way * sign ** np.arange(3))])
    limits = Limits(1.3, joints=1) if power == 1.0 else Limits(1.3, 2.0, 5.0, joints=1)
    lower = generator.uniform(0.0, 1.0, 3)
    problem = Problem(q, limits, curve, lower)
    h = way**power
    tight = h * check(problem, h / h.min()).stretch / h.min()
    expected = tight * max(1.0, (lower / tight).max())
    solution = solve(problem)
    assert solution.status is Status.CONVERGED
    assert check(problem, solution.durations).verdict is Verdict.PASS
    assert solution.durations == pytest.approx(expected, rel=1e-8)


def test_curves_without_such_ratios_are_left_to_the_search() -> None:
    q = np.array([[0.0], [1.0], [0.4]])
    assert joined(Problem(q, Limits(1.0, 2.0, joints=1), rest_to_rest(2, 3))) is None
    assert joined(Problem(q, Limits(1.0, 2.0, 9.0, joints=1), rest_to_rest(2, 5))) is None
    assert joined(Problem(q, Limits(1.0, 2.0, 9.0, joints=1), cubic_spline(2))) is None
