"""The uniform cubic B-spline under both readings of time, by routes that share no code with it."""

import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.b_splines import NATURAL, ByScipy, spline_by_scipy, uniform
from trajgap.problem import (
    CurveError,
    Limits,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    evaluate,
    fit,
    keeps_limits,
    solve_in_closed_form,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves.uniform import vertex_matrix


@pytest.mark.parametrize("natural", [False, True])
@pytest.mark.parametrize("count", [2, 3, 5, 10])
def test_vertices_meet_the_waypoint_equations_exactly(count: int, natural: bool) -> None:
    v = vertex_matrix(count, natural=natural)
    for i in range(count):
        row = [(a + 4 * b + c) / 6 for a, b, c in zip(*v[i : i + 3], strict=True)]
        assert row == [Fraction(int(k == i)) for k in range(count)]
    assert all(sum(row) == 1 for row in v)
    for ends in (v[:3], v[-1:-4:-1]):
        bends = [a - 2 * b + c for a, b, c in zip(*ends, strict=True)]
        assert bends == [0] * count if natural else ends[0] == ends[1]
    if natural:
        return
    assert max(sum(map(abs, row)) for row in v) <= 3


def test_declarations_are_checked() -> None:
    words = r"interpolant.time: 'both' is unknown; use stretched or"
    with pytest.raises(TrajgapError, match=words):
        uniform_cubic_b_spline(5, "both")
    with pytest.raises(TrajgapError, match=r"interpolant.time_ends: goes with time = 'timed'"):
        uniform_cubic_b_spline(5, "stretched", natural_clock=True)
    for time in Timing:
        with pytest.raises(TrajgapError, match="at least two way-points are needed"):
            uniform_cubic_b_spline(1, time)
        assert len(uniform_cubic_b_spline(2, time).waypoint_breaks) == 2
    assert len(uniform_cubic_b_spline(2, "timed", natural_clock=True).waypoint_breaks) == 2
    with pytest.raises(TrajgapError, match="is not a piecewise polynomial with breaks"):
        _ = uniform("timed")[0].piecewise
    with pytest.raises(TrajgapError, match="str is not a kind of curve known here"):
        fit("3-5-3", [[0.0]], [1.0])
    with pytest.raises(TrajgapError, match="curve: str is not a kind of curve known here"):
        Problem([[0.0], [1.0]], Limits(1.0), "rest-to-rest")


def test_closed_form_with_a_limit_of_zero_and_with_nothing_that_moves() -> None:
    curve = uniform_cubic_b_spline(3, "stretched")
    assert (solve_in_closed_form(curve, np.full((3, 1), 0.4), [[1.0, 2.0, 3.0]]) == 0).all()
    moving = solve_in_closed_form(curve, [[0.1], [0.4], [0.2]], [[0.0, np.inf, np.inf]])
    assert np.isinf(moving).all()
    with pytest.raises(TrajgapError, match="needs 3 rows"):
        solve_in_closed_form(curve, np.ones((4, 1)), [[1.0, 1.0, 1.0]])


@pytest.mark.parametrize("time", ["timed", NATURAL])
@pytest.mark.parametrize("seed", range(3))
def test_derivatives_are_finite_differences_of_another_inversion(seed: int, time: str) -> None:
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


def test_time_must_not_run_backwards() -> None:
    problem, _ = uniform("timed", 14)
    h = np.array([1.0, 0.05, 2.0, 0.04, 1.0])
    assert np.isinf(evaluate(problem, h[None]).ratios).all()
    words = r"^durations: time would not increase along the curve, dt/"
    with pytest.raises(CurveError, match=words):
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
