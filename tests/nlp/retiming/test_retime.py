"""TOPPRA on paths of known answers, its order, and the one-sided inequality."""

import numpy as np
import pytest
from scipy.optimize import brentq
from support.puma import PUMA_LIMITS
from support.retimed import PUMA_353, close, hermite, puma, rest_to_rest_time, trajectory
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.nlp.retiming.toppra_check import extrapolate, retime, retime_joints
from trajgap.problem import (
    Limits,
    Problem,
    check,
    cubic_spline,
    cubic_spline_virtual,
    fit,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)

# --- paths of known answers -----------------------------------------------------------------------


THERE_AND_BACK = [[0.3], [1.7], [0.9]], [1.5, 1.2]
STRAIGHT = [[0.2, -1.0, 3.0], [1.1, 1.5, 2.3]], [2.0]
CORNERS = [[0.1, 0.9, -0.3], [0.8, 0.2, -0.3], [0.9, -1.4, 0.5], [-0.2, -1.1, 0.1]], [1.0, 1.6, 1.3]
A_STOP = [[0.0, 0.3], [1.0, 0.5], [1.0, 0.5], [0.2, -1.0]], [1.0, 0.4, 1.5]


@pytest.mark.parametrize("degree", [3, 5, 7])
@pytest.mark.parametrize(
    ("path", "velocity", "acceleration"),
    [
        (THERE_AND_BACK, [9.0], [8.0]),
        (THERE_AND_BACK, [0.7], [8.0]),
        (THERE_AND_BACK, [1.1], [2.5]),
        (STRAIGHT, [3.0, 9.0, 2.0], [4.0, 9.0, 6.0]),
        (STRAIGHT, [0.5, 9.0, 0.4], [4.0, 9.0, 6.0]),
        (CORNERS, [1.5, 1.9, 1.1], [4.0, 3.0, 5.0]),
        (A_STOP, [2.0, 3.0], [8.0, 5.0]),  # a segment in which nothing moves is left out
    ],
)
def test_straight_segments_from_rest_to_rest(
    path: tuple[list[list[float]], list[float]],
    velocity: list[float],
    acceleration: list[float],
    degree: int,
) -> None:
    q, h = path
    found = retime(fit(rest_to_rest(len(h), degree), q, h), Limits(velocity, acceleration))
    steps = [np.where(step == 0, 1e-300, step) for step in np.diff(q, axis=0) if step.any()]
    assert close(found, sum(rest_to_rest_time(step, velocity, acceleration) for step in steps))
    assert found.cuts == pytest.approx((0.0, *np.cumsum(h)), abs=1e-9)


def test_a_reversal_inside_a_segment_is_a_standstill_and_not_a_smooth_point() -> None:
    # 0.97 s with a stop at the turning point; one arc of the same length would take 0.79 s.
    there, back, limit = 1.162, 0.0864, 8.0
    expected = 2 * np.sqrt(there / limit) + 2 * np.sqrt(back / limit)
    assert expected == pytest.approx(0.970, abs=5e-4)
    assert 2 * np.sqrt((there + back) / limit) == pytest.approx(0.790, abs=5e-4)

    def quartic(turn: float) -> np.polynomial.Polynomial:
        return np.polynomial.Polynomial.fromroots([0.0, turn, 1.0]).integ()

    def excess(turn: float) -> float:
        q = quartic(turn)
        return float((q(turn) - q(1.0)) / q(turn)) - back / there

    turn = float(brentq(excess, 0.55, 0.95, xtol=1e-15))
    q = quartic(turn)
    coefficients = (q * (there / q(turn))).coef[:, None]
    coefficients[0] = 0.4
    found = retime(trajectory([coefficients], [1.0]), Limits(100.0, limit, joints=1))
    assert close(found, expected)
    assert found.cuts == pytest.approx((0.0, turn, 1.0), abs=1e-12)


def test_circle_at_the_velocity_limit() -> None:
    # max(|sin|, |cos|) of the path speed is V, so that a full turn takes 8·(R/√2)/V.
    radius, speed = 0.8, 1.3
    angle = np.linspace(0.0, 2 * np.pi, 41)
    rate = speed / radius
    nodes = [
        [
            [radius * np.cos(a + m * np.pi / 2) * rate**m + (m == 0) * 0.5 for a in angle],
            [radius * np.sin(a + m * np.pi / 2) * rate**m - (m == 0) * 1.5 for a in angle],
        ]
        for m in range(4)
    ]
    circle = hermite(angle / rate, np.transpose(nodes, (2, 0, 1)))
    found = retime(circle, Limits(speed, 2.9 * speed**2 / radius, joints=2))
    assert close(found, 4 * np.sqrt(2) * radius / speed)
    assert found.inequality_holds
    assert found.cuts == ()


@pytest.mark.parametrize("start", [0.0, -0.9])
def test_parabola_at_the_acceleration_limit_cannot_be_done_faster(start: float) -> None:
    # q2 = k q1² at constant q1 velocity c has q2'' = 2kc² on its limit throughout, while only a
    # larger q2'' could shorten the time to either side of the apex, where it caps the speed.
    k, c, end = 1.7, 0.6, 1.4
    t0 = start
    curve = trajectory(
        [[[0.3 + c * t0, k * (c * t0) ** 2], [c, 2 * k * c**2 * t0], [0.0, k * c**2]]], [end - t0]
    )
    found = retime(curve, Limits([np.inf, 50.0], [np.inf, 2 * k * c**2]))
    assert close(found, end - t0)
    assert found.inequality_holds


def test_first_order_and_extrapolation_within_its_error() -> None:
    curve = puma(three_five_three(), PUMA_353)
    coarse = retime(curve, PUMA_LIMITS, gridpoints=(100, 200, 400))
    fine = retime(curve, PUMA_LIMITS, gridpoints=(2000, 4000, 8000))
    assert 0.8 < coarse.order < 1.5
    assert abs(coarse.extrapolated - fine.extrapolated) <= coarse.error
    assert fine.error < coarse.error / 5
    assert list(coarse.durations) == sorted(coarse.durations, reverse=True)


@pytest.mark.parametrize("p", [0.7, 1.0, 2.0])
@pytest.mark.parametrize("cells", [(100, 200, 400), (150, 400, 700)])
def test_extrapolation_is_exact_on_one_power(p: float, cells: tuple[int, ...]) -> None:
    durations = 1.3 + 5.0 * np.array(cells, dtype=float) ** -p
    order, limit, error = extrapolate(cells, durations)
    assert order == pytest.approx(p, rel=1e-6)
    assert limit == pytest.approx(1.3, rel=1e-9)
    assert error >= durations[2] - 1.3


@pytest.mark.parametrize(
    "durations", [[1.0, 1.0, 1.0], [1.0, 1.000001, 1.0], [1.0, 1.1, 1.05], [1.0, 1.0, 0.9]]
)
def test_no_order_where_there_is_none(durations: list[float]) -> None:
    order, limit, error = extrapolate((10, 20, 40), np.array(durations))
    assert order is None
    assert error >= np.ptp(durations)
    assert abs(limit - durations[2]) <= error


# --- the one-sided inequality ---------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(24))
def test_retiming_never_takes_longer_than_a_feasible_trajectory(seed: int) -> None:
    generator = np.random.default_rng(seed)
    joints, segments = int(generator.integers(1, 7)), int(generator.integers(2, 6))
    interpolant = (
        three_five_three(),
        quintic_spline(segments),
        cubic_spline(segments),
        cubic_spline_virtual(segments + 1),
        rest_to_rest(segments, 5),
        piecewise((4, 3, 4), 2),
    )[seed % 6]
    shape = (len(interpolant.waypoint_breaks), joints)
    problem = Problem(
        generator.normal(size=shape) + generator.normal(size=joints),
        Limits(generator.uniform(1, 6, joints), generator.uniform(2, 20, joints)),
        interpolant,
    )
    h = generator.uniform(0.3, 1.5, interpolant.segments)
    repaired = h * check(problem, h).stretch
    curve = fit(interpolant, problem.waypoints, repaired)
    found = retime(curve, problem.limits, gridpoints=(150, 300, 600))
    assert found.applicable, found.why
    assert found.inequality_holds
    assert found.extrapolated <= found.trajectory_time + found.error


def test_no_inequality_for_a_trajectory_that_breaks_its_limits() -> None:
    found = retime(puma(three_five_three(), 0.5 * PUMA_353), PUMA_LIMITS)
    assert found.applicable
    assert found.inequality_holds is None
    assert found.why.startswith("the trajectory exceeds a limit itself (ratio 3.99")


def test_no_inequality_on_grids_that_are_too_coarse() -> None:
    found = retime(puma(three_five_three(), PUMA_353), PUMA_LIMITS, gridpoints=(2, 3, 4))
    assert found.applicable
    assert found.inequality_holds is None
    assert found.why.startswith("the grids are too coarse (error estimate")


def test_many_segments_get_more_cells() -> None:
    q = np.cumsum(np.random.default_rng(0).normal(size=(41, 3)), axis=0)
    limits = Limits(3.0, 8.0, joints=3)
    problem = Problem(q, limits, quintic_spline(40))
    h = np.full(40, 0.7)
    curve = fit(problem.curve, q, h * check(problem, h).stretch)
    found = retime(curve, limits, gridpoints=(200, 400, 800))
    assert found.inequality_holds
    assert found.error < 0.01 * found.extrapolated


# --- identities -----------------------------------------------------------------------------------


def test_the_duration_belongs_to_the_path_and_not_to_its_timing() -> None:
    curve = puma(three_five_three(), PUMA_353)
    slow = puma(three_five_three(), 7.0 * PUMA_353)
    one, two = (retime(c, PUMA_LIMITS) for c in (curve, slow))
    assert one.durations == pytest.approx(two.durations, rel=1e-5)
    assert two.inequality_holds


def test_each_joint_by_itself_has_a_path_of_its_own() -> None:
    curve = fit(rest_to_rest(2, 5), CORNERS[0][:3], [1.0, 1.6])
    limits = Limits([1.5, 1.9, 1.1], [4.0, 3.0, 5.0])
    found = retime_joints(curve, limits)
    ways = np.abs(np.diff(CORNERS[0][:3], axis=0))
    wanted = [
        sum(rest_to_rest_time(np.array([way]), [v], [a]) for way in ways[:, j] if way > 0)
        for j, (v, a) in enumerate([(1.5, 4.0), (1.9, 3.0), (1.1, 5.0)])
    ]
    assert len(found) == 3
    assert all(close(one, time) for one, time in zip(found, wanted, strict=True))


def test_a_path_from_rest_to_rest_has_a_speed_in_between() -> None:
    (piece,), _ = pieces(fit(rest_to_rest(1, 5), [[0.0, 0.0], [3.0, 4.0]], [2.0]))
    sampled = sample(piece, measure(piece), 40)
    # |q'| of a quintic from rest to rest over 5 rad in 2 s, at the share of the way that is s.
    u = np.linspace(0.0, 1.0, 100_001)
    way, speed = (10 - 15 * u + 6 * u**2) * u**3, 30 * u**2 * (1 - u) ** 2
    wanted = np.interp(sampled.s / sampled.s[-1], way, speed) * 5.0 / 2.0
    np.testing.assert_allclose(sampled.speed, wanted, atol=1e-6)


def test_a_path_whose_parameter_is_not_linear_in_time_is_a_path_as_any_other() -> None:
    """Control points of a timed B-spline do not depend on the durations: one path, two clocks."""
    waypoints = np.array([[0.1, 0.5], [0.6, 0.1], [1.0, 0.4], [0.7, 1.1], [0.2, 0.9]])
    limits = Limits(velocity=[1.2, 0.9], acceleration=[3.0, 2.5])
    curve = uniform_cubic_b_spline(5, "timed")
    clocks = [np.full(4, 1.0), np.array([0.9, 1.1, 1.3, 0.8])]
    motions = [fit(curve, waypoints, durations) for durations in clocks]
    assert not any(motion.polynomial_in_time for motion in motions)
    ends = (0.3, 0.2)
    answers = [retime(motion, limits, end_speeds=ends) for motion in motions]
    assert answers[0].extrapolated == pytest.approx(answers[1].extrapolated, rel=1e-6)
    # With equal durations the clock is even, and the motion is a polynomial in time all the same.
    assert answers[0].extrapolated == pytest.approx(
        retime(motions[0].path, limits, end_speeds=ends).extrapolated, rel=1e-6
    )
    own = retime(motions[1], limits)
    assert own.applicable
    speeds = np.linalg.norm(motions[1]([0.0, motions[1].total_time], order=1), axis=1)
    again = retime(motions[1], limits, end_speeds=(float(speeds[0]), float(speeds[1])))
    assert own.extrapolated == pytest.approx(again.extrapolated, rel=1e-6)
