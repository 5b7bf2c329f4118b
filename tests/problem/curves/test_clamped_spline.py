"""Clamped B-splines: counts, knots and curves by routes that share no code with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline
from support.b_splines import clamped
from trajgap.problem import (
    ClampedBSpline,
    Count,
    CurveError,
    Parameters,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    clamped_control_points,
    clamped_readings,
    evaluate,
    fit,
    piecewise,
    quintic_spline,
    solve_in_closed_form,
)
from trajgap.problem.curves.clamped_knots import average_matrix

KINDS = [
    (degree, knots, parameters, time)
    for degree in range(3, 8)
    for knots in ("waypoints", "averaged-continued")
    for parameters in (Parameters.TIMES, Parameters.CHORD, Parameters.JOINT_CHORD)
    for time in Timing
    if (degree == 5 or knots != "waypoints") and (parameters, time) != ("times", "stretched")
]
each_kind = pytest.mark.parametrize("kind", KINDS, ids=lambda k: "-".join(map(str, k)))


def printed_knots(degree: int, u: np.ndarray, repeats: int) -> np.ndarray:
    """(6) written as a loop over its index, on parameters repeated at the ends."""
    sites = [u[0]] * repeats + list(u) + [u[-1]] * repeats
    n = len(sites) - 1
    inner = [sum(sites[i] for i in range(j, j + degree)) / degree for j in range(1, n - degree + 1)]
    return np.array([u[0]] * (degree + 1) + inner + [u[-1]] * (degree + 1))


def by_scipy(q: np.ndarray, sites: np.ndarray, knots: np.ndarray, degree: int) -> BSpline:
    """Way-points at the sites, first and second derivative 0 at both ends, by scipy's bases."""
    size = len(knots) - degree - 1
    matrix = np.zeros((len(q) + 4, size))
    for i in range(size):
        unit = BSpline(knots, np.eye(size)[i], degree)
        # scipy takes the last knot from the right; the last piece continues there.
        matrix[: len(q), i] = unit(sites)
        matrix[len(q) :, i] = [unit(x, r) for x in (sites[0], sites[-1]) for r in (1, 2)]
    right = np.vstack([q, np.zeros((4, q.shape[1]))])
    return BSpline(knots, np.linalg.solve(matrix, right), degree)


def chords(q: np.ndarray) -> np.ndarray:
    """(4) and (5) as a loop."""
    lengths = [float(np.sqrt(((q[k] - q[k - 1]) ** 2).sum())) for k in range(1, len(q))]
    u = [0.0]
    for length in lengths:
        u.append(u[-1] + length / sum(lengths))
    return np.array(u)


def independent(problem: Problem, h: np.ndarray, joint: int) -> tuple[BSpline, np.ndarray]:
    """One joint's spline in its parameter, and the parameter of each way-point."""
    curve, q = problem.curve, problem.waypoints
    assert isinstance(curve, ClampedBSpline)
    times = np.concatenate([[0.0], np.cumsum(h)])
    along = {"chord": chords(q), "joint-chord": chords(q[:, [joint]])}
    u = times if curve.parameters == "times" else along[curve.parameters]
    sites = u if curve.time == "stretched" else times
    scale = sites[-1] / u[-1]
    if curve.knots == "waypoints":
        p = curve.degree
        knots = np.concatenate([[0] * (p + 1), scale * u[1:-1], [sites[-1]] * (p + 1)])
    else:
        knots = printed_knots(curve.degree, scale * u, 2)
    return by_scipy(q[:, [joint]], sites, knots, curve.degree), sites


# --- counts ---------------------------------------------------------------------------------------


def test_the_count_decides_which_readings_are_determined() -> None:
    found = {(r.degree, r.knots, r.parameters, r.time): r for r in clamped_readings(8)}
    assert len(found) == 5 * 3 * 5
    for (degree, knots, _, _), reading in found.items():
        points = {"waypoints": 7 + degree, "averaged": 8, "averaged-continued": 12}[knots]
        assert (reading.conditions, reading.control_points) == (12, points)
        word = {0: Count.DETERMINED, 1: Count.UNDER, -1: Count.OVER}[int(np.sign(points - 12))]
        assert reading.count is word
        assert (reading.curve is not None) == (word is Count.DETERMINED)
        assert f"12 conditions on {points} control points" in reading.words
        assert ("impossible" in reading.words) == (knots == "averaged")
        if word is not Count.DETERMINED:
            assert "continue" in reading.words
    determined = [k for k, r in found.items() if r.count is Count.DETERMINED]
    assert {degree for degree, knots, _, _ in determined if knots == "waypoints"} == {5}
    assert {degree for degree, knots, _, _ in determined if knots != "waypoints"} == {3, 4, 5, 6, 7}
    assert (
        "degree 5, knots averaged, parameters times, timed: impossible as the text has it"
        in str(found[5, "averaged", "times", "timed"])
    )


@pytest.mark.parametrize(("degree", "free"), [(6, 1), (7, 2)])
def test_what_knots_at_the_waypoints_leave_free_is_a_declared_polynomial(degree, free) -> None:
    assert piecewise((degree,) * 7, degree - 1).free == free
    words = next(r.words for r in clamped_readings(8, degrees=(degree,)) if r.count is Count.UNDER)
    assert f"{free} left free per joint" in words
    assert f"free = {free}" in words


def test_the_literal_rule_is_determined_without_end_conditions() -> None:
    curve = ClampedBSpline(8, 5, "averaged", "times", end_orders=())
    rng = np.random.default_rng(1)
    q, h = rng.normal(size=(8, 2)) + 3, rng.uniform(0.8, 1.2, 7)
    times = np.concatenate([[0.0], np.cumsum(h)])
    other = make_interp_spline(times, q, k=5, t=printed_knots(5, times, 0))
    t = np.linspace(0, times[-1], 101)[:-1]
    np.testing.assert_allclose(fit(curve, q, h)(t), other(t), rtol=0, atol=1e-11)


def test_other_end_conditions_are_counted_too() -> None:
    assert [r.degree for r in clamped_readings(6, (1,)) if r.knots == "waypoints" and r.curve] == [
        3
    ] * 5
    curve = ClampedBSpline(6, 3, "waypoints", "times", end_orders=(1,))
    rng = np.random.default_rng(2)
    q, h = rng.normal(size=(6, 2)) + 3, rng.uniform(0.8, 1.2, 5)
    times = np.concatenate([[0.0], np.cumsum(h)])
    other = make_interp_spline(times, q, k=3, bc_type="clamped")
    t = np.linspace(0, times[-1], 101)[:-1]
    np.testing.assert_allclose(fit(curve, q, h)(t, 1), other(t, 1), rtol=0, atol=1e-11)


def test_few_waypoints() -> None:
    with pytest.raises(TrajgapError, match="at least two way-points"):
        clamped_readings(1)
    words = next(r.words for r in clamped_readings(3, degrees=(7,)) if r.knots == "averaged")
    assert words.startswith("impossible as the text has it: degree 7 needs more way-points")
    two = ClampedBSpline(2, 5, "averaged-continued", "times")
    assert two.inner_knots == 0
    q = np.array([[0.3], [1.5]])
    trajectory = fit(two, q, [2.0])
    quintic = fit(quintic_spline(1), q, [2.0])
    t = np.linspace(0, 2, 21)
    np.testing.assert_allclose(trajectory(t), quintic(t), rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"degree": 3}, "over-determined, 12 conditions on 10 control points; with knots at the"),
        ({"degree": 7}, "under-determined, 12 conditions on 14 control points; with knots at the"),
        ({"knots": "averaged"}, "over-determined, 12 conditions on 8 control points; continue"),
        ({"knots": "averaged", "waypoints": 4}, "degree 5 needs at least 6 way-points; lower the"),
        ({"degree": 2}, "interpolant.degree: must lie in 3..7, got 2"),
        ({"degree": 8}, "interpolant.degree: must lie in 3..7, got 8"),
        ({"waypoints": 1}, "at least two way-points"),
        ({"knots": "uniform"}, "interpolant.knots: 'uniform' is unknown; use one of waypoints, av"),
        ({"parameters": "time"}, "interpolant.parameters: 'time' is unknown; use one of times, ch"),
        ({"time": "slow"}, "interpolant.time: 'slow' is unknown; use one of stretched, timed"),
        ({"time": "stretched"}, "parameters from the times are times already"),
        ({"end_orders": (1, 1)}, "orders must be distinct and lie in 1..degree − 1"),
        ({"end_orders": (1, 5)}, "orders must be distinct and lie in 1..degree − 1"),
        ({"fractions": ((0.0, 1.0),)}, "interpolant.fractions: expected 8 numbers from 0 to 1"),
    ],
)
def test_what_cannot_be_declared(change, message) -> None:
    given = {"waypoints": 8, "degree": 5, "knots": "waypoints", "parameters": "times"}
    with pytest.raises(TrajgapError) as caught:
        ClampedBSpline(**(given | change))
    assert message in str(caught.value)


# --- curves ---------------------------------------------------------------------------------------


@each_kind
def test_the_curve_is_scipys(kind) -> None:
    problem, h = clamped(kind)
    trajectory = fit(problem.curve, problem.waypoints, h)
    nodes = np.concatenate([[0.0], np.cumsum(h)])
    np.testing.assert_allclose(trajectory(nodes), problem.waypoints, rtol=0, atol=1e-11)
    rng = np.random.default_rng(9)
    t = np.sort(rng.uniform(0, nodes[-1] * (1 - 1e-9), 200))
    stretched = problem.curve.time is Timing.STRETCHED
    for joint in range(3):
        spline, sites = independent(problem, h, joint)
        u = np.interp(t, nodes, sites) if stretched else t
        np.testing.assert_allclose(trajectory(t)[:, joint], spline(u)[:, 0], rtol=0, atol=1e-10)
        if stretched:
            k = np.searchsorted(nodes, t, side="right") - 1
            speed = (np.diff(sites) / h)[k]
        else:
            speed = np.ones_like(t)
        for order in (1, 2):
            expected = spline(u, order)[:, 0] * speed**order
            found = trajectory(t, order)[:, joint]
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8)


@pytest.mark.parametrize("count", [3, 5, 8])
def test_degree_5_at_the_waypoints_is_the_quintic_spline(count: int) -> None:
    problem, h = clamped((5, "waypoints", "times", "timed"), 3, count)
    q = problem.waypoints
    t = np.linspace(0, h.sum(), 301)[:-1]
    times = np.concatenate([[0.0], np.cumsum(h)])
    zero = np.zeros(3)
    ends = [(1, zero), (2, zero)]
    scipys = make_interp_spline(times, q, k=5, bc_type=(ends, ends))
    declared = fit(quintic_spline(count - 1), q, h)
    found = fit(problem.curve, q, h)
    for order in range(4):
        np.testing.assert_allclose(found(t, order), scipys(t, order), rtol=0, atol=1e-10)
        np.testing.assert_allclose(found(t, order), declared(t, order), rtol=0, atol=1e-10)
    other = check(replace(problem, curve=quintic_spline(count - 1)), h)
    assert check(problem, h).stretch == pytest.approx(other.stretch, rel=1e-12)


@each_kind
def test_rest_at_the_ends_and_continuity(kind) -> None:
    problem, h = clamped(kind, 4)
    trajectory = fit(problem.curve, problem.waypoints, h)
    last = len(trajectory.durations) - 1
    for joint in range(3):
        for order in (1, 2):
            assert trajectory.derivative(0, joint, order)[0] == pytest.approx(0, abs=1e-10)
            assert trajectory.derivative(last, joint, order).sum() == pytest.approx(0, abs=1e-8)
    verdict = check(problem, 9 * h)
    assert verdict.limits is Verdict.PASS
    assert verdict.continuous == (kind[3] == "timed")
    assert (verdict.verdict is Verdict.DISCONTINUOUS) == (kind[3] == "stretched")
    if kind[3] == "stretched":
        # Six via-points, three joints, velocity and acceleration; knots inside are smooth.
        assert len(verdict.jumps) == 6 * 3 * 2
        times = {round(jump.time, 9) for jump in verdict.jumps}
        assert times == {round(t, 9) for t in np.cumsum(9 * h)[:-1]}


def test_average_matrix_is_the_printed_sum() -> None:
    u = np.array([0.0, 0.1, 0.35, 0.4, 0.7, 1.0])
    for degree in (3, 4, 5):
        curve = ClampedBSpline(6, degree, "averaged-continued", "times")
        expected = printed_knots(degree, u, 2)[degree + 1 : -degree - 1]
        np.testing.assert_allclose(average_matrix(curve) @ u, expected, rtol=1e-14)
    literal = ClampedBSpline(6, 3, "averaged", "times", end_orders=())
    expected = [(u[1] + u[2] + u[3]) / 3, (u[2] + u[3] + u[4]) / 3]
    np.testing.assert_allclose(average_matrix(literal) @ u, expected, rtol=1e-14)


@each_kind
def test_control_points_are_those_of_scipys_basis(kind) -> None:
    if kind[3] == "stretched":
        return
    problem, h = clamped(kind, 10)
    control, knots = clamped_control_points(problem.curve, problem.waypoints, h)
    assert control.shape == (12, 3)
    for joint in range(3):
        spline, _ = independent(problem, h, joint)
        np.testing.assert_allclose(knots[:, joint], spline.t, rtol=0, atol=1e-12)
        np.testing.assert_allclose(control[:, joint], spline.c[:, 0], rtol=0, atol=1e-9)


def test_closed_form_of_a_stretched_chord_curve() -> None:
    for parameters in ("chord", "joint-chord"):
        problem, _ = clamped((4, "averaged-continued", parameters, "stretched"), 11)
        h = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
        assert check(problem, h).stretch == pytest.approx(1.0, rel=1e-12)
        for k in range(7):
            shorter = h.copy()
            shorter[k] *= 1 - 1e-6
            assert check(problem, shorter).limits is Verdict.VIOLATED


# --- what is refused ------------------------------------------------------------------------------


def test_durations_far_from_the_chords_define_no_curve() -> None:
    problem, h = clamped((3, "averaged-continued", "chord", "timed"), 12)
    far = h.copy()
    far[0], far[1] = 60.0, 0.001
    assert np.isinf(evaluate(problem, far[None]).stretch[0])
    with pytest.raises(CurveError, match=r"no clamped B-spline .* passes the way-points at these"):
        fit(problem.curve, problem.waypoints, far)
    verdict = check(problem, far)
    assert verdict.verdict is Verdict.VIOLATED
    assert verdict.worst is not None
    assert verdict.worst.quantity == "curve"
    assert "Schoenberg" not in str(verdict.feasible_why)


def test_chords_need_waypoints_that_differ() -> None:
    problem, h = clamped((5, "averaged-continued", "chord", "timed"), 13)
    still = problem.waypoints.copy()
    still[4] = still[3]
    with pytest.raises(TrajgapError, match="waypoints: 3 and 4 coincide, chord parameters do not"):
        fit(problem.curve, still, h)
