"""Coefficients of splines: their gradients and error bounds, and systems that are singular."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support import exact_route
from support.samples import DECLARATIONS, sample_problem
from support.splines_drawn import exact_scaled, waypoints
from trajgap.problem import (
    Interpolant,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    extrema,
    fit,
    piecewise,
    quintic_spline,
    three_five_three,
)
from trajgap.problem.curves import Adjoint, places_of, refined
from trajgap.problem.curves import interpolant as interpolant_module
from trajgap.problem.curves.refined import coefficient_gradient, refined_coefficients
from trajgap.problem.curves.spline import batch_peaks, coefficients, motion_values

LONG = {
    "cubic": cubic_spline(16),
    "quintic": quintic_spline(12),
    "virtual": cubic_spline_virtual(15),
    "even degrees": piecewise((4, *(3,) * 10, 4), 2),
}
"""Declarations of a dozen segments and more, whose inverse is found by bands."""


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

    monkeypatch.setattr(spline, "_fit_one", leave_nan)
    with pytest.raises(
        TrajgapError, match=r"3-5-3 polynomials: singular for durations \[1. 1. 1.\]"
    ):
        fit(three_five_three(), waypoints(4), [1.0, 1.0, 1.0])


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
    problem, h = sample_problem(DECLARATIONS["quintic"], 4)
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
        problem, h = sample_problem(interpolant, 3, joints=1)
        for k, extreme in ((0, 1e-12), (1, 1e-12), (0, 1e9), (1, 1e9)):
            h[k] = extreme
            found, error = refined_coefficients(interpolant, problem.waypoints, h)
            exact = exact_scaled(interpolant, problem, h, 0, None)
            for s, piece in enumerate(exact):
                for p, c in enumerate(piece):
                    assert abs(Fraction(found[s, p, 0]) - c) <= Fraction(error[s, p, 0])


@pytest.mark.parametrize("share", [1e-2, 1e-5, 0.0])
@pytest.mark.parametrize("name", ["cubic", "quintic", "virtual", "even degrees"])
def test_rows_of_the_banded_inverse_bound_the_error_like_all_of_it(
    monkeypatch: pytest.MonkeyPatch, share: float, name: str
) -> None:
    interpolant = LONG[name]
    problem, h = sample_problem(interpolant, 5, joints=1)
    _, whole = refined_coefficients(interpolant, problem.waypoints, h)
    exact = exact_scaled(interpolant, problem, h, 0, None)
    monkeypatch.setattr(refined, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr(refined, "SHARES", (share,))
    monkeypatch.setattr(refined, "_inverse", refuse_inverse)
    found, error = refined_coefficients(interpolant, problem.waypoints, h)
    for s, piece in enumerate(exact):
        for p, c in enumerate(piece):
            assert abs(Fraction(found[s, p, 0]) - c) <= Fraction(error[s, p, 0])
    if share < 1e-2:  # rows cut so early leave out too much for a bound as close as the dense one
        assert (error <= 1.02 * whole).all()
    assert error.max() < 1e-9 * np.abs(found).max()


def refuse_inverse(*_: object) -> None:
    raise AssertionError("a dense inverse where a band was meant")


def test_a_banded_bound_that_leaves_out_too_much_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, h = sample_problem(quintic_spline(14), 5, joints=1)
    monkeypatch.setattr(refined, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr(refined, "DENSE_AFTER_ALL", 0)
    monkeypatch.setattr(refined, "SHARES", (0.9,))
    with pytest.raises(TrajgapError, match="singular for durations"):
        refined_coefficients(problem.curve, problem.waypoints, h)


def test_banded_bounds_at_extreme_durations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refined, "DENSE_UNKNOWNS", 0)
    test_error_bound_at_extreme_durations()


def test_a_spline_of_1000_segments_needs_no_dense_inverse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refined, "_inverse", refuse_inverse)
    q = np.cumsum(waypoints(1001), axis=0)
    h = np.random.default_rng(8).uniform(0.3, 3.0, 1000)
    times = np.concatenate([[0.0], np.cumsum(h)])
    found, error = refined_coefficients(cubic_spline(1000), q, h)
    reference = CubicSpline(times, q, bc_type="clamped").c
    scaled = reference[::-1] * h[None, :, None] ** np.arange(4)[:, None, None]
    size = np.abs(scaled).max()
    np.testing.assert_allclose(found[:, :4], scaled.transpose(1, 0, 2), atol=1e-12 * size)
    assert error.max() < 1e-12 * size


@pytest.mark.parametrize("name", ["cubic", "quintic", "virtual", "even degrees"])
def test_adjoint_gradients_are_those_of_the_dense_system(name: str) -> None:
    interpolant = LONG[name]
    problem, h = sample_problem(interpolant, 7, joints=3)
    curve = fit(interpolant, problem.waypoints, h)
    points = [e for j in range(3) for r in range(4) for e in extrema(curve, j, r)]
    dense = interpolant.value_gradients(problem.waypoints, h, points)
    adjoint, places = Adjoint(interpolant, problem.waypoints, h), places_of(points)
    found = adjoint.gradients(places)
    for one, other in (
        (found.durations, dense.durations),
        (found.waypoints, dense.waypoints),
    ):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max())
    assert found.nodal.shape == dense.nodal.shape
    values = np.array([e.value for e in points])
    np.testing.assert_allclose(adjoint.values(places), values, atol=1e-11 * np.abs(values).max())
    weights = np.random.default_rng(3).normal(size=len(points))
    together = weights @ dense.durations
    np.testing.assert_allclose(
        adjoint.weighted(places, weights), together, atol=1e-10 * np.abs(together).max()
    )


def test_long_splines_take_their_gradients_from_the_adjoint(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    interpolant = quintic_spline(60)
    problem, h = sample_problem(interpolant, 2, joints=2)
    curve = fit(interpolant, problem.waypoints, h)
    points = extrema(curve, 0, 2)[40:60] + extrema(curve, 1, 3)[90:100]
    found = interpolant.value_gradients(problem.waypoints, h, points)
    monkeypatch.setattr(interpolant_module, "_DENSE", 10**6)
    dense = interpolant.value_gradients(problem.waypoints, h, points)
    np.testing.assert_allclose(found.durations, dense.durations, rtol=1e-9, atol=1e-9)
