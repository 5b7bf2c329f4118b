"""The uniform cubic B-spline under both readings of time, by routes that share no code with it."""

from __future__ import annotations

import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.b_splines import ByScipy, spline_by_scipy, uniform, vertices_by_solving
from trajgap.heuristics import PSO, run, uniform_rescaling
from trajgap.problem import (
    ClockedTrajectory,
    CurveError,
    Limits,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    control_vertices,
    evaluate,
    extrema,
    fit,
    load_case,
    peak_gradients,
    solve_in_closed_form,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves.stretched import segment_peaks
from trajgap.problem.curves.uniform_matrices import clock_matrix, shape_matrix, vertex_matrix

POLISH = "irb1600-ga-cubic-bspline"
TIMES = tuple(Timing)


# --- control vertices -----------------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 3, 5, 10])
def test_vertices_meet_the_waypoint_equations_exactly(count: int) -> None:
    v = vertex_matrix(count)
    for i in range(count):
        row = [(a + 4 * b + c) / 6 for a, b, c in zip(*v[i : i + 3], strict=True)]
        assert row == [Fraction(int(k == i)) for k in range(count)]
    assert v[0] == v[1]
    assert v[-1] == v[-2]
    assert all(sum(row) == 1 for row in v)
    assert max(sum(map(abs, row)) for row in v) <= 3


def test_vertices_agree_with_a_dense_solve() -> None:
    w = uniform("timed")[0].waypoints
    np.testing.assert_allclose(control_vertices(w), vertices_by_solving(w), rtol=0, atol=1e-13)


def test_shape_is_scipys_b_spline() -> None:
    w = uniform("stretched", 3)[0].waypoints
    spline = spline_by_scipy(w)
    c = (shape_matrix(len(w)) @ w.astype(np.longdouble)).astype(float)
    for k in range(len(w) - 1):
        for s in (0.0, 0.3, 1.0):
            value = np.polynomial.polynomial.polyval(s, c[k])
            np.testing.assert_allclose(value, spline(k + s), rtol=0, atol=1e-13)


def test_clock_passes_the_time_nodes_and_is_linear_in_the_durations() -> None:
    h = np.array([0.7, 1.3, 0.9, 1.1])
    c = (clock_matrix(5) @ h.astype(np.longdouble)).astype(float)
    nodes = np.concatenate([[0.0], np.cumsum(h)])
    np.testing.assert_allclose(c[:, 0], nodes[:-1], atol=1e-15)
    np.testing.assert_allclose(c.sum(axis=1), nodes[1:], atol=1e-15)
    spline = spline_by_scipy(nodes[:, None])
    np.testing.assert_allclose(
        c @ 0.4 ** np.arange(4), spline(np.arange(4) + 0.4)[:, 0], atol=1e-14
    )


# --- both readings --------------------------------------------------------------------------------


@pytest.mark.parametrize("time", TIMES)
def test_waypoints_are_passed_at_their_times(time: str) -> None:
    problem, h = uniform(time, 4)
    trajectory = fit(problem.curve, problem.waypoints, h)
    nodes = np.concatenate([[0.0], np.cumsum(h)])
    np.testing.assert_allclose(trajectory(nodes), problem.waypoints, rtol=0, atol=1e-12)
    assert trajectory.total_time == pytest.approx(h.sum(), rel=1e-14)
    np.testing.assert_allclose(trajectory.breaks, nodes, rtol=1e-14)


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("seed", range(4))
def test_batch_and_checker_find_the_same_peaks(time: str, seed: int) -> None:
    problem, h = uniform(time, seed, count=4 + seed)
    ratios = evaluate(problem, np.vstack([h, 1.7 * h])).ratios
    peaks = check(problem, h).peaks
    found = np.array([p.ratio for p in peaks]).reshape(ratios.shape[1:])
    np.testing.assert_allclose(ratios[0], found, rtol=1e-12)
    np.testing.assert_allclose(ratios[1], found / 1.7 ** np.arange(1, 4), rtol=1e-12)
    assert max(p.error / p.limit for p in peaks) < 1e-9


@pytest.mark.parametrize("time", TIMES)
def test_identities_of_scaling_mirror_reversal_and_order_of_joints(time: str) -> None:
    problem, h = uniform(time, 5)
    base = check(problem, h).stretch
    assert check(problem, 2.5 * h).stretch == pytest.approx(base / 2.5, rel=1e-12)
    for q, limits, durations in (
        (4.0 - problem.waypoints, problem.limits, h),
        (problem.waypoints[::-1], problem.limits, h[::-1]),
        (problem.waypoints + 7.0, problem.limits, h),
    ):
        other = replace(problem, waypoints=q, limits=limits)
        assert check(other, durations).stretch == pytest.approx(base, rel=1e-11)
    order = [2, 0, 1]
    swapped = Problem(
        problem.waypoints[:, order],
        Limits(*problem.limits.derivatives[order].T),
        problem.curve,
    )
    assert check(swapped, h).stretch == pytest.approx(base, rel=1e-12)
    assert {p.joint for p in check(problem.joint(1), h).peaks} == {"2"}


@pytest.mark.parametrize("time", TIMES)
def test_gradients_of_peaks_are_finite_differences(time: str) -> None:
    problem, h = uniform(time, 6, count=5)
    trajectory = fit(problem.curve, problem.waypoints, h)
    points = [e for j in range(3) for r in (1, 2, 3) for e in extrema(trajectory, j, r)]
    gradients = peak_gradients(problem, h, points)

    def values(q: np.ndarray, durations: np.ndarray) -> np.ndarray:
        moved = fit(problem.curve, q, durations)
        if isinstance(moved, ClockedTrajectory):
            return np.array([moved.value(e.segment, e.joint, e.order, e.s) for e in points])
        return np.array(
            [
                np.polynomial.polynomial.polyval(e.s, moved.derivative(e.segment, e.joint, e.order))
                for e in points
            ]
        )

    for k in range(len(h)):
        step = np.zeros(len(h))
        step[k] = 1e-6
        slope = values(problem.waypoints, h + step) - values(problem.waypoints, h - step)
        expected = slope / 2e-6
        scale = np.abs(expected).max()
        np.testing.assert_allclose(gradients.durations[:, k], expected, atol=1e-7 * scale)
    for w in range(problem.waypoints.shape[0]):
        for j in range(3):
            moved = problem.waypoints.copy()
            moved[w, j] += 1.0
            slope = values(moved, h) - values(problem.waypoints, h)
            own = [i for i, e in enumerate(points) if e.joint == j]
            np.testing.assert_allclose(gradients.waypoints[own, w], slope[own], atol=1e-10)


@pytest.mark.parametrize("time", TIMES)
def test_heuristics_and_baseline_take_it(time: str) -> None:
    problem, _ = uniform(time, 7, count=4, joints=2)
    bounded = replace(problem, duration_lower=0.2, duration_upper=6.0)
    found = run(PSO(particles=20, iterations=30, position_initial=(0.3, 6.0)), bounded, seed=3)
    assert found.feasible
    assert check(bounded, found.durations).limits is Verdict.PASS
    equal = uniform_rescaling(problem)
    assert check(problem, equal).stretch == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("time", TIMES)
def test_bad_input_is_one_line(time: str) -> None:
    problem, h = uniform(time)
    curve = problem.curve
    with pytest.raises(TrajgapError, match=r"^durations: expected 5 \(one per segment\), got 3$"):
        check(problem, h[:3])
    with pytest.raises(TrajgapError, match="must all be positive and finite"):
        fit(curve, problem.waypoints, [1, 1, 0, 1, 1])
    with pytest.raises(TrajgapError, match=r"needs 6 rows, got shape \(5, 3\)"):
        fit(curve, problem.waypoints[1:], h)
    with pytest.raises(TrajgapError, match=r"a batch has shape \(vectors, 5\)"):
        evaluate(problem, np.ones((2, 4)))
    with pytest.raises(TrajgapError, match=r"with 5 segments needs 6, got 5"):
        Problem(problem.waypoints[1:], problem.limits, curve)
    with pytest.raises(TrajgapError, match="is no piecewise polynomial with breaks"):
        _ = problem.piecewise
    assert not np.isfinite(evaluate(problem, [[1, 1, np.nan, 1, 1.0]]).stretch).any()


def test_declarations_are_checked() -> None:
    with pytest.raises(
        TrajgapError, match=r"interpolant.time: 'both' is unknown; use stretched or"
    ):
        uniform_cubic_b_spline(5, "both")
    for time in TIMES:
        with pytest.raises(TrajgapError, match="at least two way-points are needed"):
            uniform_cubic_b_spline(1, time)
        assert len(uniform_cubic_b_spline(2, time).waypoint_breaks) == 2
    with pytest.raises(TrajgapError, match="str is no kind of curve known here"):
        fit("3-5-3", [[0.0]], [1.0])
    with pytest.raises(TrajgapError, match="curve: str is no kind of curve known here"):
        Problem([[0.0], [1.0]], Limits(1.0), "rest-to-rest")


# --- (a) stretched --------------------------------------------------------------------------------


def sampled_segment_peaks(q: np.ndarray) -> np.ndarray:
    spline = spline_by_scipy(q)
    peaks = np.empty((len(q) - 1, q.shape[1], 3))
    for k in range(len(q) - 1):
        e = np.clip(np.linspace(k, k + 1, 20001), k, np.nextafter(k + 1, 0))
        for r in range(3):
            peaks[k, :, r] = np.abs(spline(e, r + 1)).max(axis=0)
    return peaks


def test_closed_form_from_dense_samples() -> None:
    problem, _ = uniform("stretched", 8)
    peaks = sampled_segment_peaks(problem.waypoints)
    exact = segment_peaks(problem.curve, problem.waypoints)
    assert (peaks <= exact * (1 + 1e-12)).all()
    np.testing.assert_allclose(peaks, exact, rtol=1e-7)
    ratios = peaks / problem.limits.derivatives
    expected = (ratios ** (1 / np.arange(1, 4))).max(axis=(1, 2))
    found = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
    np.testing.assert_allclose(found, expected, rtol=1e-7)
    verdict = check(problem, found)
    assert verdict.limits is Verdict.PASS
    assert verdict.verdict is Verdict.DISCONTINUOUS
    assert verdict.stretch == pytest.approx(1.0, rel=1e-12)
    assert check(problem, found * np.array([1, 1, 0.999, 1, 1])).limits is Verdict.VIOLATED


def test_closed_form_with_a_limit_of_zero_and_with_nothing_that_moves() -> None:
    curve = uniform_cubic_b_spline(3, "stretched")
    assert (solve_in_closed_form(curve, np.full((3, 1), 0.4), [[1.0, 2.0, 3.0]]) == 0).all()
    moving = solve_in_closed_form(curve, [[0.1], [0.4], [0.2]], [[0.0, np.inf, np.inf]])
    assert np.isinf(moving).all()
    with pytest.raises(TrajgapError, match="needs 3 rows"):
        solve_in_closed_form(curve, np.ones((4, 1)), [[1.0, 1.0, 1.0]])


def test_jumps_have_the_size_that_the_vertices_give() -> None:
    problem, h = uniform("stretched", 9)
    v = vertices_by_solving(problem.waypoints)
    first, second = (v[2:] - v[:-2]) / 2, v[2:] - 2 * v[1:-1] + v[:-2]
    jumps = {(j.break_index, j.joint, j.order): j for j in check(problem, h).jumps}
    assert len(jumps) == 4 * 3 * 2
    nodes = np.cumsum(h)
    for b in range(1, 5):
        for joint in range(3):
            for order, node in ((1, first), (2, second)):
                jump = jumps[b, str(joint + 1), order]
                size = node[b, joint] * (h[b] ** -order - h[b - 1] ** -order)
                assert jump.size == pytest.approx(size, rel=1e-9)
                assert jump.time == pytest.approx(nodes[b - 1], rel=1e-14)


def test_equal_durations_do_not_jump() -> None:
    problem, _ = uniform("stretched", 10)
    slow = check(problem, np.full(5, 9.0))
    assert slow.verdict is slow.limits is Verdict.PASS
    assert slow.continuous
    assert slow.feasible_time == pytest.approx(45.0)


def test_the_verdict_about_limits_stands_beside_the_jumps() -> None:
    problem, h = uniform("stretched", 11)
    slow, fast = check(problem, 9 * h), check(problem, 0.1 * h)
    assert (slow.verdict, slow.limits) == (Verdict.DISCONTINUOUS, Verdict.PASS)
    assert (fast.verdict, fast.limits) == (Verdict.VIOLATED, Verdict.VIOLATED)
    assert slow.jumps
    assert len(fast.jumps) == len(slow.jumps)
    assert slow.feasible_time is None
    assert "jumps at a break" in str(slow.feasible_why)
    assert "limits, apart from jumps: pass" in str(slow)
    assert "jumps           24, the largest of velocity by" in str(slow)


# --- (b) timed ------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(3))
def test_derivatives_in_time_are_finite_differences_of_an_independent_inversion(seed: int) -> None:
    problem, h = uniform("timed", seed)
    other = ByScipy(problem.waypoints, h)
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


@pytest.mark.parametrize("seed", range(3))
def test_peaks_are_those_of_dense_samples(seed: int) -> None:
    problem, h = uniform("timed", seed)
    other = ByScipy(problem.waypoints, h)
    # Jerk jumps at the knots: their left sides count too.
    e = np.concatenate([np.linspace(0, 5, 200001)[:-1], np.nextafter(np.arange(1, 6), 0)])
    q1, q2, q3 = (other.q(e, r) for r in (1, 2, 3))
    t1, t2, t3 = (other.t(e, r) for r in (1, 2, 3))
    velocity, acceleration = q1 / t1, (q2 * t1 - q1 * t2) / t1**3
    n2, n2_slope = q2 * t1 - q1 * t2, q3 * t1 - q1 * t3
    jerk = (n2_slope * t1 - 3 * n2 * t2) / t1**5
    sampled = np.array([np.abs(x).max(axis=0) for x in (velocity, acceleration, jerk)]).T
    exact = evaluate(problem, h[None]).ratios[0] * problem.limits.derivatives
    assert (sampled <= exact * (1 + 1e-12)).all()
    np.testing.assert_allclose(sampled, exact, rtol=1e-6)


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


@pytest.mark.parametrize("time", TIMES)
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
