"""Coefficients by other routes: scipy's splines, the papers' 14×14 system, rational arithmetic."""

import importlib.util
from fractions import Fraction
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BPoly, make_interp_spline
from support.checkout import ROOT
from support.samples import DECLARATIONS, FREE, sample_problem
from support.splines_drawn import exact_scaled, waypoints
from trajgap.problem import (
    Interpolant,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    fit,
    quintic_spline,
    quintic_spline_virtual,
    rest_to_rest,
    septic_spline,
    three_five_three,
)
from trajgap.problem.curves.refined import refined_coefficients
from trajgap.problem.curves.spline import coefficients

BREAKS = (0.0, 0.7, 1.2, 2.6, 2.9, 4.4, 5.1, 6.7)


def same_curve(trajectory: object, reference: object, orders: range, times: np.ndarray) -> None:
    for order in orders:
        mine = trajectory(times, order)  # type: ignore[operator]
        other = reference(times, order)  # type: ignore[operator]
        np.testing.assert_allclose(mine, other, atol=1e-10 * max(1.0, np.abs(other).max()))


def inside(breaks: tuple[float, ...]) -> np.ndarray:
    """Times away from the breaks, where the highest derivative jumps."""
    a, b = np.array(breaks[:-1]), np.array(breaks[1:])
    return np.concatenate([a + (b - a) * f for f in (0.01, 0.2, 0.41, 0.66, 0.99)])


def test_quintic_is_scipys() -> None:
    q = waypoints(8)
    rest = [(1, np.zeros(3)), (2, np.zeros(3))]
    reference = make_interp_spline(BREAKS, q, k=5, bc_type=(rest, rest))
    mine = fit(quintic_spline(7), q, np.diff(BREAKS))
    same_curve(mine, reference, range(6), inside(BREAKS))
    same_curve(mine, reference, range(5), np.array(BREAKS))


def test_clamped_cubic_is_scipys() -> None:
    q = waypoints(8)
    reference = make_interp_spline(BREAKS, q, k=3, bc_type="clamped")
    mine = fit(cubic_spline(7), q, np.diff(BREAKS))
    same_curve(mine, reference, range(4), inside(BREAKS))


@pytest.mark.parametrize("seed", range(20))
def test_random_durations_give_scipys_splines(seed: int) -> None:
    """Value and every continuous derivative, relative to its largest; durations within 1 : 30."""
    rng = np.random.default_rng([20260304, seed])
    n = int(rng.integers(3, 12))
    h = 10.0 ** rng.uniform(-0.9, 0.5, n)
    t = np.concatenate([[0.0], np.cumsum(h)])
    q = waypoints(n + 1, seed)
    rest = [(1, np.zeros(3)), (2, np.zeros(3))]
    times = np.sort(np.concatenate([t, rng.uniform(0.0, t[-1], 200)]))
    same_curve(
        fit(quintic_spline(n), q, h),
        make_interp_spline(t, q, k=5, bc_type=(rest, rest)),
        range(5),
        times,
    )
    same_curve(
        fit(cubic_spline(n), q, h),
        make_interp_spline(t, q, k=3, bc_type="clamped"),
        range(3),
        times,
    )


def test_cubic_with_given_end_slopes_is_scipys() -> None:
    q = waypoints(5)
    start, end = np.array([0.3, -0.2, 0.7]), np.array([-0.4, 0.1, 0.9])
    reference = make_interp_spline(BREAKS[:5], q, k=3, bc_type=([(1, start)], [(1, end)]))
    for j in range(3):
        interpolant = Interpolant(
            (3,) * 4, (2,) * 3, (((1, start[j]),), (), (), (), ((1, end[j]),))
        )
        mine = fit(interpolant, q[:, j : j + 1], np.diff(BREAKS[:5]))
        times = inside(BREAKS[:5])
        np.testing.assert_allclose(mine(times)[:, 0], reference(times)[:, j], atol=1e-12)


def test_natural_cubic_is_scipys() -> None:
    q = waypoints(6)
    reference = make_interp_spline(BREAKS[:6], q, k=3, bc_type="natural")
    mine = fit(cubic_spline(5, ((2, 0.0),)), q, np.diff(BREAKS[:6]))
    same_curve(mine, reference, range(4), inside(BREAKS[:6]))


@pytest.mark.parametrize("count", [2, 3, 5])
def test_virtual_waypoints_are_knots_without_data(count: int) -> None:
    breaks = BREAKS[: count + 2]
    data = [breaks[0], *breaks[2:-2], breaks[-1]]
    q = waypoints(count)
    rest = [(1, np.zeros(3)), (2, np.zeros(3))]
    knots = [breaks[0]] * 4 + list(breaks[1:-1]) + [breaks[-1]] * 4
    reference = make_interp_spline(data, q, k=3, t=knots, bc_type=(rest, rest))
    mine = fit(cubic_spline_virtual(count), q, np.diff(breaks))
    same_curve(mine, reference, range(4), inside(breaks))


def test_septic_spline_is_scipys() -> None:
    q = waypoints(6)
    rest = [(order, np.zeros(3)) for order in (1, 2, 3)]
    reference = make_interp_spline(BREAKS[:6], q, k=7, bc_type=(rest, rest))
    mine = fit(septic_spline(5), q, np.diff(BREAKS[:6]))
    same_curve(mine, reference, range(6), inside(BREAKS[:6]))


@pytest.mark.parametrize(
    ("curve", "orders"),
    [
        (quintic_spline_virtual(6), 3),
        (quintic_spline(7, virtual=(4, 2), ends=((1, 0.0), (2, 0.0), (3, 0.0))), 3),
        (septic_spline(7, virtual=(3, 5), ends=tuple((r, 0.0) for r in range(1, 5))), 4),
    ],
)
def test_virtual_breaks_anywhere_are_knots_without_data(curve: Interpolant, orders: int) -> None:
    q, k = waypoints(6), curve.degrees[0]
    rest = [(order, np.zeros(3)) for order in range(1, orders + 1)]
    data = [BREAKS[b] for b in range(8) if b not in curve.virtual]
    knots = [BREAKS[0]] * (k + 1) + list(BREAKS[1:-1]) + [BREAKS[-1]] * (k + 1)
    reference = make_interp_spline(data, q, k=k, t=knots, bc_type=(rest, rest))
    mine = fit(curve, q, np.diff(BREAKS))
    same_curve(mine, reference, range(5), inside(BREAKS))


@pytest.mark.parametrize("degree", [3, 5, 7, 9])
def test_rest_to_rest_is_hermites(degree: int) -> None:
    q = waypoints(4)
    zeros = [np.zeros(3)] * ((degree - 1) // 2)
    reference = BPoly.from_derivatives(BREAKS[:4], [[row, *zeros] for row in q])
    mine = fit(rest_to_rest(3, degree), q, np.diff(BREAKS[:4]))
    same_curve(mine, reference, range(4), inside(BREAKS[:4]))


def author_code() -> ModuleType:
    path = ROOT / "benchmarks" / "author_code.py"
    spec = importlib.util.spec_from_file_location("author_code", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_353_is_the_papers_system() -> None:
    theirs = author_code()
    q = waypoints(4)
    for h in np.random.default_rng(2).uniform(0.2, 3.0, (20, 3)):
        mine = coefficients(three_five_three(), q, h)
        for j in range(3):
            pieces = theirs.coefficients(q[:, j], *h)
            for k, piece in enumerate(pieces):
                ascending = piece[::-1] * h[k] ** np.arange(piece.size)
                np.testing.assert_allclose(mine[k, : piece.size, j], ascending, atol=1e-11)


def test_353_peaks_are_the_author_codes() -> None:
    theirs = author_code()
    problem, _ = sample_problem(three_five_three(), 11)
    rng = np.random.default_rng(4)
    for h in rng.uniform(0.2, 3.0, (5, 3)):
        exact = evaluate(problem, h[None]).ratios[0, :, :2] * problem.limits.derivatives[:, :2]
        for j in range(3):
            sampled = np.array(theirs.peaks_of_joint(problem.waypoints[:, j], *h, samples=20_000))
            assert (sampled <= exact[j] * (1 + 1e-12)).all()
            np.testing.assert_allclose(sampled, exact[j], rtol=1e-6)
            coarse = np.array(theirs.peaks_of_joint(problem.waypoints[:, j], *h))
            assert (coarse <= exact[j] * (1 + 1e-12)).all()


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
@pytest.mark.parametrize("spread", [0.3, 1.5])
def test_coefficients_against_rational_arithmetic(name: str, spread: float) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = sample_problem(interpolant, 5, joints=2)
    rng = np.random.default_rng(len(name))
    h = 10.0 ** rng.uniform(-spread, spread, interpolant.segments)
    nodal = rng.normal(size=(interpolant.free, 2)) if interpolant.free else None
    plain = coefficients(interpolant, problem.waypoints, h, nodal)
    refined, error = refined_coefficients(interpolant, problem.waypoints, h, nodal)
    for j in range(2):
        exact = exact_scaled(interpolant, problem, h, j, nodal)
        size = max(1.0, *(abs(float(c)) for piece in exact for c in piece))
        for k, piece in enumerate(exact):
            for p, c in enumerate(piece):
                assert abs(Fraction(refined[k, p, j]) - c) <= Fraction(error[k, p, j])
                assert abs(plain[k, p, j] - float(c)) <= 1e-11 * size
                assert error[k, p, j] <= 1e-13 * size
            assert not plain[k, len(piece) :, j].any()


def test_trajectory_meets_its_conditions() -> None:
    for name, interpolant in DECLARATIONS.items():
        problem, h = sample_problem(interpolant, 8)
        curve = fit(interpolant, problem.waypoints, h)
        at = curve.breaks[list(interpolant.waypoint_breaks)]
        np.testing.assert_allclose(curve(at), problem.waypoints, atol=1e-12, err_msg=name)
        assert curve.total_time == pytest.approx(h.sum(), rel=1e-15)
        assert curve.joints == 3
        for b, entries in enumerate(interpolant.prescribed):
            for order, value in entries:
                np.testing.assert_allclose(curve(curve.breaks[b], order), value, atol=1e-10)
        for k in range(interpolant.segments):
            for order in range(4):
                series = curve.derivative(k, 1, order)
                middle = curve.breaks[k] + 0.3 * h[k]
                powers = 0.3 ** np.arange(series.size)
                assert series @ powers == pytest.approx(curve(middle, order)[1], abs=1e-9)


@given(st.floats(0.05, 20.0), st.integers(0, 10**6))
def test_stretching_time_leaves_the_scaled_coefficients(factor: float, seed: int) -> None:
    for interpolant in (three_five_three(), quintic_spline(3), cubic_spline_virtual(3)):
        problem, h = sample_problem(interpolant, seed)
        one = coefficients(interpolant, problem.waypoints, h)
        other = coefficients(interpolant, problem.waypoints, factor * h)
        np.testing.assert_allclose(other, one, atol=1e-10 * np.abs(one).max())
