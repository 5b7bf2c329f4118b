"""Paths timed anew with limited jerk: closed forms, the motion itself, identities."""

import numpy as np
import pytest
from trajgap.nlp.retiming import jerk_limited_path, retime_third_order
from trajgap.problem import Limits, Problem, check, curves, fit


def timed(problem: Problem, durations: list[float], cells: int = 240) -> float:
    trajectory = fit(problem.curve, problem.waypoints, np.array(durations))
    assert jerk_limited_path(trajectory, problem.limits)
    time, count = retime_third_order(trajectory, problem.limits, cells)
    assert time is not None
    assert count == cells
    return time


@pytest.mark.parametrize(
    ("limits", "closed"),
    [
        # D/V + V/A + A/J with all three limits reached; 2 (sqrt of D/A and its jerk) without V.
        (Limits(1.2, 3.0, 20.0), 1.0 / 1.2 + 1.2 / 3.0 + 3.0 / 20.0),
        # Jerk alone: D = 2 J (T/4)³.
        (Limits(50.0, 50.0, 20.0), 4.0 * (1.0 / (2.0 * 20.0)) ** (1.0 / 3.0)),
    ],
)
def test_a_straight_line_takes_the_time_of_a_double_s(limits: Limits, closed: float) -> None:
    problem = Problem([[0.0], [1.0]], limits, curves.rest_to_rest(1, 7))
    coarse, fine = (timed(problem, [2.0], cells) for cells in (60, 240))
    assert closed * (1 - 1e-3) < fine < closed * 1.01
    assert abs(fine - closed) < abs(coarse - closed)


@pytest.mark.parametrize("seed", range(4))
def test_a_motion_within_its_limits_is_one_of_the_timings(seed: int) -> None:
    rng = np.random.default_rng(seed)
    curve = (curves.three_five_three(), curves.cubic_spline_virtual(4))[seed % 2]
    limits = Limits([1.0, 2.0], [3.0, 4.0], [20.0, 30.0])
    problem = Problem(rng.uniform(-1, 1, (4, 2)), limits, curve)
    shape = np.ones(problem.segments)
    tight = check(problem, shape).stretch * shape
    time = timed(problem, tight.tolist())
    assert time <= tight.sum() * (1 + 1e-6)
    # The time is of the path: the same at another pace, and at limits and pace scaled alike.
    assert timed(problem, (1.3 * tight).tolist()) == pytest.approx(time, rel=1e-4)
    slow = Limits(limits.velocity / 2, limits.acceleration / 4, limits.jerk / 8)
    halved = Problem(problem.waypoints, slow, curve)
    assert timed(halved, (2 * tight).tolist()) == pytest.approx(2 * time, rel=1e-4)


def test_where_it_does_not_apply() -> None:
    curve, points = curves.rest_to_rest(1, 5), np.array([[0.0], [1.0]])
    moving = fit(curve, points, np.array([1.0]))
    still = fit(curve, np.zeros((2, 1)), np.array([1.0]))
    assert not jerk_limited_path(moving, Limits(1.0, 2.0))
    assert not jerk_limited_path(still, Limits(1.0, 2.0, 5.0))
    assert jerk_limited_path(moving, Limits(1.0, 2.0, 5.0))
    assert not jerk_limited_path(moving, Limits(1.0, 2.0, [[-5.0, 4.0]]))
