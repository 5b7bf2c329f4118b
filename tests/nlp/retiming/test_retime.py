"""Paths timed anew: known answers, order, the one-sided inequality, and where it applies."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from support.puma import PUMA, PUMA_LIMITS
from support.retimed import PUMA_353, close, hermite, puma, rest_to_rest_time, trajectory
from support.same_question import DRESSES, OWN_UNITS, same_question
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.nlp.retiming.toppra_check import GRIDPOINTS, extrapolate, retime
from trajgap.problem import Limits, Problem, TrajgapError, check, curves, extrema, fit

MOTION = puma(curves.three_five_three(), PUMA_353)
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
    found = retime(fit(curves.rest_to_rest(len(h), degree), q, h), Limits(velocity, acceleration))
    steps = [np.where(step == 0, 1e-300, step) for step in np.diff(q, axis=0) if step.any()]
    assert close(found, sum(rest_to_rest_time(step, velocity, acceleration) for step in steps))
    assert found.cuts == pytest.approx((0.0, *np.cumsum(h)), abs=1e-9)


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
    coarse = retime(MOTION, PUMA_LIMITS, gridpoints=(100, 200, 400))
    fine = retime(MOTION, PUMA_LIMITS, gridpoints=(2000, 4000, 8000))
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


@pytest.mark.parametrize("seed", range(24))
def test_retiming_never_takes_longer_than_a_feasible_trajectory(seed: int) -> None:
    generator = np.random.default_rng(seed)
    joints, segments = int(generator.integers(1, 7)), int(generator.integers(2, 6))
    interpolant = (
        curves.three_five_three(),
        curves.quintic_spline(segments),
        curves.cubic_spline(segments),
        curves.cubic_spline_virtual(segments + 1),
        curves.rest_to_rest(segments, 5),
        curves.piecewise((4, 3, 4), 2),
    )[seed % 6]
    shape = (len(interpolant.waypoint_breaks), joints)
    q = generator.normal(size=shape) + generator.normal(size=joints)
    limits = Limits(generator.uniform(1, 6, joints), generator.uniform(2, 20, joints))
    problem = Problem(q, limits, interpolant)
    h = generator.uniform(0.3, 1.5, interpolant.segments)
    repaired = h * check(problem, h).stretch
    curve = fit(interpolant, problem.waypoints, repaired)
    found = retime(curve, problem.limits, gridpoints=(150, 300, 600))
    assert found.applicable, found.why
    assert found.inequality_holds
    assert found.extrapolated <= found.trajectory_time + found.error


@pytest.mark.parametrize(
    ("factor", "gridpoints", "why"),
    [
        (0.5, GRIDPOINTS, "the trajectory exceeds a limit itself (ratio 3.99"),
        (1.0, (2, 3, 4), "the grids are too coarse (error estimate"),
    ],
)
def test_no_inequality(factor: float, gridpoints: tuple[int, ...], why: str) -> None:
    curve = puma(curves.three_five_three(), factor * PUMA_353)
    found = retime(curve, PUMA_LIMITS, gridpoints=gridpoints)
    assert found.applicable
    assert found.inequality_holds is None
    assert found.why.startswith(why)


def test_many_segments_get_more_cells() -> None:
    q = np.cumsum(np.random.default_rng(0).normal(size=(41, 3)), axis=0)
    limits = Limits(3.0, 8.0, joints=3)
    problem = Problem(q, limits, curves.quintic_spline(40))
    h = np.full(40, 0.7)
    curve = fit(problem.curve, q, h * check(problem, h).stretch)
    found = retime(curve, limits, gridpoints=(200, 400, 800))
    assert found.inequality_holds
    assert found.error < 0.01 * found.extrapolated


def test_a_path_from_rest_to_rest_has_a_speed_in_between() -> None:
    (piece,), _ = pieces(fit(curves.rest_to_rest(1, 5), [[0.0, 0.0], [3.0, 4.0]], [2.0]))
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
    curve = curves.uniform_cubic_b_spline(5, "timed")
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


@pytest.mark.parametrize("dress", [*DRESSES[1:], OWN_UNITS])
def test_another_dress_changes_no_time(dress: str) -> None:
    limits = Limits(np.linspace(2, 4, 6), np.linspace(5, 9, 6))
    problem, h = Problem(PUMA, limits, curves.quintic_spline(3)), np.array([0.9, 0.8, 1.1])
    other, durations = same_question(dress, problem, h)
    base = retime(fit(problem.curve, PUMA, h), limits).extrapolated
    found = retime(fit(other.curve, other.waypoints, durations), other.limits)
    assert close(found, base * durations.sum() / h.sum())


def test_each_joint_on_its_own_path() -> None:
    limits = Limits(np.linspace(5.0, 6.0, 6), np.linspace(8.0, 7.0, 6))
    alone = [replace(MOTION, scaled=MOTION.scaled[:, :, j : j + 1]) for j in range(6)]
    each = [retime(one, limits.joint(j)) for j, one in enumerate(alone)]
    for j, found in enumerate(each):
        turning = [e for e in extrema(MOTION, j, 0) if abs(MOTION(e.time, 1)[j]) < 1e-9]
        values = [turning[0].value]
        for e in turning[1:]:
            if abs(e.value - values[-1]) > 1e-9:
                values.append(e.value)
        expected = sum(
            rest_to_rest_time([d], limits.velocity[[j]], limits.acceleration[[j]])
            for d in np.diff(values)
        )
        assert close(found, expected)
        assert len(found.cuts) == len(values)
    assert max(f.extrapolated for f in each) < retime(MOTION, limits).extrapolated


def test_a_standstill_without_reversal_is_a_cut_too() -> None:
    # v = (t − 1)² times a constant: both joints touch 0 and go on.
    touch = np.polynomial.Polynomial.fromroots([1.0, 1.0]).integ().coef[:, None] * [1.0, -0.4]
    parts, cuts = pieces(trajectory([touch], [2.5]))
    assert cuts == pytest.approx((1.0,), abs=1e-6)
    assert [piece.rest for piece in parts] == [(False, True), (True, False)]


@pytest.mark.parametrize("miss", [1e-12, 1e-7, 1e-4, 1e-2])
def test_a_near_reversal_costs_about_as_much_as_a_reversal(miss: float) -> None:
    nodes = [
        [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
        [[1.0, 0.0], [0.0, miss], [-3.0, 0.0]],
        [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
    ]
    found = retime(hermite([0.0, 1.0, 2.0], nodes), Limits(3.0, 7.0, joints=2))
    assert found.extrapolated == pytest.approx(4 * np.sqrt(1 / 7), rel=1e-3)


def test_samples_against_finite_differences() -> None:
    (piece,), _ = pieces(MOTION)
    path = sample(piece, measure(piece), 4000)
    assert np.allclose(np.linalg.norm(path.tangent, axis=1), 1.0, atol=1e-12)
    inner = slice(400, -400)
    slope = np.gradient(path.tangent, path.s, axis=0)
    middle = (path.before + path.after) / 2
    assert np.allclose(slope[inner], middle[inner], atol=2e-3 * np.abs(middle[inner]).max())
    times = np.linspace(0, MOTION.total_time, 200_001)
    length = np.trapezoid(np.linalg.norm(MOTION(times, 1), axis=1), times)
    assert path.s[-1] == pytest.approx(length, rel=1e-8)
    # The grid is graded at the rest ends, where q″ grows like s^(−2/3): s ~ τ³.
    share = np.log(path.s[8] / path.s[4]) / np.log(2)
    assert 2.7 < share < 3.3


@pytest.mark.parametrize(
    ("limits", "why"),
    [
        (Limits(6.0, 8.0, 50.0, joints=6), "jerk is limited"),
        (Limits(6.0, joints=6), "no acceleration is limited"),
        (Limits([[-6.0, 5.0]] * 6, 8.0), "the two sides"),
        (Limits([6, 6, 0, 6, 6, 6], 8.0), "joint 3 moves, but its velocity limit is 0"),
        (Limits(6.0, [8, 0, 8, 8, 8, 8]), "joint 2 moves, but its acceleration limit is 0"),
    ],
)
def test_not_applicable_by_limits(limits: Limits, why: str) -> None:
    found = retime(MOTION, limits)
    assert not found.applicable
    assert found.why.startswith(why)
    assert found.extrapolated is None
    assert found.durations == ()
    assert why in str(found)


@pytest.mark.parametrize(
    "limits", [Limits(6.0, [8.0, np.inf], [np.inf, 5.0]), Limits([6.0, 0.0], [8.0, 0.0])]
)
def test_limits_of_joints_at_rest_do_not_matter(limits: Limits) -> None:
    q = np.column_stack([PUMA[:, 0], np.full(4, 0.7)])
    found = retime(fit(curves.three_five_three(), q, PUMA_353), limits)
    alone = retime(fit(curves.three_five_three(), q[:, :1], PUMA_353), Limits(6.0, 8.0, joints=1))
    assert found.durations == pytest.approx(alone.durations, rel=1e-5)
    assert found.inequality_holds


def test_not_applicable_by_shape() -> None:
    limits = Limits(6.0, 8.0, joints=1)
    lines = trajectory([[[0.0], [1.0]], [[1.0], [-1.0]]], [1.0, 1.0])
    assert retime(lines, limits).why == "the velocity of joint 1 jumps by -2 at break 1"
    gap = trajectory([[[0.0], [1.0]], [[1.5], [1.0]]], [1.0, 1.0])
    assert retime(gap, limits).why == "the position of joint 1 jumps by 0.5 at break 1"
    still = trajectory([[[0.4], [0.0]]], [1.0])
    assert retime(still, limits).why == "nothing moves"


def test_end_speeds_that_are_not_the_trajectorys_or_cannot_be_reached() -> None:
    found = retime(MOTION, PUMA_LIMITS, end_speeds=(1000.0, 0.0))
    assert not found.applicable
    assert found.why == "TOPPRA found no parametrisation of piece 1 on 500 cells"
    moving = retime(MOTION, PUMA_LIMITS, end_speeds=(0.1, 0.0))
    assert moving.inequality_holds is None
    assert moving.why == "the end speeds are not the trajectory's"


def test_arguments_that_make_no_sense() -> None:
    with pytest.raises(TrajgapError, match="gridpoints: expected three ascending numbers"):
        retime(MOTION, PUMA_LIMITS, gridpoints=(100, 100, 200))
    with pytest.raises(TrajgapError, match="end_speeds: expected two speeds of 0 or more"):
        retime(MOTION, PUMA_LIMITS, end_speeds=(-1.0, 0.0))
    with pytest.raises(TrajgapError, match="limits: given for 2 joints, trajectory has 6"):
        retime(MOTION, Limits(1.0, 1.0, joints=2))


def test_toppra_stays_quiet_and_its_logger_as_it_was(caplog: pytest.LogCaptureFixture) -> None:
    logger = logging.getLogger("toppra")
    level = logger.level
    with caplog.at_level(logging.DEBUG):
        retime(MOTION, PUMA_LIMITS, end_speeds=(1000.0, 0.0))
    assert [r for r in caplog.records if r.name.startswith("toppra")] == []
    assert logger.level == level


def test_summary_on_one_screen() -> None:
    text = str(retime(MOTION, PUMA_LIMITS))
    assert len(text.splitlines()) <= 6
    for part in ("2.0269", "(2000)", "fitted order 1.", "one-sided           holds"):
        assert part in text


def test_a_straight_line_without_a_velocity_limit_has_its_closed_form() -> None:
    # Constant speed 1.2 rad/s reaches no limit at all; between the same end speeds 2 rad/s² win:
    # 0.3 = 1.2 τ + τ² for each half.
    straight = fit(curves.cubic_spline(1, ends=((2, 0.0),)), np.array([[0.1], [0.7]]), [0.5])
    found = retime(straight, Limits(np.inf, 2.0))
    assert found.applicable
    assert found.extrapolated == pytest.approx(-1.2 + np.sqrt(1.44 + 1.2), rel=1e-5)
