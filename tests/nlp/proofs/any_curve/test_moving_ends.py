"""Bounds over any curve beside dense grids, and where joints start or finish in motion."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from support.any_curve_proofs import certify_any, interval, proved, random_problem, verified
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.document import certificate, stated_problem
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import Array, Limits, Problem, TrajgapError, cubic_spline, parse_case

WAY = np.array([[0.25, -0.5], [1.25, -1.0], [0.5, -0.25]])
V, A = np.array([1.5, 1.25]), np.array([4.0, 2.5])
START, FINISH = (1.0, -0.25), (0.0, 0.75)


def problem_with(start: tuple[float, ...] = START, finish: tuple[float, ...] = FINISH) -> Problem:
    curve = cubic_spline(2, ((1, start),), ((1, finish),))
    return Problem(WAY, Limits(V, A), curve, joints=("a", "b"))


@cache
def found() -> Certified:
    return certify_any(exact_problem(problem_with()), gap=1e-5, seconds=60)


def within(d: float, h: Array, v0: Any, v1: Any, top: float, bend: float) -> Any:
    """Whether a way is gone in time h, from the area below the fastest velocities there are."""

    def furthest(b: Any, e: Any) -> Array:
        peak = (bend * h + b + e) / 2
        cut = np.maximum(peak - top, 0.0)
        return (2 * peak**2 - b**2 - e**2) / (2 * bend) - cut**2 / bend

    room = np.abs(v1 - v0) <= bend * h
    return room & (d <= furthest(v0, v1)) & (-d <= furthest(-v0, -v1))


def best_of_a_grid(problem: Problem, near: Array) -> float:
    """Least total over durations and speeds half-way: each joint separately."""
    h = near * np.linspace(0.4, 2.5, 231)[:, None]
    at_ends = problem.piecewise.ends
    speeds = [np.broadcast_to(dict(one)[1], len(problem.joints)) for one in at_ends]
    good = np.ones((len(h), len(h)), dtype=bool)
    for j, (v, a) in enumerate(zip(*problem.limits.derivatives.T[:2], strict=True)):
        d, held = np.diff(problem.waypoints[:, j]), np.zeros_like(good)
        for speed in np.linspace(-v, v, 601):
            one = within(d[0], h[:, 0], speeds[0][j], speed, v, a)
            two = within(d[1], h[:, 1], speed, speeds[1][j], v, a)
            held |= one[:, None] & two[None, :]
        good &= held
    return float((h[:, 0, None] + h[:, 1])[good].min())


def test_a_dense_grid_of_durations_and_speeds_agrees() -> None:
    result, near = found(), estimate_any_curve(problem_with()).durations
    proved(result)
    assert result.outcome is Outcome.CERTIFIED
    best = best_of_a_grid(problem_with(), near)
    assert float(result.lower) <= best <= 1.03 * float(result.upper or 0)
    # Bringing both to rest, or exchanging the joints' ends, is another question.
    for start, finish in (((0.0, 0.0), (0.0, 0.0)), (START[::-1], FINISH[::-1])):
        other = best_of_a_grid(problem_with(start, finish), near)
        assert abs(other / best - 1) > 0.02


@pytest.mark.parametrize("seed", range(5))
def test_a_dense_grid_from_rest_to_rest_agrees(seed: int) -> None:
    problem = random_problem(np.random.default_rng(seed), 2, 1 + seed % 3)
    low, high = interval(problem)
    seen = estimate_any_curve(problem)
    assert low <= verified(problem, seen) <= high * (1 + 1e-9)
    assert low <= best_of_a_grid(problem, seen.durations) <= 1.03 * high


def test_a_bound_within_the_larger_sides_keeps_the_ends() -> None:
    uneven = Limits([[-1.5, 1.0], [-1.25, 1.25]], A)
    problem = Problem(WAY, uneven, problem_with().curve)
    result = certify_any(problem, gap=1e-5, seconds=60)
    proved(result)
    assert result.upper is None
    assert float(result.lower) == pytest.approx(float(found().lower), rel=3e-5)


def test_an_estimate_knows_the_ends_of_each_joint() -> None:
    seen = estimate_any_curve(problem_with())
    assert seen.total_time == pytest.approx(float(found().upper or 0), rel=1e-5)
    np.testing.assert_allclose(seen.nodal_velocities[[0, -1]], [START, FINISH])
    fast = estimate_any_curve(problem_with(start=(0.0, 1.3)))
    assert fast.why == "the velocity prescribed at the start exceeds the limit of joint b"


CASE = """
format = 1
id = "moving"
title = "Moving"
source = { year = 2020 }
robot = { name = "arm", joints = ["a", "b"] }
units = { position = "deg", velocity = "deg/s", acceleration = "deg/s^2", time = "s" }
waypoints = { joint_rows = [["0", "30", "10"], ["5", "-4", "8"]] }
limits = { velocity = [60, 55], acceleration = [200, 150] }
interpolant = { family = "cubic-spline", end_derivatives = [[12.1, -7]], finish_derivatives = [0] }
"""


def test_printed_ends_are_exact_in_the_unit_of_the_way_points() -> None:
    statement = parse_case(CASE, "moving.toml").statement()
    exact = printed_problem(statement)
    ends = [[str(v) for v in side] for side in stated_problem(exact).ends]
    assert ends == [["121/10", "-7"], ["0", "0"]]
    assert [str(v) for v in stated_problem(exact.joint(1)).ends[0]] == ["-7"]
    result = certify_any(exact, gap=1e-4, seconds=30)
    proved(result)
    # The same in radians, from floats.
    other = certify_any(statement.problem(), gap=1e-4, seconds=30)
    assert float(other.lower) == pytest.approx(float(result.lower), rel=3e-4)
    assert certificate(result)["problem"]["prescribed"][0] == [[1, ["12.1", "-7"]]]


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (("12.1", '"12.1"'), "stands for an interval"),
        (('velocity = "deg/s"', 'velocity = "rad/s"'), "another unit of angle"),
    ],
)
def test_ends_that_no_certificate_states_exactly(change: tuple[str, str], why: str) -> None:
    statement = parse_case(CASE.replace(*change), "moving.toml").statement()
    with pytest.raises(TrajgapError, match=why):
        printed_problem(statement)
