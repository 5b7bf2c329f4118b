"""The uniform cubic B-spline under both readings of time, by routes that share no code with it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from support.b_splines import NATURAL, spline_by_scipy, uniform, vertices_by_solving
from trajgap.heuristics import PSO, run, uniform_rescaling
from trajgap.problem import (
    Limits,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    control_vertices,
    fit,
    solve_in_closed_form,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves.stretched import segment_peaks
from trajgap.problem.curves.uniform_matrices import clock_matrix, shape_matrix, vertex_matrix

TIMES = (*Timing, NATURAL)


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
def test_heuristics_and_baseline_take_it(time: str) -> None:
    problem, _ = uniform(time, 7, count=4, joints=2)
    bounded = replace(problem, duration_lower=0.2, duration_upper=6.0)
    found = run(PSO(particles=20, iterations=30, position_initial=(0.3, 6.0)), bounded, seed=3)
    assert found.feasible
    assert check(bounded, found.durations).limits is Verdict.PASS
    equal = uniform_rescaling(problem)
    assert check(problem, equal).stretch == pytest.approx(1.0, rel=1e-12)


def test_declarations_are_checked() -> None:
    with pytest.raises(
        TrajgapError, match=r"interpolant.time: 'both' is unknown; use stretched or"
    ):
        uniform_cubic_b_spline(5, "both")
    with pytest.raises(TrajgapError, match=r"interpolant.time_ends: goes with time = 'timed'"):
        uniform_cubic_b_spline(5, "stretched", natural_clock=True)
    for time in Timing:
        with pytest.raises(TrajgapError, match="at least two way-points are needed"):
            uniform_cubic_b_spline(1, time)
        assert len(uniform_cubic_b_spline(2, time).waypoint_breaks) == 2
    assert len(uniform_cubic_b_spline(2, "timed", natural_clock=True).waypoint_breaks) == 2
    with pytest.raises(TrajgapError, match="is no piecewise polynomial with breaks"):
        _ = uniform("timed")[0].piecewise
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


def test_curves_whose_time_ends_otherwise_are_told_apart() -> None:
    equal, natural = (uniform_cubic_b_spline(5, "timed", n) for n in (False, True))
    assert equal != natural
    assert natural.name == f"{equal.name}, with natural ends of time"


@pytest.mark.parametrize("count", [2, 3, 6])
def test_natural_vertices_meet_the_waypoint_equations_without_curvature_at_the_ends(
    count: int,
) -> None:
    v = vertex_matrix(count, natural=True)
    for i in range(count):
        row = [(a + 4 * b + c) / 6 for a, b, c in zip(*v[i : i + 3], strict=True)]
        assert row == [Fraction(int(k == i)) for k in range(count)]
    for ends in (v[:3], v[-3:]):
        assert [a - 2 * b + c for a, b, c in zip(*ends, strict=True)] == [0] * count
