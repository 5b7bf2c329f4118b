"""TOPPRA on paths of known answers, its order, the one-sided inequality and the second solver."""

import logging

import numpy as np
import pytest
import toppra
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BPoly, CubicSpline, PPoly
from scipy.optimize import brentq
from toppra.algorithm import TOPPRA
from toppra.constraint import (
    DiscretizationType,
    JointAccelerationConstraint,
    JointVelocityConstraint,
)
from trajgap.nlp import solve
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.nlp.retiming.path_nlp import path_nlp_duration
from trajgap.nlp.retiming.toppra_check import Retiming, extrapolate, retime, retime_joints
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    Trajectory,
    TrajgapError,
    check,
    cubic_spline,
    cubic_spline_virtual,
    extrema,
    fit,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.curves.spline import trajectory_from_scaled

Array = NDArray[np.float64]

# Way-points A, B, C, D of the six joints, and limits, as printed in doi 10.12677/mos.2024.136535.
PUMA = np.array(
    [
        [0.1885, 0.8168, 0.1257, -0.8796],
        [-1.6336, -2.0071, -1.0681, -1.0053],
        [0.2513, -0.3770, -1.0681, -0.3142],
        [0.3142, -0.0628, 0.4398, 0.8796],
        [0.1885, -0.1257, 0.2513, 0.5027],
        [0.3142, -0.1257, -0.1885, -0.2513],
    ]
).T
PUMA_LIMITS = Limits(6.0, 8.0, joints=6)
PUMA_353 = np.array([0.98201, 1.22974, 1.08496])
"""Optimal durations of the shared 3-5-3 problem, rounded up."""


def trajectory(coefficients: list[ArrayLike], durations: ArrayLike) -> Trajectory:
    """Segments from ascending coefficients in their own time, each of shape (powers, joints)."""
    h = np.asarray(durations, dtype=float)
    blocks = [np.asarray(c, dtype=float) for c in coefficients]
    scaled = np.zeros((h.size, 10, blocks[0].shape[1]))
    for k, c in enumerate(blocks):
        scaled[k, : len(c)] = c * h[k] ** np.arange(len(c))[:, None]
    return trajectory_from_scaled(scaled, tuple(len(c) - 1 for c in blocks), h)


def hermite(times: ArrayLike, nodes: ArrayLike) -> Trajectory:
    """Through position, velocity, ... at every time; nodes of shape (times, orders, joints)."""
    t, n = np.asarray(times, dtype=float), np.asarray(nodes, dtype=float)
    joints = [
        PPoly.from_bernstein_basis(BPoly.from_derivatives(t, list(n[:, :, j]))).c[::-1]
        for j in range(n.shape[2])
    ]
    return trajectory(
        [np.stack([c[:, k] for c in joints], 1) for k in range(t.size - 1)], np.diff(t)
    )


def rest_to_rest_time(distance: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike) -> float:
    """Trapezoid or triangle on the straight line along ``distance``, all joints together."""
    d = np.abs(np.asarray(distance, dtype=float))
    v = float(np.min(np.asarray(velocity) / d))
    a = float(np.min(np.asarray(acceleration) / d))
    return 1.0 / v + v / a if v**2 < a else 2.0 / np.sqrt(a)


def close(found: Retiming, expected: float) -> bool:
    assert found.applicable, found.why
    assert found.extrapolated is not None
    assert found.error is not None
    assert found.error < 1e-3 * expected
    return abs(found.extrapolated - expected) <= found.error


# --- paths of known answers -----------------------------------------------------------------------


@pytest.mark.parametrize(("velocity", "acceleration"), [(9.0, 8.0), (0.7, 8.0), (1.1, 2.5)])
@pytest.mark.parametrize("degree", [3, 5, 7])
def test_one_joint_there_and_back(velocity: float, acceleration: float, degree: int) -> None:
    q = np.array([[0.3], [1.7], [0.9]])
    found = retime(
        fit(rest_to_rest(2, degree), q, [1.5, 1.2]),
        Limits(velocity, acceleration, joints=1),
    )
    expected = sum(rest_to_rest_time([d], [velocity], [acceleration]) for d in (1.4, 0.8))
    assert close(found, expected)
    assert np.allclose(found.cuts, [0.0, 1.5, 2.7], atol=1e-9)


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


@pytest.mark.parametrize("degree", [3, 5, 7])
@pytest.mark.parametrize("velocity", [[3.0, 9.0, 2.0], [0.5, 9.0, 0.4]])
def test_straight_line(degree: int, velocity: list[float]) -> None:
    q = np.array([[0.2, -1.0, 3.0], [1.1, 1.5, 2.3]])
    acceleration = [4.0, 9.0, 6.0]
    found = retime(fit(rest_to_rest(1, degree), q, [2.0]), Limits(velocity, acceleration))
    assert close(found, rest_to_rest_time(q[1] - q[0], velocity, acceleration))


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


def test_rest_to_rest_quintic_through_corners() -> None:
    q = np.array([[0.1, 0.9, -0.3], [0.8, 0.2, -0.3], [0.9, -1.4, 0.5], [-0.2, -1.1, 0.1]])
    velocity, acceleration = [1.5, 1.9, 1.1], [4.0, 3.0, 5.0]
    found = retime(fit(rest_to_rest(3, 5), q, [1.0, 1.6, 1.3]), Limits(velocity, acceleration))
    steps = [np.where(step == 0, 1e-300, step) for step in np.diff(q, axis=0)]
    assert close(found, sum(rest_to_rest_time(d, velocity, acceleration) for d in steps))
    assert found.cuts == pytest.approx((0.0, 1.0, 2.6, 3.9), abs=1e-9)


def test_toppra_cpp_cubic_path() -> None:
    # toppra, cpp/tests/test_algorithm.cpp at 730aa8a, test OutputParmetrization: not-a-knot cubic
    # through these way-points at s = 0, 1, 2, 3; collocation on 51 points.
    printed = [
        0.0, 0.00799999, 0.01559927, 0.02295854, 0.03021812, 0.0375065, 0.04494723, 0.05266502,
        0.06079176, 0.06947278, 0.07887417, 0.08890758, 0.08734253, 0.08331795, 0.07962036,
        0.07621324, 0.0730652, 0.07014912, 0.06744149, 0.06492187, 0.06257243, 0.06037763,
        0.05832396, 0.05639983, 0.05459562, 0.05290406, 0.05132157, 0.04985237, 0.04852316,
        0.04745693, 0.04761904, 0.0285715, 0.05376003, 0.04275653, 0.04126188, 0.04013804,
        0.03912958, 0.03818766, 0.03729606, 0.0364472, 0.03563649, 0.03486069, 0.03411724,
        0.03340395, 0.03271895, 0.03206054, 0.02268897, 0.01495547, 0.00883489, 0.00394282, 0.0,
    ]  # fmt: skip
    knots, q = np.arange(4.0), np.array([[0, 0], [1, 3], [2, 4], [0, 0]], dtype=float)
    limits = ([1.0, 1.0], [0.2, 0.2])

    def reference(points: int, scheme: DiscretizationType) -> tuple[Array, float]:
        grid = np.linspace(0, 3, points)
        solver = TOPPRA(
            [JointVelocityConstraint(limits[0]), JointAccelerationConstraint(limits[1], scheme)],
            toppra.SplineInterpolator(knots, q),
            gridpoints=grid,
            solver_wrapper="seidel",
        )
        speed = np.asarray(solver.compute_parameterization(0, 0)[1])
        return speed, float(np.sum(2 * np.diff(grid) / (speed[1:] + speed[:-1])))

    speed, _ = reference(51, DiscretizationType.Collocation)
    assert np.allclose(speed**2, printed, atol=1e-6)
    x = np.sqrt(printed)
    table = float(np.sum(2 * 0.06 / (x[1:] + x[:-1])))
    spline = CubicSpline(knots, q)
    curve = trajectory([spline.c[::-1, k] for k in range(3)], [1.0, 1.0, 1.0])
    found = retime(curve, Limits(*limits), end_speeds=(0.0, 0.0))
    assert found.extrapolated == pytest.approx(table, rel=3e-2)
    _, fine = reference(6001, DiscretizationType.Interpolation)
    assert found.extrapolated == pytest.approx(fine, rel=5e-4)
    assert found.inequality_holds is None
    assert found.why == "the end speeds are not the trajectory's"
    second = path_nlp_duration(curve, Limits(*limits), 500, end_speeds=(0.0, 0.0))
    assert second == pytest.approx(found.durations[0], rel=1e-4)


# --- order, and the second solver -----------------------------------------------------------------


def puma(interpolant: Interpolant, durations: ArrayLike) -> Trajectory:
    return fit(interpolant, PUMA, durations)


def test_first_order_and_extrapolation_within_its_error() -> None:
    curve = puma(three_five_three(), PUMA_353)
    coarse = retime(curve, PUMA_LIMITS, gridpoints=(100, 200, 400))
    fine = retime(curve, PUMA_LIMITS, gridpoints=(2000, 4000, 8000))
    assert coarse.order is not None
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


@pytest.mark.parametrize("cells", [100, 400])
@pytest.mark.parametrize(
    ("interpolant", "durations"),
    [
        (three_five_three(), PUMA_353),
        (quintic_spline(3), [0.9, 0.8, 0.9]),
        (rest_to_rest(3, 5), [0.9, 1.1, 0.9]),
    ],
)
def test_two_solvers_agree_on_the_same_grid(
    interpolant: Interpolant, durations: ArrayLike, cells: int
) -> None:
    curve = puma(interpolant, durations)
    found = retime(curve, PUMA_LIMITS, gridpoints=(cells, 2 * cells, 4 * cells))
    assert path_nlp_duration(curve, PUMA_LIMITS, cells) == pytest.approx(
        found.durations[0], rel=3e-5
    )


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


def test_solved_trajectories_keep_the_inequality() -> None:
    for interpolant in (three_five_three(), piecewise((5, 5, 5), 2)):
        problem = Problem(PUMA, PUMA_LIMITS, interpolant)
        solution = solve(problem)
        assert solution.durations is not None
        curve = fit(interpolant, PUMA, solution.durations, solution.nodal)
        found = retime(curve, PUMA_LIMITS)
        assert found.inequality_holds
        assert found.extrapolated < solution.total_time


def test_no_inequality_for_a_trajectory_that_breaks_its_limits() -> None:
    found = retime(puma(three_five_three(), 0.5 * PUMA_353), PUMA_LIMITS)
    assert found.applicable
    assert found.inequality_holds is None
    assert found.why is not None
    assert found.why.startswith("the trajectory exceeds a limit itself (ratio 3.99")


def test_no_inequality_on_grids_that_are_too_coarse() -> None:
    found = retime(puma(three_five_three(), PUMA_353), PUMA_LIMITS, gridpoints=(2, 3, 4))
    assert found.applicable
    assert found.inequality_holds is None
    assert found.why is not None
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


def test_permuted_mirrored_reversed_and_rescaled() -> None:
    h = np.array([0.9, 0.8, 1.1])
    limits = Limits(np.linspace(2, 4, 6), np.linspace(5, 9, 6))
    base = retime(fit(quintic_spline(3), PUMA, h), limits)
    order = np.array([3, 0, 5, 1, 4, 2])
    turned = Limits(limits.velocity[order], limits.acceleration[order])
    assert close(retime(fit(quintic_spline(3), PUMA[:, order], h), turned), base.extrapolated)
    assert close(retime(fit(quintic_spline(3), 1.0 - PUMA, h), limits), base.extrapolated)
    assert close(retime(fit(quintic_spline(3), PUMA[::-1], h[::-1]), limits), base.extrapolated)
    faster = Limits(3 * limits.velocity, 9 * limits.acceleration)
    assert close(retime(fit(quintic_spline(3), PUMA, h), faster), base.extrapolated / 3)


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


def test_segments_in_which_nothing_moves_are_left_out() -> None:
    q = np.array([[0.0, 0.3], [1.0, 0.5], [1.0, 0.5], [0.2, -1.0]])
    limits = Limits([2.0, 3.0], [8.0, 5.0])
    for degree in (3, 5, 7):
        found = retime(fit(rest_to_rest(3, degree), q, [1.0, 0.4, 1.5]), limits)
        expected = sum(
            rest_to_rest_time(q[k + 1] - q[k], limits.velocity, limits.acceleration) for k in (0, 2)
        )
        assert close(found, expected)
        assert found.cuts == pytest.approx((0.0, 1.0, 1.4, 2.9), abs=1e-9)


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
        (Limits([6, 6, 0, 6, 6, 6], 8.0), "joint 3 moves, but its velocity limit is 0"),
        (Limits(6.0, [8, 0, 8, 8, 8, 8]), "joint 2 moves, but its acceleration limit is 0"),
    ],
)
def test_not_applicable_by_limits(limits: Limits, why: str) -> None:
    curve = puma(three_five_three(), PUMA_353)
    found = retime(curve, limits)
    assert not found.applicable
    assert found.why is not None
    assert found.why.startswith(why)
    assert found.extrapolated is None
    assert found.durations == ()
    assert why in str(found)
    with pytest.raises(TrajgapError, match=f"path NLP: not applicable, {why}"):
        path_nlp_duration(curve, limits)


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
    second = path_nlp_duration(curve, Limits([6.0, 0.0, 6.0], [8.0, 0.0, 8.0]), 500)
    assert second == pytest.approx(found.durations[0], rel=3e-5)


def test_not_applicable_by_shape() -> None:
    limits = Limits(6.0, 8.0, joints=1)
    lines = trajectory([[[0.0], [1.0]], [[1.0], [-1.0]]], [1.0, 1.0])
    assert retime(lines, limits).why == "the velocity of joint 1 jumps by -2 at break 1"
    gap = trajectory([[[0.0], [1.0]], [[1.5], [1.0]]], [1.0, 1.0])
    assert retime(gap, limits).why == "the position of joint 1 jumps by 0.5 at break 1"
    still = trajectory([[[0.4], [0.0]]], [1.0])
    assert retime(still, limits).why == "nothing moves"


def test_end_speeds_that_cannot_be_reached() -> None:
    curve = puma(three_five_three(), PUMA_353)
    found = retime(curve, PUMA_LIMITS, end_speeds=(1000.0, 0.0))
    assert not found.applicable
    assert found.why == "TOPPRA found no parametrisation of piece 1 on 500 cells"


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
