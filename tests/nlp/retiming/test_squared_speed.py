"""Bounds on the time along a path: closed forms, TOPPRA, and laws that need no solver."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from support.retimed import rest_to_rest_time, trajectory
from trajgap.nlp.retiming import bound_along, largest_derivatives, retime
from trajgap.nlp.retiming.squared_speed import PathTime, _worst, cut_path
from trajgap.problem import Limits, Trajectory, cubic_spline, fit, rest_to_rest

LINE = [[[0.2, -1.0, 3.0], [0.9, 2.5, -0.7]]]
"""A straight line of three joints, evenly over its parameter."""
POINTS = np.array([[0.3, 1.0], [1.1, 0.4], [0.9, -0.8], [-0.4, -0.5], [-0.2, 0.9], [0.5, 1.6]])
SHARES = np.array([0.9, 1.2, 1.0, 1.4, 1.1])
LIMITS = Limits([0.8, 1.3], [2.5, 4.0])
FEW = 500
"""Cells: a quarter of those by default, and a quarter of the time."""


def natural(points: np.ndarray, shares: np.ndarray) -> Trajectory:
    return fit(cubic_spline(len(shares), ((2, 0.0),)), points, shares)


BENT = natural(POINTS, SHARES)


def along(path: Trajectory, limits: Limits, **given: object) -> PathTime:
    return bound_along(path, limits, limits, cells=FEW, **given)


def narrow(found: PathTime, share: float) -> bool:
    return found.why is None and found.lower < found.upper < found.lower * (1.0 + share)


@pytest.mark.parametrize("velocity", [[0.5, 9.0, 0.4], [3.0, 9.0, 2.0], [np.inf] * 3])
def test_a_straight_line_takes_a_trapezoid(velocity: list[float]) -> None:
    acceleration = [4.0, 9.0, 6.0]
    found = along(trajectory(LINE, [1.0]), Limits(velocity, acceleration))
    truth = rest_to_rest_time(LINE[0][1], velocity, acceleration)
    assert narrow(found, 1e-3)
    assert found.lower <= truth <= found.upper


def test_a_parameter_that_starts_at_rest_describes_the_same_line() -> None:
    velocity, acceleration = [1.5, 9.0, 1.1], [4.0, 9.0, 6.0]
    path = fit(rest_to_rest(1, 5), np.cumsum(LINE[0], axis=0), [1.3])
    found = along(path, Limits(velocity, acceleration))
    truth = rest_to_rest_time(LINE[0][1], velocity, acceleration)
    assert narrow(found, 6e-3)
    assert found.lower <= truth <= found.upper


def test_a_quarter_circle_turns_at_the_speed_that_its_curvature_allows() -> None:
    # Both joints' accelerations bound v² / r at the middle by √2 A, where v² has no slope.
    turn = np.linspace(0.0, np.pi / 2, 41)
    found = along(natural(np.c_[np.sin(turn), np.cos(turn)], np.ones(40)), Limits([9, 9], [1, 1]))
    assert narrow(found, 2e-3)
    assert np.pi / 2 / np.sqrt(np.sqrt(2.0)) < found.lower


@pytest.mark.parametrize("seed", range(6))
def test_toppra_lies_between_the_bounds(seed: int) -> None:
    random = np.random.default_rng(seed)
    joints = 1 + seed % 3 + (seed > 2)
    points = np.cumsum(random.normal(0.4, 1.0, (6, joints)), axis=0)
    path = natural(points, random.uniform(0.6, 1.6, 5))
    limits = Limits(random.uniform(0.5, 3.0, joints), random.uniform(0.5, 6.0, joints))
    found = along(path, limits)
    toppra = retime(path, limits, end_speeds=(0.0, 0.0))
    if joints == 1:
        assert found.why == "all joints stand still between its ends"
        return
    assert narrow(found, 3e-3)
    assert found.lower - toppra.error <= toppra.extrapolated <= found.upper + toppra.error


def test_times_scale_with_the_limits_and_with_nothing_else() -> None:
    first, c = along(BENT, LIMITS), 1.7
    faster = Limits(c * LIMITS.velocity, c**2 * LIMITS.acceleration)
    still = natural(np.c_[POINTS, np.full(6, 0.7)], SHARES)
    for other, factor in (
        (along(BENT, faster), c),
        (along(replace(BENT, durations=3.0 * BENT.durations), LIMITS), 1.0),
        (along(natural(POINTS[:, ::-1], SHARES), Limits([1.3, 0.8], [4.0, 2.5])), 1.0),
        (along(natural(POINTS[::-1], SHARES[::-1]), LIMITS), 1.0),
        (along(natural(5.0 - POINTS, SHARES), LIMITS), 1.0),
    ):
        assert factor * other.lower == pytest.approx(first.lower, rel=1e-6)
        assert factor * other.upper == pytest.approx(first.upper, rel=1e-6)
    beside = along(still, Limits([0.8, 1.3, 0.0], [2.5, 4.0, 0.0]))
    assert [beside.lower, beside.upper] == pytest.approx([first.lower, first.upper], rel=1e-9)


def test_looser_limits_allow_less_time_and_tighter_ones_need_more() -> None:
    plain = along(BENT, LIMITS)
    both = bound_along(
        BENT,
        Limits(1.01 * LIMITS.velocity, LIMITS.acceleration),
        Limits([0.8, 1.3], [2.4, 3.9]),
        cells=FEW,
    )
    assert both.lower < plain.lower < plain.upper < both.upper


def test_both_bounds_hold_for_all_paths_within_the_radius() -> None:
    away = 0.002
    single = largest_derivatives(fit(cubic_spline(5, ((2, 0.0),)), np.eye(6), SHARES))
    radius = tuple(each @ np.full((6, 2), away) for each in single)
    wide = along(BENT, LIMITS, radius=radius)
    assert wide.upper < 1.05 * wide.lower
    random = np.random.default_rng(4)
    for _ in range(4):
        other = along(natural(POINTS + away * random.choice([-1, 1], (6, 2)), SHARES), LIMITS)
        assert wide.lower <= other.lower
        assert other.upper <= wide.upper


def test_peaks_are_no_less_than_those_of_any_path_within_the_radius() -> None:
    # No joint turns, so all these paths have the same cells.
    points, away = np.cumsum([[1.0, 0.3], [0.4, 1.1], [0.9, 0.8], [0.5, 0.4]], axis=0), 0.01
    spline = cubic_spline(3, ((2, 0.0),))
    single = largest_derivatives(fit(spline, np.eye(4), SHARES[:3]))
    exact = (np.zeros((3, 2)), np.zeros((3, 2)))
    radius = tuple(one @ np.full((4, 2), away) for one in single)
    wide = cut_path(natural(points, SHARES[:3]), 60, radius)
    b = np.random.default_rng(2).uniform(0.1, 1.0, wide.widths.size + 1)
    most, slow = np.zeros(2), np.full_like(b, 0.3)  # at constant speed, q″ alone pushes
    for signs in product((-away, away), repeat=4):
        other = cut_path(natural(points + np.c_[signs, signs[::-1]], SHARES[:3]), 60, exact)
        most = np.maximum(most, _worst(other, LIMITS, b))
        assert _worst(other, LIMITS, slow)[1] <= _worst(wide, LIMITS, slow)[1]
    own = _worst(cut_path(natural(points, SHARES[:3]), 60, exact), LIMITS, b)
    assert (own < most).all()
    assert (most <= _worst(wide, LIMITS, b)).all()


def test_largest_derivatives_are_no_smaller_than_any_value() -> None:
    path = fit(rest_to_rest(5, 7), POINTS, SHARES)
    for order, found in enumerate(largest_derivatives(path), 1):
        for k, (start, end) in enumerate(zip(path.breaks[:-1], path.breaks[1:], strict=True)):
            sampled = np.abs(path(np.linspace(start, end, 400)[1:-1], order)).max(axis=0)
            assert (sampled <= found[k] * (1 + 1e-12)).all()
            assert (found[k] <= 3.0 * sampled).all()


def test_a_motion_within_the_limits_is_never_shorter_than_the_lower_bound() -> None:
    # A quintic from rest to rest along the path, stretched until it keeps the limits.
    u = np.linspace(0.0, 1.0, 4001)
    total = BENT.total_time
    s = 10 * u**3 - 15 * u**4 + 6 * u**5
    v, a = 30 * u**2 * (1 - u) ** 2, 60 * u - 180 * u**2 + 120 * u**3
    first, second = BENT(total * s, 1), BENT(total * s, 2)
    speed = total * first * v[:, None]
    push = (total * first * a[:, None]) + second * (total * v[:, None]) ** 2
    speeds, pushes = np.abs(speed) / LIMITS.velocity, np.abs(push) / LIMITS.acceleration
    stretch = max(speeds.max(), np.sqrt(pushes).max())
    found = along(BENT, LIMITS)
    assert found.upper < stretch
    assert narrow(found, 2e-3)


@pytest.mark.parametrize(
    ("path", "limits", "why"),
    [
        (fit(rest_to_rest(5, 5), POINTS, SHARES), LIMITS, "stand still between its ends"),
        (BENT, Limits([1, 1]), "no acceleration is limited"),
        (BENT, Limits(np.tile([-1.0, 2.0], (2, 1)), [1, 1]), "differ in size"),
        (natural(np.ones((6, 2)), SHARES), LIMITS, "nothing moves"),
    ],
)
def test_what_is_not_computed_says_why(path: Trajectory, limits: Limits, why: str) -> None:
    found = along(path, limits)
    assert found.why is not None
    assert why in found.why
    assert found.lower == 0.0
    assert np.isinf(found.upper)


def test_limited_jerk_leaves_the_lower_bound() -> None:
    jerky = Limits(LIMITS.velocity, LIMITS.acceleration, [9.0, 9.0])
    assert along(BENT, jerky) == PathTime(along(BENT, LIMITS).lower)
