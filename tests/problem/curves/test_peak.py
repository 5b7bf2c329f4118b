"""Extrema by other routes: companion matrices, Chebyshev's polynomials, exact fractions, sampling.

The checker and the batched evaluation find peaks by two root finders written apart. Both are asked
about the same polynomials: one segment with all its start derivatives prescribed can be any one.
"""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from numpy.polynomial import Chebyshev, Polynomial as Power
from support import exact_route
from trajgap.problem import Interpolant, Limits, Problem, check, evaluate
from trajgap.problem.curves import derived, roots_in_unit


def critical_points(a: np.ndarray) -> np.ndarray:
    """Places in (0, 1) where the polynomial with ascending coefficients turns."""
    places = roots_in_unit(derived(a, 1))
    return places[~np.isnan(places)]


def as_problem(velocity: np.ndarray) -> Problem:
    """One segment of duration 1 whose velocity has these ascending coefficients."""
    degree = velocity.size
    position = np.concatenate([[0.0], velocity / np.arange(1, degree + 1)])
    start = tuple((r, math.factorial(r) * position[r]) for r in range(1, degree))
    interpolant = Interpolant((degree,), (), (start, ()))
    waypoints = np.array([[0.0], [position.sum()]])
    return Problem(waypoints, Limits(1, 1, 1, joints=1), interpolant)


def peaks_by_both(velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Peaks of |v|, |a|, |j| from the checker and from the batched evaluation."""
    problem = as_problem(velocity)
    checked = check(problem, [1.0])
    batched = evaluate(problem, [[1.0]])
    return np.array([p.ratio for p in checked.peaks]), batched.ratios[0, 0]


def companion_peak(p: Power) -> float:
    """Largest |p| on [0, 1] over the ends and all roots of the derivative that are nearly real."""
    places = [0.0, 1.0]
    slope = p.deriv()
    slope = slope.trim(1e-13 * np.abs(slope.coef).max())
    if slope.degree() > 0:
        near = slope.roots()
        for s in near.real[(np.abs(near.imag) < 1e-3) & (np.abs(near.real - 0.5) < 0.51)]:
            places.append(s)
            for _ in range(3):  # a small leading coefficient costs the companion matrix digits
                bend = slope.deriv()(s)
                s -= slope(s) / bend if bend else 0.0
            places.append(s)
    return max(abs(float(p(s))) for s in places if 0 <= s <= 1)


def chebyshev(degree: int) -> Power:
    unit = [0.0, 1.0]
    wave = Chebyshev.basis(degree, domain=unit).convert(kind=Power, domain=unit, window=unit)
    return Power(wave.coef)


@pytest.mark.parametrize("degree", range(1, 9))
def test_chebyshev_reaches_one_at_every_extremum(degree: int) -> None:
    p = chebyshev(degree)
    coefficients = np.asarray(p.coef)
    places = critical_points(coefficients)
    known = (1 - np.cos(np.pi * np.arange(1, degree) / degree)) / 2
    np.testing.assert_allclose(places, known, atol=1e-12)
    np.testing.assert_allclose(np.abs(p(places)), 1.0, rtol=1e-10)
    # Markov: the derivatives are largest at the ends, d² and d²(d² − 1)/3 (on [−1, 1])
    d2 = degree**2
    known_peaks = [1.0, 2 * d2, 4 * d2 * (d2 - 1) / 3]
    for peaks in peaks_by_both(coefficients):
        np.testing.assert_allclose(peaks, known_peaks, rtol=1e-9, atol=1e-9)


@given(st.lists(st.floats(-10, 10, width=32), min_size=1, max_size=9))
@example([0.0] * 9)
@example([1.0, 0.0, 0.0])
@example([0.0, 1.0, 0.0, 0.0, 0.0])
@example([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-300, 1.0])
@example([1e-30, 1.0, -1.0])
@example([0.0, 1.0, -1.0, 1e-18])
def test_any_polynomial(coefficients: list[float]) -> None:
    velocity = np.array(coefficients)
    p = Power(velocity)
    expected = np.array([companion_peak(p.deriv(r) if r else p) for r in range(3)])
    sizes = np.array([np.abs(p.deriv(r).coef).sum() for r in range(3)])
    room = 1e-11 * sizes + 1e-12 * sizes[0]  # the last coefficient comes from the way-point
    for peaks in peaks_by_both(velocity):
        assert (np.abs(peaks - expected) <= room).all()


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=7), st.integers(1, 3), st.floats(-2, 2))
@example([0.3, 0.3], 2, 0.4)
@example([0.5], 3, 0.0)
@example([0.25, 0.75], 1, -0.1)
@example([0.0, 1.0], 1, 0.3)
@example([0.999999, 1.0], 2, 0.0)
@example([1e-9, 2e-9, 0.5], 1, 0.2)
def test_clusters_of_turning_points(roots: list[float], multiplicity: int, shift: float) -> None:
    # velocity = shift + ∫ Π (s − root): its turning points are the roots of odd multiplicity
    factors = (roots * multiplicity)[:7]
    p = Power.fromroots(factors).integ(k=shift)
    expected = float(np.abs(p(np.array([0.0, 1.0, *roots]))).max())
    room = 1e-12 * np.abs(p.coef).sum()
    for peaks in peaks_by_both(np.asarray(p.coef)):
        assert abs(peaks[0] - expected) <= room


def test_no_turning_point_outside_or_without_sign_change() -> None:
    assert critical_points(np.array([1.0])).size == 0
    assert critical_points(np.array([1.0, 2.0])).size == 0
    assert critical_points(np.zeros(6)).size == 0
    # slope (s − 2)(s + 1): both roots outside
    assert critical_points(np.array([0.0, -2.0, -0.5, 1 / 3])).size == 0
    # slope s(1 − s): both roots are ends
    assert critical_points(np.array([0.0, 0.0, 0.5, -1 / 3])).size == 0
    # slope 1 + s²: no real root
    assert critical_points(np.array([0.0, 1.0, 0.0, 1 / 3])).size == 0
    # slope (s − ½)³: one turning point
    slope = Power.fromroots([0.5] * 3)
    np.testing.assert_allclose(critical_points(np.asarray(slope.integ().coef)), [0.5], atol=1e-5)
    # leading coefficients that are 0
    np.testing.assert_allclose(critical_points(np.array([0.0, 1.0, -1.0, 0.0, 0.0])), [0.5])


def test_exact_route_knows_a_simple_peak() -> None:
    # s² − s³ over two seconds: speed (2t/4 − 3t²/8), largest |v| at the end
    piece = [Fraction(0), Fraction(0), Fraction(1, 4), Fraction(-1, 8)]
    assert float(exact_route.peak([piece], [2.0], 0)) == pytest.approx(4 / 27, rel=1e-15)
    assert float(exact_route.peak([piece], [2.0], 1)) == pytest.approx(0.5, rel=1e-15)
