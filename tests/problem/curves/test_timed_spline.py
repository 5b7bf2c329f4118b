"""Uniform B-splines with a clock: derivatives in time, peaks, time that must not run back."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.b_splines import NATURAL, ByScipy, spline_by_scipy, uniform, vertices_by_solving
from trajgap.problem import (
    ClockedTrajectory,
    CurveError,
    Limits,
    Timing,
    TrajgapError,
    Verdict,
    check,
    evaluate,
    extrema,
    fit,
    keeps_limits,
    load_case,
    uniform_cubic_b_spline,
)

POLISH = "irb1600-ga-cubic-bspline"


# --- (b) timed ------------------------------------------------------------------------------------


@pytest.mark.parametrize("time", ["timed", NATURAL])
@pytest.mark.parametrize("seed", range(3))
def test_derivatives_in_time_are_finite_differences_of_an_independent_inversion(
    seed: int, time: str
) -> None:
    problem, h = uniform(time, seed)
    other = ByScipy(problem.waypoints, h, time == NATURAL)
    trajectory = fit(problem.curve, problem.waypoints, h)
    rng = np.random.default_rng(seed + 50)
    for e in rng.uniform(0.05, 0.95, 5) + np.arange(5):
        t, step = other.time(e), 1e-3
        q = [other.position(t + i * step) for i in (-2, -1, 0, 1, 2)]
        np.testing.assert_allclose(trajectory(t), q[2], rtol=0, atol=1e-12)
        velocity = (q[0] - 8 * q[1] + 8 * q[3] - q[4]) / (12 * step)
        acceleration = (-q[0] + 16 * q[1] - 30 * q[2] + 16 * q[3] - q[4]) / (12 * step**2)
        np.testing.assert_allclose(trajectory(t, 1), velocity, rtol=0, atol=2e-8)
        np.testing.assert_allclose(trajectory(t, 2), acceleration, rtol=0, atol=5e-6)
        jerk = (trajectory(t + step, 2) - trajectory(t - step, 2)) / (2 * step)
        np.testing.assert_allclose(trajectory(t, 3), jerk, rtol=2e-3, atol=2e-2)


@pytest.mark.parametrize("limited", ["all", "velocity", "acceleration"])
def test_no_piece_that_is_skipped_holds_the_peak(limited: str) -> None:
    """Against every extremum of every piece, for durations whose neighbours differ much."""
    problem, h = uniform("timed", 4)
    rng = np.random.default_rng(7)
    drawn = h * rng.uniform(0.7, 1.3, (50, h.size)) * rng.uniform(0.2, 5.0, (50, 1))
    wanted = np.zeros((problem.waypoints.shape[1], 3), dtype=np.bool_)
    orders = {"all": (1, 2, 3), "velocity": (1,), "acceleration": (2,)}[limited]
    wanted[:, [order - 1 for order in orders]] = True
    values = problem.curve.motion_values(problem.waypoints)
    peaks = problem.curve.batch_peaks(values, drawn, wanted)
    compared = 0
    for one, found in zip(drawn, peaks, strict=True):
        if not np.isfinite(found).all():
            continue
        trajectory = fit(problem.curve, problem.waypoints, one)
        for j in range(wanted.shape[0]):
            for order in orders:
                every = [
                    abs(
                        trajectory.values(
                            k, j, order, np.append(trajectory.turning(k, j, order), [0, 1])
                        )
                    )
                    for k in range(h.size)
                ]
                assert found[j, order - 1] == pytest.approx(np.concatenate(every).max(), rel=1e-12)
                compared += 1
        assert not found[~wanted].any()
    assert compared > 100


@pytest.mark.parametrize("time", ["stretched", "timed"])
@pytest.mark.parametrize("tolerance", [0.0, 5e-10])
def test_limits_are_kept_where_all_ratios_say_so(time: str, tolerance: float) -> None:
    """At the edge too: vectors stretched to it, and moved off it by a rounding or a billionth."""
    problem, h = uniform(time, 5)
    rng = np.random.default_rng(8)
    drawn = h * rng.uniform(0.8, 1.25, (200, h.size)) * rng.uniform(0.3, 4.0, (200, 1))
    stretch = evaluate(problem, drawn).stretch
    edge = (drawn * stretch[:, None])[np.isfinite(stretch)]
    moved = [edge * (1 + by) for by in (0, 1e-15, -1e-15, -2e-10, -6e-10, 1e-8, -1e-8)]
    every = np.concatenate([drawn, *moved, -drawn[:3], np.full((1, h.size), np.inf)])
    kept = (evaluate(problem, every).ratios <= 1 + tolerance).all(axis=(1, 2))
    np.testing.assert_array_equal(keeps_limits(problem, every, tolerance), kept)
    assert 0.2 < kept.mean() < 0.8
    still = replace(problem, limits=Limits(np.zeros(problem.waypoints.shape[1])))
    assert not keeps_limits(still, drawn, tolerance).any()


def test_it_is_scipys_cubic_spline_with_its_own_end_slopes() -> None:
    problem, h = uniform("timed", 12)
    w, v = problem.waypoints, vertices_by_solving(problem.waypoints)
    ends = ((1, (v[2] - v[0]) / 2), (1, (v[-1] - v[-3]) / 2))
    spline = CubicSpline(np.arange(len(w)), w, bc_type=ends)
    trajectory = fit(problem.curve, w, h)
    for k in range(5):
        value = np.polynomial.polynomial.polyval(0.37, trajectory.scaled[k])
        np.testing.assert_allclose(value, spline(k + 0.37), rtol=0, atol=1e-12)


def test_c2_in_time_without_rest_at_the_ends() -> None:
    problem, h = uniform("timed", 13)
    verdict = check(problem, 9 * h)
    assert verdict.verdict is Verdict.PASS
    assert verdict.continuous
    trajectory = fit(problem.curve, problem.waypoints, h)
    end = float(h.sum())
    np.testing.assert_allclose(trajectory([0.0, end], 2), 0.0, atol=1e-11)
    assert (np.abs(trajectory([0.0, end], 1)) > 0.01).all()


def test_equal_durations_are_not_uniform_in_time_near_the_ends() -> None:
    trajectory = fit(uniform_cubic_b_spline(6, "timed"), np.arange(6.0)[:, None], np.ones(5))
    # q and t are then the same function of e: the motion is q = t, although dt/de is not 1.
    np.testing.assert_allclose(trajectory([0.3, 2.7, 4.9])[:, 0], [0.3, 2.7, 4.9], atol=1e-14)
    assert isinstance(trajectory, ClockedTrajectory)
    assert abs(trajectory.clock[0, 1] - 1) > 0.1


def test_time_must_not_run_backwards() -> None:
    problem, _ = uniform("timed", 14)
    h = np.array([1.0, 0.05, 2.0, 0.04, 1.0])
    assert np.isinf(evaluate(problem, h[None]).ratios).all()
    with pytest.raises(
        CurveError, match=r"^durations: time would not increase along the curve, dt/"
    ):
        fit(problem.curve, problem.waypoints, h)
    verdict = check(problem, h)
    assert verdict.verdict is verdict.limits is Verdict.VIOLATED
    assert verdict.worst is not None
    assert verdict.worst.quantity == "curve"
    assert verdict.feasible_time is None
    assert "time would not increase" in str(verdict.feasible_why)
    assert "segment" in str(verdict)
    other = spline_by_scipy(np.concatenate([[0.0], np.cumsum(h)])[:, None])
    slopes = other(np.linspace(0, 5 - 1e-12, 10001), 1)
    assert slopes.min() == pytest.approx(verdict.worst.value, abs=1e-6)
    assert int(np.argmin(slopes) // 2000) == verdict.worst.segment
    error = pickle.loads(pickle.dumps(CurveError("a reason", 2, -0.5)))
    assert (str(error), error.segment, error.value) == ("a reason", 2, -0.5)


def test_a_derivative_is_no_polynomial() -> None:
    problem, h = uniform("timed", 15)
    trajectory = fit(problem.curve, problem.waypoints, h)
    assert trajectory.derivative(1, 2, 0) == pytest.approx(trajectory.scaled[1, :4, 2])
    with pytest.raises(TrajgapError, match="time is not linear here"):
        trajectory.derivative(1, 2, 1)


def test_position_limits_are_found_between_waypoints() -> None:
    problem, h = uniform("timed", 16)
    top = max(e.value for e in extrema(fit(problem.curve, problem.waypoints, h), 0, 0))
    assert top > problem.waypoints[:, 0].max()
    limits = Limits(99.0, position_upper=[top - 1e-3, 99.0, 99.0], position_lower=-99.0)
    verdict = check(replace(problem, limits=limits), h)
    assert verdict.verdict is Verdict.VIOLATED
    assert verdict.worst is not None
    assert verdict.worst.quantity == "position"


@pytest.mark.parametrize("time", Timing)
def test_the_printed_durations_of_the_polishing_paper(time: str) -> None:
    """One unit throughout: limits kept before the optimisation, broken after it."""
    case = load_case(POLISH)
    before, after = (case.claim_durations(case.claim(i)).value for i in ("before", "after"))
    stretch = {"stretched": (0.874623, 1.325186), "timed": (0.755499, 1.085194)}[time]
    for unit in ("rad", "deg"):
        problem = case.problem(reading_id=f"angles-{unit}-v-{unit}-a-{unit}-{time}")
        found = check(problem, before), check(problem, after)
        assert [one.limits for one in found] == [Verdict.PASS, Verdict.VIOLATED]
        assert [one.stretch for one in found] == pytest.approx(stretch, abs=1e-6)
        assert found[0].continuous
        assert found[1].continuous == (time == "timed")
        assert {found[1].worst.joint, found[1].worst.quantity} == {"6", "acceleration"}
