"""Coefficients by other routes: scipy's splines, the papers' 14×14 system, rational arithmetic."""

import importlib.util
from fractions import Fraction
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BPoly, CubicSpline, make_interp_spline
from support import exact_route
from support.checkout import ROOT
from support.samples import DECLARATIONS, FREE, posed
from trajgap.problem import (
    Interpolant,
    Problem,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    fit,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)
from trajgap.problem.curves import refined
from trajgap.problem.curves.refined import coefficient_gradient, refined_coefficients
from trajgap.problem.curves.spline import batch_peaks, coefficients, motion_values

BREAKS = (0.0, 0.7, 1.2, 2.6, 2.9, 4.4, 5.1, 6.7)


def waypoints(count: int, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) * [0.4, 1.0, 2.0] + [-3.0, 0.5, 2.0]


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
    problem, _ = posed(three_five_three(), 11)
    rng = np.random.default_rng(4)
    for h in rng.uniform(0.2, 3.0, (5, 3)):
        exact = evaluate(problem, h[None]).ratios[0, :, :2] * problem.limits.derivatives[:, :2]
        for j in range(3):
            sampled = np.array(theirs.peaks_of_joint(problem.waypoints[:, j], *h, samples=20_000))
            assert (sampled <= exact[j] * (1 + 1e-12)).all()
            np.testing.assert_allclose(sampled, exact[j], rtol=1e-6)
            coarse = np.array(theirs.peaks_of_joint(problem.waypoints[:, j], *h))
            assert (coarse <= exact[j] * (1 + 1e-12)).all()


def exact_scaled(
    interpolant: Interpolant, problem: Problem, h: np.ndarray, j: int, nodal: np.ndarray | None
) -> list[list[Fraction]]:
    extra = (
        None if nodal is None else dict(zip(interpolant.free_derivatives, nodal[:, j], strict=True))
    )
    pieces = exact_route.fitted(interpolant, problem.waypoints[:, j], h, extra)
    return [
        [c * Fraction(float(h[k])) ** p for p, c in enumerate(piece)]
        for k, piece in enumerate(pieces)
    ]


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
@pytest.mark.parametrize("spread", [0.3, 1.5])
def test_coefficients_against_rational_arithmetic(name: str, spread: float) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = posed(interpolant, 5, joints=2)
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
        problem, h = posed(interpolant, 8)
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
        problem, h = posed(interpolant, seed)
        one = coefficients(interpolant, problem.waypoints, h)
        other = coefficients(interpolant, problem.waypoints, factor * h)
        np.testing.assert_allclose(other, one, atol=1e-10 * np.abs(one).max())


@pytest.mark.parametrize(
    ("durations", "message"),
    [
        ("abc", "durations: not numbers; give seconds, one per segment"),
        ([1.0, None, 2.0], "must all be positive and finite"),
        ([1.0, [2.0, 1.0], 2.0], "durations: not numbers"),
        ([1.0, 2.0], r"durations: expected 3 \(one per segment\), got 2"),
        (1.0, r"durations: expected 3 \(one per segment\), got 1"),
        ([], r"durations: expected 3 \(one per segment\), got 0"),
        ([[1.0, 2.0, 3.0]], r"durations: expected 3 .* got 3 in shape \(1, 3\)"),
        ([1.0, 0.0, 2.0], r"durations: \[1.0, 0.0, 2.0\] s must all be positive and finite"),
        ([1.0, -0.5, 2.0], "must all be positive and finite"),
        ([1.0, np.nan, 2.0], "must all be positive and finite"),
        ([1.0, np.inf, 2.0], "must all be positive and finite"),
        (
            [1.0, 1e-31, 2.0],
            r"durations: \[1.0, 1e-31, 2.0\] s must all lie between 1e-30 and 1e\+30",
        ),
        ([1e31, 1.0, 2.0], "must all lie between 1e-30 and 1e.30 s"),
    ],
)
def test_durations_refused(durations: object, message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        fit(three_five_three(), waypoints(4), durations)  # type: ignore[arg-type]


def test_waypoints_and_nodal_values_refused() -> None:
    with pytest.raises(
        TrajgapError, match=r"3-5-3 polynomials with 3 segments needs 4 rows, got shape \(5, "
    ):
        fit(three_five_three(), waypoints(5), [1.0, 1.0, 1.0])
    quintics = piecewise((5, 5, 5), 2)
    message = r"14 conditions on 18 coefficients; give nodal derivatives of shape \(4, 3\)"
    for nodal in (None, np.zeros((3, 3)), np.zeros((4, 1))):
        with pytest.raises(TrajgapError, match=message):
            fit(quintics, waypoints(4), [1.0, 1.0, 1.0], nodal)


def singular_at_two_to_three() -> Interpolant:
    """Quartics whose system is regular for equal durations and singular for 2 : 3.

    With a = 0 at the break, jerk 0 at the start ties its velocity to −j·h₁²/8, velocity 0 at the
    end ties it to −j·h₂²/18.
    """
    return Interpolant((4, 4), (3,), (((3, 0.0),), ((2, 0.0),), ((1, 0.0),)), name="two quartics")


def test_singular_durations_never_give_a_quiet_answer() -> None:
    interpolant = singular_at_two_to_three()
    q = waypoints(3)
    assert np.isfinite(coefficients(interpolant, q, np.array([1.0, 1.0]))).all()
    values = motion_values(interpolant, q)
    peaks = batch_peaks(interpolant, values, np.array([[2.0, 3.0]]), np.ones((3, 3), bool))
    assert (peaks > 1e9).all()
    try:
        found = coefficients(interpolant, q, np.array([2.0, 3.0]))
    except TrajgapError:
        return
    assert np.abs(found).max() > 1e9


def test_singular_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    from trajgap.problem.curves import spline

    def leave_nan(*arguments: object) -> None:
        arguments[-1][:] = np.nan  # type: ignore[index]

    monkeypatch.setattr(spline.kernel, "fit_coefficients", leave_nan)
    with pytest.raises(
        TrajgapError, match=r"3-5-3 polynomials: singular for durations \[1. 1. 1.\]"
    ):
        fit(three_five_three(), waypoints(4), [1.0, 1.0, 1.0])


def complex_step(
    interpolant: Interpolant, q: np.ndarray, h: np.ndarray, nodal: np.ndarray | None, k: int
) -> np.ndarray:
    """Derivative of the scaled coefficients by a complex step in the unscaled system."""
    step = 1e-30
    degrees = interpolant.degrees
    first = np.concatenate([[0], np.cumsum([d + 1 for d in degrees])])
    t = h.astype(complex)
    t[k] += 1j * step
    rows, right = [], []
    extra = dict(zip(interpolant.free_derivatives, nodal, strict=True)) if nodal is not None else {}

    def derivative(segment: int, order: int, time: complex) -> np.ndarray:
        row = np.zeros(first[-1], complex)
        for p in range(order, degrees[segment] + 1):
            factor = np.prod(np.arange(p, p - order, -1.0))
            row[first[segment] + p] = factor * (time ** (p - order) if p > order else 1.0)
        return row

    places = {b: i for i, b in enumerate(interpolant.waypoint_breaks)}
    for b in range(len(degrees) + 1):
        given_here = {o: np.full(q.shape[1], v) for o, v in interpolant.prescribed[b]}
        given_here |= {o: v for (at, o), v in extra.items() if at == b}
        if b in places:
            given_here[0] = q[places[b]]
        for order, value in given_here.items():
            if b > 0:
                rows.append(derivative(b - 1, order, t[b - 1]))
                right.append(value)
            if b < len(degrees):
                rows.append(derivative(b, order, 0.0))
                right.append(value)
        if 0 < b < len(degrees):
            for order in range(interpolant.continuity[b - 1] + 1):
                if order not in given_here:
                    rows.append(derivative(b - 1, order, t[b - 1]) - derivative(b, order, 0.0))
                    right.append(np.zeros(q.shape[1]))
    flat = np.linalg.solve(np.array(rows), np.array(right, complex))
    out = np.zeros((len(degrees), 10, q.shape[1]))
    for s, d in enumerate(degrees):
        for p in range(d + 1):
            out[s, p] = (flat[first[s] + p] * t[s] ** p).imag / step
    return out


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
def test_coefficient_gradient_against_a_complex_step(name: str) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, h = posed(interpolant, 21)
    q = problem.waypoints
    rng = np.random.default_rng(1)
    nodal = rng.normal(size=(interpolant.free, 3)) if interpolant.free else None
    gradient = coefficient_gradient(interpolant, q, h, nodal)
    base = coefficients(interpolant, q, h, nodal)
    for k in range(interpolant.segments):
        reference = complex_step(interpolant, q, h, nodal, k)
        size = max(1.0, np.abs(reference).max(), np.abs(base).max())
        np.testing.assert_allclose(gradient.durations[k], reference, atol=1e-10 * size)
    # linear in way-points and nodal values: exact differences
    for i in range(q.shape[0]):
        moved = q.copy()
        moved[i] += 1.0
        change = coefficients(interpolant, moved, h, nodal) - base
        for j in range(3):
            np.testing.assert_allclose(gradient.waypoints[i], change[:, :, j], atol=1e-10)
    for i in range(interpolant.free):
        assert nodal is not None
        changed = nodal.copy()
        changed[i] += 1.0
        change = coefficients(interpolant, q, h, changed) - base
        for j in range(3):
            np.testing.assert_allclose(gradient.nodal[i], change[:, :, j], atol=1e-10)
    assert gradient.nodal.shape == (interpolant.free, interpolant.segments, 10)


def test_motion_values_count_from_the_first_waypoint() -> None:
    interpolant = cubic_spline_virtual(4)
    q = waypoints(4)
    np.testing.assert_array_equal(
        motion_values(interpolant, q + 0.0), motion_values(interpolant, q - q[0])
    )
    h = np.array([[0.4, 0.9, 1.3, 0.2, 0.8]])
    still = np.full((4, 1), 61.7)
    peaks = batch_peaks(interpolant, motion_values(interpolant, still), h, np.ones((1, 3), bool))
    assert not peaks.any()


def test_unwanted_peaks_are_zero() -> None:
    problem, h = posed(DECLARATIONS["quintic"], 4)
    values = problem.curve.motion_values(problem.waypoints)
    every = problem.curve.batch_peaks(values, h[None], np.ones((3, 3), bool))
    assert (every > 0).all()
    wanted = np.array([[True, False, True], [False, True, False], [False, False, False]])
    some = problem.curve.batch_peaks(values, h[None], wanted)
    np.testing.assert_array_equal(some, np.where(wanted, every, 0.0))


def test_error_bound_near_a_singular_system() -> None:
    interpolant = singular_at_two_to_three()
    q = np.array([[0.3], [1.1], [-0.4]])
    widest = 0.0
    for gap in (1e-3, 1e-6, 1e-9, 1e-12):
        h = np.array([2.0, 3.0 * (1 + gap)])
        found, error = refined_coefficients(interpolant, q, h)
        for k, piece in enumerate(exact_route.fitted(interpolant, q[:, 0], h)):
            for p, c in enumerate(piece):
                truth = c * Fraction(float(h[k])) ** p
                assert abs(Fraction(found[k, p, 0]) - truth) <= Fraction(error[k, p, 0])
        widest = error.max() / np.abs(found).max()
    assert widest > 1e-6
    for h in (np.array([2.0, 3.0]), np.array([2.0, 3.0 * (1 + 1e-15)])):
        with pytest.raises(TrajgapError, match=r"two quartics: singular for durations \[2. 3.\] s"):
            refined_coefficients(interpolant, q, h)
    with pytest.raises(TrajgapError, match=r"two quartics: singular for durations \[2. 3.\] s"):
        coefficient_gradient(interpolant, q, np.array([2.0, 3.0]))


def test_error_bound_at_extreme_durations() -> None:
    for name in ("3-5-3", "cubic", "quintic", "uneven"):
        interpolant = DECLARATIONS[name]
        problem, h = posed(interpolant, 3, joints=1)
        for k, extreme in ((0, 1e-12), (1, 1e-12), (0, 1e9), (1, 1e9)):
            h[k] = extreme
            found, error = refined_coefficients(interpolant, problem.waypoints, h)
            exact = exact_scaled(interpolant, problem, h, 0, None)
            for s, piece in enumerate(exact):
                for p, c in enumerate(piece):
                    assert abs(Fraction(found[s, p, 0]) - c) <= Fraction(error[s, p, 0])


@pytest.mark.parametrize("halo", [2, 5])
def test_windows_of_the_inverse_bound_the_error_like_all_of_it(
    monkeypatch: pytest.MonkeyPatch, halo: int
) -> None:
    problem, h = posed(quintic_spline(14), 5, joints=1)
    exact = exact_scaled(problem.curve, problem, h, 0, None)
    monkeypatch.setattr(refined, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr(refined, "CHUNK", 3)
    monkeypatch.setattr(refined, "HALOS", (halo,))
    found, error = refined_coefficients(problem.curve, problem.waypoints, h)
    for s, piece in enumerate(exact):
        for p, c in enumerate(piece):
            assert abs(Fraction(found[s, p, 0]) - c) <= Fraction(error[s, p, 0])
    assert error.max() < 1e-9 * np.abs(found).max()


def test_a_spline_of_1000_segments_needs_no_dense_inverse(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("a dense inverse of 4,000 coefficients")

    monkeypatch.setattr(refined, "_inverse", refuse)
    q = np.cumsum(waypoints(1001), axis=0)
    h = np.random.default_rng(8).uniform(0.3, 3.0, 1000)
    times = np.concatenate([[0.0], np.cumsum(h)])
    found, error = refined_coefficients(cubic_spline(1000), q, h)
    reference = CubicSpline(times, q, bc_type="clamped").c
    scaled = reference[::-1] * h[None, :, None] ** np.arange(4)[:, None, None]
    size = np.abs(scaled).max()
    np.testing.assert_allclose(found[:, :4], scaled.transpose(1, 0, 2), atol=1e-12 * size)
    assert error.max() < 1e-12 * size
