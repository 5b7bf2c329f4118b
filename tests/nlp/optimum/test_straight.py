"""Motions along a line at constant speed, which no limit on acceleration or jerk holds back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from trajgap.nlp import Status, solve
from trajgap.nlp.optimum.straight import straight_durations
from trajgap.problem import Limits, Problem, Verdict, check, cubic_spline, quintic_spline

WAY = np.array(
    [[0.00014985578991195], [0.00025145336379865], [0.00095632029691939], [0.0028869372]]
)
LIMITS = Limits(
    acceleration=12.899170530102031,
    jerk=1124.7368118743839,
    position_lower=-0.00075,
    position_upper=0.00344,
    joints=1,
)
NATURAL = cubic_spline(3, ends=((2, 0.0),))
LINE = Problem(WAY, LIMITS, NATURAL)


def test_without_a_velocity_limit_a_line_takes_no_time() -> None:
    solution = solve(LINE)
    assert solution.status is Status.NOT_ATTAINED
    assert solution.infimum == solution.best == 0.0
    assert "nothing accelerates" in str(solution.why)
    assert check(LINE, solution.durations).verdict is Verdict.PASS
    assert solution.total_time < 2.0977e-4  # what differential evolution finds
    assert "infimum         0.000000000 s" in str(solution)
    # A second route: the natural spline of scipy at such durations does not bend.
    times = np.concatenate([[0.0], np.cumsum(np.diff(WAY[:, 0]))]) / np.ptp(WAY)
    bent = CubicSpline(times, WAY[:, 0], bc_type="natural")(np.linspace(0.0, 1.0, 50), 2)
    assert np.abs(bent).max() < 1e-10 * np.ptp(WAY)


def test_joints_on_one_line_share_it_and_bounds_above_do_not_matter() -> None:
    both = Problem(
        np.hstack([WAY, -2.0 * WAY, np.ones_like(WAY)]),
        Limits([np.inf, np.inf, 1.0], [5.0, 7.0, 1.0]),
        NATURAL,
        duration_upper=[1e-5, 1e-2, 3.0],
    )
    solution = solve(both)
    assert solution.best == 0.0
    assert (solution.durations <= both.duration_upper).all()
    ratio = solution.durations / np.diff(WAY[:, 0])
    assert ratio == pytest.approx(ratio[0], rel=1e-12)


@pytest.mark.parametrize(
    "other",
    [
        replace(LINE, limits=Limits(1.0, 12.9, joints=1)),
        replace(LINE, curve=cubic_spline(3)),
        replace(LINE, curve=quintic_spline(3)),
        replace(LINE, duration_lower=[1e-5, 0.0, 0.0]),
        replace(LINE, waypoints=WAY[[0, 2, 1, 3]]),
        replace(LINE, waypoints=WAY[[0, 1, 1, 3]]),
        Problem(np.hstack([WAY, WAY**2]), Limits(acceleration=1.0, joints=2), NATURAL),
    ],
    ids=["velocity", "rest", "rest-5", "lower bound", "turn", "still", "bend"],
)
def test_what_is_no_line_or_is_limited_is_searched(other: Problem) -> None:
    assert straight_durations(LINE) is not None
    assert straight_durations(other) is None
