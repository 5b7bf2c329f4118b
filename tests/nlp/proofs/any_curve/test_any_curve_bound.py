"""The optimum over all C1 curves: closed forms, brute force, a linear program, and identities."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linprog, minimize_scalar
from support.any_motions import PUMA_PROBLEM, verified
from support.joint_splines import rest_to_rest_time, spline_problem
from support.puma import PUMA
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.reach import furthest, profile, reachable
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    rest_to_rest,
    three_five_three,
)

Array = NDArray[np.float64]


# --- closed forms ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("velocity", "acceleration"), [(9.0, 8.0), (0.7, 8.0), (np.inf, 2.5)])
@pytest.mark.parametrize("step", [1.4, -0.3])
def test_two_waypoints(velocity: float, acceleration: float, step: float) -> None:
    problem = spline_problem([0.3, 0.3 + step], velocity, acceleration)
    total = verified(problem, estimate_any_curve(problem))
    assert total == pytest.approx(rest_to_rest_time(step, velocity, acceleration), rel=1e-9)


@pytest.mark.parametrize("middle", [0.01, 0.4, 1.25])
@pytest.mark.parametrize("velocity", [9.0, 1.1])
def test_a_waypoint_on_the_way_costs_nothing(middle: float, velocity: float) -> None:
    problem = spline_problem([0.2, 0.2 + middle, 1.5], velocity, 4.0)
    total = verified(problem, estimate_any_curve(problem))
    assert total == pytest.approx(rest_to_rest_time(1.3, velocity, 4.0), rel=1e-8)


def test_there_and_back_stops_at_the_turning_point() -> None:
    problem = spline_problem([0.2, 1.5, -0.1], 1.7, 4.0)
    found = estimate_any_curve(problem)
    expected = rest_to_rest_time(1.3, 1.7, 4.0) + rest_to_rest_time(1.6, 1.7, 4.0)
    assert verified(problem, found) == pytest.approx(expected, rel=1e-8)
    assert found.nodal_velocities == pytest.approx(0.0, abs=1e-5)
    assert found.attained


def test_free_end_velocities() -> None:
    # Flat out from way-point to way-point; with a limit only on acceleration v0 would be endless.
    problem = spline_problem([0.2, 1.5], 1.7, 4.0, ends=())
    assert verified(problem, estimate_any_curve(problem)) == pytest.approx(1.3 / 1.7, rel=1e-9)


@pytest.mark.parametrize(("first", "last"), [(0.5, 0.9), (-0.8, 0.0), (1.2, -1.2)])
def test_prescribed_end_velocities(first: float, last: float) -> None:
    a, d = 4.0, 1.3
    interpolant = Interpolant((3,), (), (((1, first),), ((1, last),)))
    problem = Problem([[0.2], [0.2 + d]], Limits(50.0, a), interpolant)
    # Accelerate to p, brake to the end: (2p² − v0² − v1²)/2a = d.
    peak = np.sqrt((2 * a * d + first**2 + last**2) / 2)
    found = estimate_any_curve(problem)
    assert verified(problem, found) == pytest.approx((2 * peak - first - last) / a, rel=1e-9)
    assert found.nodal_velocities[:, 0] == pytest.approx([first, last], abs=1e-15)


def test_rest_at_waypoints_of_the_interpolant_is_not_asked_for() -> None:
    smooth = estimate_any_curve(PUMA_PROBLEM)
    stopping = estimate_any_curve(replace(PUMA_PROBLEM, curve=rest_to_rest(3, 5)))
    assert stopping.total_time == pytest.approx(smooth.total_time, rel=1e-9)


def test_the_slowest_joint_decides() -> None:
    problem = spline_problem([[0.0, 1.0], [0.5, 0.4], [0.9, -0.5]], [2.0, 9.0], [50.0, 1.5])
    total = verified(problem, estimate_any_curve(problem))
    assert total == pytest.approx(rest_to_rest_time(1.5, 9.0, 1.5), rel=1e-8)


# --- velocity limits only -------------------------------------------------------------------------


def test_velocity_limits_only() -> None:
    velocity = np.array([1.5, 0.4, 2.0, 3.0, 0.7, 1.1])
    found = estimate_any_curve(Problem(PUMA, Limits(velocity), three_five_three()))
    expected = (np.abs(np.diff(PUMA, axis=0)) / velocity).max(axis=1)
    assert found.durations == pytest.approx(expected, rel=1e-15)
    assert found.total_time == pytest.approx(expected.sum(), rel=1e-15)
    assert not found.attained
    assert found.why is not None
    assert found.why.startswith("only velocity is limited")
    assert np.isnan(found.nodal_velocities).all()


def test_velocity_limits_only_may_be_attained() -> None:
    assert estimate_any_curve(spline_problem([0.0, 1.0, 3.0], 2.0, ends=())).attained
    assert not estimate_any_curve(spline_problem([0.0, 1.0, 3.0], 2.0)).attained
    assert not estimate_any_curve(spline_problem([0.0, 1.0, 0.0], 2.0, ends=())).attained
    assert estimate_any_curve(spline_problem([0.0, 1.0, 0.0], 2.0, duration_lower=0.6)).attained


def test_a_joint_without_acceleration_limit_only_needs_its_speed() -> None:
    q = np.array([[0.0, 0.3], [0.5, 1.9], [0.2, 0.1]])
    problem = spline_problem(q, [3.0, 1.5], [6.0, np.inf])
    found = estimate_any_curve(problem)
    both = verified(problem, found)
    floor = np.abs(np.diff(q[:, 1])) / 1.5
    alone = spline_problem(q[:, :1], 3.0, 6.0, duration_lower=floor)
    assert both == pytest.approx(verified(alone, estimate_any_curve(alone)), rel=1e-9)
    assert np.isnan(found.nodal_velocities[:, 1]).all()


# --- second routes --------------------------------------------------------------------------------


def double_integrator_time(step: float, v0: float, v1: float, vmax: float, a: float) -> float:
    """Least time of one joint between two states: bang, cruise at the limit, bang."""
    sign = 1.0 if step >= (v0 + v1) / 2 * abs(v1 - v0) / a else -1.0
    d, s, e = sign * step, sign * v0, sign * v1
    peak = min(vmax, np.sqrt(max(0.0, a * d + (s**2 + e**2) / 2)))
    ramps = (2 * peak**2 - s**2 - e**2) / (2 * a)
    return (2 * peak - s - e) / a + (d - ramps) / peak


@pytest.mark.parametrize(
    "waypoints", [[0.1, 0.9, 0.7, 1.6], [0.0, 0.4, 1.9, 2.1], [0.3, -0.5, 0.8, 0.6]]
)
@pytest.mark.parametrize("velocity", [1.4, 6.0])
def test_one_joint_against_a_grid_of_nodal_velocities(
    waypoints: list[float], velocity: float
) -> None:
    problem = spline_problem(waypoints, velocity, 3.0)
    total = verified(problem, estimate_any_curve(problem))
    v = np.linspace(-1.0, 1.0, 301) * min(velocity, 2.5)
    steps = np.diff(waypoints)
    time = np.vectorize(double_integrator_time, otypes=[float])
    first = time(steps[0], 0.0, v, velocity, 3.0)
    last = time(steps[2], v, 0.0, velocity, 3.0)
    grid = first[:, None] + time(steps[1], v[:, None], v[None], velocity, 3.0) + last[None]
    assert total <= grid.min() * (1 + 1e-9)
    assert total == pytest.approx(grid.min(), rel=1e-2)


def least_excess(problem: Problem, durations: ArrayLike, cells: int) -> float:
    """Least factor on V and A² with which sampled velocities pass all way-points in time."""
    worst = 0.0
    for j in range(problem.waypoints.shape[1]):
        h = np.repeat(np.asarray(durations) / cells, cells)
        n = h.size
        # Unknowns: velocities at the n + 1 corners, and the factor.
        ramps = (np.eye(n + 1)[1:] - np.eye(n + 1)[:-1]) / h[:, None]
        rows, v, a = [], problem.limits.velocity[j], problem.limits.acceleration[j]
        for sign in (1.0, -1.0):
            rows.append(np.column_stack([sign * np.eye(n + 1), np.full(n + 1, -v)]))
            rows.append(np.column_stack([sign * ramps, np.full(n, -a)]))
        areas = np.zeros((problem.segments + 2, n + 2))
        for k in range(problem.segments):
            for i in range(k * cells, (k + 1) * cells):
                areas[k, i : i + 2] += h[i] / 2
        areas[-2, 0] = areas[-1, n] = 1.0
        found = linprog(
            np.eye(n + 2)[-1],
            A_ub=np.vstack(rows),
            b_ub=np.zeros(4 * n + 2),
            A_eq=areas,
            b_eq=np.concatenate([np.diff(problem.waypoints[:, j]), [0.0, 0.0]]),
            bounds=(None, None),
        )
        worst = max(worst, float(found.fun))
    return worst


def test_two_joints_against_a_linear_program() -> None:
    # With velocities sampled at many corners, feasibility of given durations is a linear program;
    # the best share of the time for the first segment is then searched on one axis.
    q = np.array([[0.0, 0.4], [0.8, -0.1], [0.3, -1.5]])
    problem = spline_problem(q, [1.6, 1.2], [4.0, 3.0])
    found = estimate_any_curve(problem)
    total = verified(problem, found)
    cells = 24

    def excess(share: float) -> float:
        return least_excess(problem, total * np.array([share, 1 - share]), cells)

    assert found.durations is not None
    best = minimize_scalar(excess, bounds=(0.2, 0.7), method="bounded", options={"xatol": 1e-4})
    assert 1.0 - 1e-9 <= best.fun <= 1.01
    assert best.x == pytest.approx(found.durations[0] / total, abs=0.01)


speeds = st.floats(-1.0, 1.0)


@settings(max_examples=60, deadline=None)
@given(speeds, speeds, st.floats(0.05, 3.0), st.floats(0.0, 1.0))
def test_reachable_displacements_have_a_curve(v0: float, v1: float, h: float, share: float) -> None:
    limits = np.array(1.0), np.array(2.0)
    at = np.array(v0), np.array(v1), np.array(h)
    up = float(furthest(*at, *limits))
    down = -float(furthest(-at[0], -at[1], at[2], *limits))
    if abs(v1 - v0) > 2.0 * h:
        assert up == -np.inf
        assert not reachable(np.array(0.0), *at, *limits)
        return
    assert down <= up
    step = down + share * (up - down)
    curve = profile(step, v0, v1, h, 1.0, 2.0)
    assert curve.displacement == pytest.approx(step, abs=1e-12)
    assert curve.velocity[[0, -1]] == pytest.approx([v0, v1], abs=1e-12)
    assert curve.peak_speed <= 1.0 + 1e-12
    low, high = curve.position_range()
    times = np.linspace(0, h, 4001)
    v = np.interp(times, curve.time, curve.velocity)
    path = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(times))])
    assert low == pytest.approx(path.min(), abs=1e-5)
    assert high == pytest.approx(path.max(), abs=1e-5)
    for beyond in (up + 1e-9, down - 1e-9):
        assert not reachable(np.array(beyond), *at, *limits)
    # No sampled admissible motion goes further: the pointwise bound on the velocity.
    top = np.minimum.reduce([v0 + 2 * times, v1 + 2 * (h - times), np.ones_like(times)])
    assert up == pytest.approx(np.trapezoid(top, times), abs=1e-5)
