"""Parts of curves by themselves: band matrices beside dense ones, knots however they are given."""

from __future__ import annotations

import numpy as np
import pytest
from trajgap.problem import ClampedBSpline, Knots, Parameters, Timing, fit
from trajgap.problem.curves.banded import factorise


@pytest.mark.parametrize(("lower", "upper"), [(1, 2), (2, 1), (3, 3), (0, 2)])
def test_factors_of_a_band_matrix_solve_the_dense_system(lower: int, upper: int) -> None:
    rng, size = np.random.default_rng(5), 14
    dense = np.triu(np.tril(rng.normal(size=(size, size)), upper), -lower)
    row, column = np.nonzero(dense)
    right, factors = rng.normal(size=(size, 2)), factorise(row, column, dense[row, column])
    assert (factors.lower, factors.upper) == (lower, upper)
    for transposed, matrix in ((False, dense), (True, dense.T)):
        found = factors.solve(right, transposed)
        np.testing.assert_allclose(matrix @ found, right, atol=1e-10)


def test_knots_are_numbers_of_one_kind_however_they_are_given():
    whole = [0, 0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1, 1]
    given = (whole, tuple(whole), np.array(whole))
    curves = {ClampedBSpline(4, 4, Knots.GIVEN, Parameters.TIMES, knot_vector=one) for one in given}
    assert len(curves) == 1
    (curve,) = curves
    assert curve.knot_vector == tuple(map(float, whole))
    assert all(type(one) is float for one in curve.knot_vector)


@pytest.mark.parametrize(("degree", "orders"), [(3, (1,)), (5, (1, 2))])
def test_inner_knots_at_the_times_of_way_points_make_a_spline(
    degree: int, orders: tuple[int, ...]
) -> None:
    curve = ClampedBSpline(5, degree, end_orders=orders)
    rng = np.random.default_rng(degree)
    q, h = rng.normal(size=(5, 2)), rng.uniform(0.5, 1.5, 4)
    at = np.linspace(0.0, h.sum(), 41)
    spline = curve.polynomial_form()
    np.testing.assert_allclose(fit(spline, q, h)(at), fit(curve, q, h)(at), atol=1e-9)
    assert spline is not curve
    for knots, places in (
        (Knots.WAYPOINTS, Parameters.CHORD),
        (Knots.CONTINUED, Parameters.TIMES),
    ):
        other = ClampedBSpline(5, 5, knots, places)
        assert other.polynomial_form() is other


def test_segments_that_are_stretched_by_themselves_are_not_smooth():
    for time, order in ((Timing.TIMED, 3), (Timing.STRETCHED, 0)):
        curve = ClampedBSpline(5, 4, Knots.CONTINUED, Parameters.CHORD, time)
        assert curve.smooth_order(2) == order
