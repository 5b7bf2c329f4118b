"""Shortest profiles from rest to rest, against time-optimal control solved as linear programs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from support.findings import said_of, study_of
from support.one_joint import one_joint
from trajgap.compare.audits.rules.profiles import judge_profiles, s_curve, shortest, trapezoidal
from trajgap.compare.documents import ClaimVerdict

STEPS = 120
CLAIM = """
[[claims]]
id = "t"
quantity = "total_time"
where = "Table 3"
value = "{value}"
other_curve = "blends"
profile = "{profile}"
"""
LIMITS = "velocity = 2\nacceleration = 4\njerk = 20"
UNITS = 'velocity = "rad/s"\nacceleration = "rad/s^2"\njerk = "rad/s^3"'


def farthest(time: float, velocity: float, acceleration: float, jerk: float) -> float:
    """The longest way from rest to rest in a time, with the jerk constant in many steps."""
    h = time / STEPS
    lower = np.tril(np.ones((STEPS, STEPS)))
    a = h * lower
    v = h * (lower @ a) - h / 2 * a
    q = h * v.sum(axis=0)
    bounds = [(-jerk, jerk)] * STEPS if np.isfinite(jerk) else [(None, None)] * STEPS
    rows = np.vstack([a, -a, v, -v])
    right = np.repeat([acceleration, acceleration, velocity, velocity], STEPS)
    still = np.vstack([a[-1], v[-1]])
    found = linprog(-q, A_ub=rows, b_ub=right, A_eq=still, b_eq=[0, 0], bounds=bounds)
    return float(-found.fun)


@pytest.mark.parametrize("way", [0.05, 0.4, 1.5, 6.0])
@pytest.mark.parametrize("limits", [(2.0, 4.0, 20.0), (0.6, 4.0, 20.0), (2.0, 90.0, 20.0)])
def test_an_s_curve_goes_as_far_as_any_motion_within_its_limits(
    way: float, limits: tuple[float, float, float]
) -> None:
    time = s_curve(way, *limits)
    assert farthest(time, *limits) == pytest.approx(way, rel=5e-3)
    assert s_curve(way, *limits[:2], np.inf) == trapezoidal(way, *limits[:2], np.inf)
    assert s_curve(way, *limits[:2], 1e9) == pytest.approx(trapezoidal(way, *limits), rel=1e-3)


def test_a_trapezoid_reaches_its_speed_or_does_not() -> None:
    assert trapezoidal(0.25, 2.0, 4.0, 1.0) == 0.5
    assert trapezoidal(3.0, 2.0, 4.0, 1.0) == 2.0
    ways, limits = np.array([[0.25, 3.0], [0.0, 0.25]]), np.tile([2.0, 4.0, np.inf], (2, 1))
    assert shortest("trapezoidal", ways, limits) == 2.5


@pytest.mark.parametrize(
    ("profile", "value", "verdict"),
    [
        ("trapezoidal", "1.000", ClaimVerdict.SUPPORTED),
        ("trapezoidal", "1.018", ClaimVerdict.INCONSISTENT),
        ("s-curve", "1.220", ClaimVerdict.SUPPORTED),
        ("s-curve", "1.00", ClaimVerdict.INCONSISTENT),
    ],
)
def test_a_printed_total_of_a_profile_is_judged(
    profile: str, value: str, verdict: ClaimVerdict
) -> None:
    """1 rad: half a second of 4 rad/s² each way; with jerk 0.2 + sqrt(0.04 + 1) s."""
    text = one_joint(
        "0, 1", "2", "2.0", "within_limits", CLAIM.format(profile=profile, value=value)
    )
    text = text.replace('velocity = "rad/s"', UNITS).replace("velocity = 2\n", LIMITS + "\n")
    (found,) = said_of(study_of(text), judge_profiles, "t", "TG304")
    assert found.verdict is verdict
    rounded = text.replace("[[0, 1]]", '[["0.00", "1.00"]]').replace('"1.018"', '"1.009"')
    (found,) = said_of(study_of(rounded), judge_profiles, "t", "TG304")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == (value != "1.00" or profile != "s-curve")
