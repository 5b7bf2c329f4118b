"""Where retiming applies: identities, cutting, sampling, what it refuses, and its manners."""

import logging

import numpy as np
import pytest
from support.puma import PUMA, PUMA_LIMITS
from support.retimed import PUMA_353, close, hermite, puma, rest_to_rest_time, trajectory
from support.same_question import DRESSES, OWN_UNITS, same_question
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.nlp.retiming.toppra_check import retime, retime_joints
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    extrema,
    fit,
    quintic_spline,
    three_five_three,
)


@pytest.mark.parametrize("dress", [*DRESSES[1:], OWN_UNITS])
def test_another_dress_changes_no_time(dress: str) -> None:
    limits = Limits(np.linspace(2, 4, 6), np.linspace(5, 9, 6))
    problem, h = Problem(PUMA, limits, quintic_spline(3)), np.array([0.9, 0.8, 1.1])
    other, durations = same_question(dress, problem, h)
    base = retime(fit(problem.curve, PUMA, h), limits).extrapolated
    found = retime(fit(other.curve, other.waypoints, durations), other.limits)
    assert close(found, base * durations.sum() / h.sum())


def test_each_joint_on_its_own_path() -> None:
    curve = puma(three_five_three(), PUMA_353)
    each = retime_joints(curve, PUMA_LIMITS)
    for j, found in enumerate(each):
        turning = [e for e in extrema(curve, j, 0) if abs(curve(e.time, 1)[j]) < 1e-9]
        values = [turning[0].value]
        for e in turning[1:]:
            if abs(e.value - values[-1]) > 1e-9:
                values.append(e.value)
        expected = sum(rest_to_rest_time([d], [6.0], [8.0]) for d in np.diff(values))
        assert close(found, expected)
        assert len(found.cuts) == len(values)
    assert max(f.extrapolated for f in each) < retime(curve, PUMA_LIMITS).extrapolated


# --- cutting, sampling ----------------------------------------------------------------------------


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
    curve = puma(three_five_three(), PUMA_353)
    (piece,), _ = pieces(curve)
    path = sample(piece, measure(piece), 4000)
    assert np.allclose(np.linalg.norm(path.tangent, axis=1), 1.0, atol=1e-12)
    inner = slice(400, -400)
    slope = np.gradient(path.tangent, path.s, axis=0)
    middle = (path.before + path.after) / 2
    assert np.allclose(slope[inner], middle[inner], atol=2e-3 * np.abs(middle[inner]).max())
    times = np.linspace(0, curve.total_time, 200_001)
    assert path.s[-1] == pytest.approx(
        np.trapezoid(np.linalg.norm(curve(times, 1), axis=1), times), rel=1e-8
    )
    # The grid is graded at the rest ends, where q″ grows like s^(−2/3): s ~ τ³.
    share = np.log(path.s[8] / path.s[4]) / np.log(2)
    assert 2.7 < share < 3.3


# --- where it does not apply ----------------------------------------------------------------------


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
    curve = puma(three_five_three(), PUMA_353)
    found = retime(curve, limits)
    assert not found.applicable
    assert found.why.startswith(why)
    assert found.extrapolated is None
    assert found.durations == ()
    assert why in str(found)


def test_jerk_limits_of_joints_at_rest_do_not_matter() -> None:
    q = np.column_stack([PUMA[:, 0], np.full(4, 0.7)])
    limits = Limits(6.0, [8.0, np.inf], [np.inf, 5.0])
    found = retime(fit(three_five_three(), q, PUMA_353), limits)
    alone = retime(fit(three_five_three(), q[:, :1], PUMA_353), Limits(6.0, 8.0, joints=1))
    assert found.durations == pytest.approx(alone.durations, rel=1e-5)


def test_zero_limits_of_joints_at_rest_do_not_matter() -> None:
    q = np.column_stack([PUMA[:, 0], np.full(4, 0.7), PUMA[:, 2]])
    curve = fit(three_five_three(), q, PUMA_353)
    found = retime(curve, Limits([6.0, 0.0, 6.0], [8.0, 0.0, 8.0]))
    alone = fit(three_five_three(), q[:, [0, 2]], PUMA_353)
    assert found.durations == pytest.approx(
        retime(alone, Limits(6.0, 8.0, joints=2)).durations, rel=1e-5
    )
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
    curve = puma(three_five_three(), PUMA_353)
    found = retime(curve, PUMA_LIMITS, end_speeds=(1000.0, 0.0))
    assert not found.applicable
    assert found.why == "TOPPRA found no parametrisation of piece 1 on 500 cells"
    moving = retime(curve, PUMA_LIMITS, end_speeds=(0.1, 0.0))
    assert moving.inequality_holds is None
    assert moving.why == "the end speeds are not the trajectory's"


def test_arguments_that_make_no_sense() -> None:
    curve = puma(three_five_three(), PUMA_353)
    with pytest.raises(TrajgapError, match="gridpoints: expected three ascending numbers"):
        retime(curve, PUMA_LIMITS, gridpoints=(100, 100, 200))
    with pytest.raises(TrajgapError, match="end_speeds: expected two speeds of 0 or more"):
        retime(curve, PUMA_LIMITS, end_speeds=(-1.0, 0.0))
    with pytest.raises(TrajgapError, match="limits: given for 2 joints, trajectory has 6"):
        retime(curve, Limits(1.0, 1.0, joints=2))


# --- manners --------------------------------------------------------------------------------------


def test_toppra_stays_quiet_and_its_logger_as_it_was(caplog: pytest.LogCaptureFixture) -> None:
    logger = logging.getLogger("toppra")
    level = logger.level
    with caplog.at_level(logging.DEBUG):
        retime(puma(three_five_three(), PUMA_353), PUMA_LIMITS, end_speeds=(1000.0, 0.0))
    assert [r for r in caplog.records if r.name.startswith("toppra")] == []
    assert logger.level == level


def test_summary_on_one_screen() -> None:
    text = str(retime(puma(three_five_three(), PUMA_353), PUMA_LIMITS))
    assert len(text.splitlines()) <= 6
    for part in ("2.0269", "(2000)", "fitted order 1.", "one-sided           holds"):
        assert part in text


def test_a_straight_line_without_a_velocity_limit_has_its_closed_form() -> None:
    # Constant speed 1.2 rad/s reaches no limit at all; between the same end speeds 2 rad/s² win:
    # 0.3 = 1.2 τ + τ² for each half.
    straight = fit(cubic_spline(1, ends=((2, 0.0),)), np.array([[0.1], [0.7]]), np.array([0.5]))
    found = retime(straight, Limits(np.inf, 2.0))
    assert found.applicable
    assert found.extrapolated == pytest.approx(-1.2 + np.sqrt(1.44 + 1.2), rel=1e-5)
