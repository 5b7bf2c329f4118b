"""Coefficients by other routes: scipy's splines, the papers' 14×14 system, rational arithmetic."""

from dataclasses import replace
from fractions import Fraction
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, make_interp_spline
from support import exact_route
from support.samples import DECLARATIONS, FREE, sample_problem
from trajgap.problem import Interpolant, Limits, Problem, TrajgapError, curves, extrema, fit
from trajgap.problem.curves import Asked, places_of, refined, right_hand_sides, system
from trajgap.problem.curves.system import Factors, System, factorise

STEPS = (0.7, 0.5, 1.4, 0.3, 1.5, 0.7, 1.6)
FIRST, LAST, BENT = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7), (0.0, 1.1, -0.6)
REST2, REST3, REST4 = (tuple((r, 0.0) for r in range(1, n + 1)) for n in (2, 3, 4))
CURVES = {
    "cubic": (curves.cubic_spline(7), ((1, 0.0),) * 2),
    "natural cubic": (curves.cubic_spline(5, ((2, 0.0),)), ((2, 0.0),) * 2),
    "cubic, slopes": (curves.cubic_spline(4, ((1, FIRST),), ((1, LAST),)), ((1, FIRST), (1, LAST))),
    "cubic, mixed": (curves.cubic_spline(3, ((1, FIRST),), ((2, BENT),)), ((1, FIRST), (2, BENT))),
    "cubic, turned": (curves.cubic_spline(3, ((2, LAST),), ((1, FIRST),)), ((2, LAST), (1, FIRST))),
    "quintic": (curves.quintic_spline(7), (REST2, REST2)),
    "quintic, moving": (
        curves.quintic_spline(5, ((1, FIRST), (2, BENT))),
        (((1, FIRST), (2, BENT)),) * 2,
    ),
    "septic": (curves.septic_spline(5), (REST3, REST3)),
    "cubic, virtual 2": (curves.cubic_spline_virtual(2), (REST2, REST2)),
    "cubic, virtual 3": (curves.cubic_spline_virtual(3), (REST2, REST2)),
    "cubic, virtual 5": (curves.cubic_spline_virtual(5), (REST2, REST2)),
    "quintic, virtual": (curves.quintic_spline_virtual(6), (REST3, REST3)),
    "quintic, virtual inside": (
        curves.quintic_spline(7, virtual=(4, 2), ends=REST3),
        (REST3, REST3),
    ),
    "septic, virtual inside": (curves.septic_spline(7, virtual=(3, 5), ends=REST4), (REST4, REST4)),
}
"""Splines, and what holds at either end: one order and value, or several."""


def waypoints(count: int, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, 3)) * [0.4, 1.0, 2.0] + [-3.0, 0.5, 2.0]


def exact_scaled(
    interpolant: Interpolant, problem: Problem, h: np.ndarray, j: int, nodal: np.ndarray | None
) -> list[list[Fraction]]:
    extra = (
        None if nodal is None else dict(zip(interpolant.free_derivatives, nodal[:, j], strict=True))
    )
    pieces = exact_route.fitted(interpolant, problem.waypoints[:, j], h, extra)
    steps = [Fraction(float(x)) for x in h]
    return [[c * s**p for p, c in enumerate(one)] for s, one in zip(steps, pieces, strict=True)]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", CURVES)
def test_splines_are_scipys(name: str, seed: int) -> None:
    """Virtual breaks are knots without data; durations are within 1 : 25."""
    curve, given = CURVES[name]
    ends = [[(r, np.broadcast_to(v, 3)) for r, v in (e if isinstance(e[0], tuple) else [e])]
            for e in given]  # fmt: skip
    rng, k, n = np.random.default_rng([20260304, seed]), curve.degrees[0], curve.segments
    h = 10.0 ** rng.uniform(-0.9, 0.5, n) if seed else np.array(STEPS[:n])
    t = np.concatenate([[0.0], np.cumsum(h)])
    q = waypoints(n + 1 - len(curve.virtual), seed)
    data = np.delete(t, curve.virtual)
    knots = [t[0]] * (k + 1) + list(t[1:-1]) + [t[-1]] * (k + 1)
    theirs = make_interp_spline(data, q, k=k, t=knots, bc_type=tuple(ends))
    mine = fit(curve, q, h)
    inside = np.concatenate([t[:-1] + h * part for part in (0.01, 0.2, 0.41, 0.66, 0.99)])
    for order in range(min(k, 5)):
        other = theirs(inside, order)
        room = 1e-10 * max(1.0, np.abs(other).max())
        np.testing.assert_allclose(mine(inside, order), other, rtol=0, atol=room)
    alone = fit(curve.for_joint(q, 1), q[:, 1:2], h)
    np.testing.assert_allclose(alone(inside)[:, 0], mine(inside)[:, 1], atol=1e-12)


def coefficients(
    curve: Interpolant, q: np.ndarray, h: np.ndarray, nodal: np.ndarray | None = None
) -> np.ndarray:
    return curve.fitted(q, h, nodal).scaled


def refined_coefficients(
    curve: Interpolant, q: np.ndarray, h: np.ndarray, nodal: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    return refined.refined_coefficients(curve.layout, right_hand_sides(curve, q, nodal), h)


def bounded(found: np.ndarray, error: np.ndarray, exact: list[list[Fraction]], j: int = 0) -> None:
    """Every coefficient of a joint is off by no more than its bound."""
    for s, piece in enumerate(exact):
        for p, c in enumerate(piece):
            assert abs(Fraction(found[s, p, j]) - c) <= Fraction(error[s, p, j])


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
@pytest.mark.parametrize("spread", [0.3, 1.5])
def test_coefficients_against_rational_arithmetic(name: str, spread: float) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = sample_problem(interpolant, 5, joints=2)
    rng = np.random.default_rng(len(name))
    h = 10.0 ** rng.uniform(-spread, spread, interpolant.segments)
    nodal = rng.normal(size=(interpolant.free, 2)) if interpolant.free else None
    plain = coefficients(interpolant, problem.waypoints, h, nodal)
    exactly, error = refined_coefficients(interpolant, problem.waypoints, h, nodal)
    for j in range(2):
        exact = exact_scaled(interpolant, problem, h, j, nodal)
        size = max(1.0, *(abs(float(c)) for piece in exact for c in piece))
        bounded(exactly, error, exact, j)
        for k, piece in enumerate(exact):
            for p, c in enumerate(piece):
                assert abs(plain[k, p, j] - float(c)) <= 1e-11 * size
                assert error[k, p, j] <= 1e-13 * size
            assert not plain[k, len(piece) :, j].any()


LONG = {
    "cubic": curves.cubic_spline(16),
    "quintic": curves.quintic_spline(12),
    "virtual": curves.cubic_spline_virtual(15),
    "even degrees": curves.piecewise((4, *(3,) * 10, 4), 2),
}
"""Declarations of a dozen segments and more, whose inverse is found by bands."""


def test_nodal_values_refused() -> None:
    message = r"14 conditions for 18 coefficients; give nodal derivatives of shape \(4, 3\)"
    for nodal in (None, np.zeros((3, 3)), np.zeros((4, 1))):
        with pytest.raises(TrajgapError, match=message):
            fit(curves.piecewise((5, 5, 5), 2), waypoints(4), [1.0, 1.0, 1.0], nodal)


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
    values = interpolant.motion_values(q)
    asked = Asked(np.ones((3, 3), bool))
    peaks = interpolant.batch_reach(values, np.array([[2.0, 3.0]]), asked)
    assert (peaks > 1e9).all()
    try:
        found = coefficients(interpolant, q, np.array([2.0, 3.0]))
    except TrajgapError:
        return
    assert np.abs(found).max() > 1e9


@pytest.mark.parametrize("banded", [False, True])
def test_singular_is_said(banded: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if banded:
        monkeypatch.setattr(system, "DENSE_UNKNOWNS", 0)
        monkeypatch.setattr(Factors, "solve", lambda self, right, transposed: np.nan * right)
    monkeypatch.setattr(np.linalg, "solve", Mock(side_effect=np.linalg.LinAlgError))
    words = r"3-5-3 polynomials: singular for durations \[1. 1. 1.\]"
    with pytest.raises(TrajgapError, match=words):
        fit(curves.three_five_three(), waypoints(4), [1.0, 1.0, 1.0])


def test_error_bound_near_a_singular_system() -> None:
    interpolant = singular_at_two_to_three()
    q = np.array([[0.3], [1.1], [-0.4]])
    widest = 0.0
    for gap in (1e-3, 1e-6, 1e-9, 1e-12):
        h = np.array([2.0, 3.0 * (1 + gap)])
        found, error = refined_coefficients(interpolant, q, h)
        problem = Problem(q, Limits(9.0), interpolant)
        bounded(found, error, exact_scaled(interpolant, problem, h, 0, None))
        widest = error.max() / np.abs(found).max()
    assert widest > 1e-6
    for h in (np.array([2.0, 3.0]), np.array([2.0, 3.0 * (1 + 1e-15)])):
        with pytest.raises(TrajgapError, match=r"two quartics: singular for durations \[2. 3.\] s"):
            refined_coefficients(interpolant, q, h)


@pytest.mark.parametrize("banded", [False, True])
@pytest.mark.parametrize("name", ["3-5-3", "cubic", "quintic", "uneven"])
def test_error_bound_at_extreme_durations(
    name: str, banded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if banded:
        monkeypatch.setattr(system, "DENSE_UNKNOWNS", 0)
    interpolant = DECLARATIONS[name]
    problem, h = sample_problem(interpolant, 3, joints=1)
    for k, extreme in ((0, 1e-12), (1, 1e-12), (0, 1e9), (1, 1e9)):
        h[k] = extreme
        found, error = refined_coefficients(interpolant, problem.waypoints, h)
        bounded(found, error, exact_scaled(interpolant, problem, h, 0, None))


@pytest.mark.parametrize("spread", [0.2, 0.8])
@pytest.mark.parametrize("extended", [True, False])
@pytest.mark.parametrize("width", [1, 3, 32])
@pytest.mark.parametrize("name", LONG)
def test_blocks_of_segments_bound_the_error_like_the_whole_inverse(
    monkeypatch: pytest.MonkeyPatch, name: str, width: int, extended: bool, spread: float
) -> None:
    interpolant = LONG[name]
    problem, _ = sample_problem(interpolant, 5, joints=2)
    q = problem.waypoints.copy()
    q[:, 1] = 0.7  # stands still
    h = 10.0 ** np.random.default_rng(width).uniform(-spread, spread, interpolant.segments)
    _, whole = refined_coefficients(interpolant, q, h)
    monkeypatch.setattr(system, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr(refined, "WIDTHS", (width,))
    monkeypatch.setattr(System, "inverse", property(refuse_inverse))
    values = right_hand_sides(interpolant, q, None)
    found, error = refined.refined_coefficients(interpolant.layout, values, h, extended)
    for j in range(2):
        exact = exact_scaled(interpolant, replace(problem, waypoints=q), h, j, None)
        bounded(found, error, exact, j)
    assert error[..., 0].max() < 1e-9 * np.abs(found[..., 0]).max()
    if extended:
        # Blocks narrower than the spline overestimate what passes between them.
        assert error[..., 0].max() <= 100.0 * whole[..., 0].max()
        assert (error[..., 0] <= 1.02 * whole[..., 0]).all() or width <= interpolant.segments
    elif not interpolant.virtual:
        assert not found[:, 1:, 1].any()
        assert error[:, 1:, 1].max() < 1e-250


refuse_inverse = Mock(side_effect=AssertionError("a dense inverse where a band was meant"))


def test_blocks_that_bound_nothing_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    curve = singular_at_two_to_three()
    monkeypatch.setattr(system, "DENSE_UNKNOWNS", 0)
    values = right_hand_sides(curve, waypoints(3), None)
    for extended in (False, True):
        with pytest.raises(TrajgapError, match="singular for durations"):
            refined.refined_coefficients(curve.layout, values, np.array([2.0, 3.0]), extended)


def test_a_spline_of_1000_segments_needs_no_dense_inverse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(System, "inverse", property(refuse_inverse))
    q = np.cumsum(waypoints(1001), axis=0)
    h = np.random.default_rng(8).uniform(0.3, 3.0, 1000)
    times = np.concatenate([[0.0], np.cumsum(h)])
    found, error = refined_coefficients(curves.cubic_spline(1000), q, h)
    reference = CubicSpline(times, q, bc_type="clamped").c
    scaled = reference[::-1] * h[None, :, None] ** np.arange(4)[:, None, None]
    size = np.abs(scaled).max()
    np.testing.assert_allclose(found[:, :4], scaled.transpose(1, 0, 2), atol=1e-12 * size)
    assert error.max() < 1e-12 * size


@pytest.mark.parametrize("name", LONG)
def test_gradients_by_bands_are_the_dense_ones(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    interpolant = LONG[name]
    problem, h = sample_problem(interpolant, 7, joints=3)
    curve = fit(interpolant, problem.waypoints, h)
    points = [e for j in range(3) for r in range(4) for e in extrema(curve, j, r)]
    dense, places = interpolant.value_gradients(problem.waypoints, h, points), places_of(points)
    monkeypatch.setattr(system, "DENSE_UNKNOWNS", 0)
    monkeypatch.setattr(System, "inverse", property(refuse_inverse))
    adjoint = interpolant.adjoint(problem.waypoints, h)
    found = adjoint.gradients(places)
    for kind in ("durations", "waypoints"):
        one, other = getattr(found, kind), getattr(dense, kind)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max())
    assert found.nodal.shape == dense.nodal.shape
    values = np.array([e.value for e in points])
    np.testing.assert_allclose(adjoint.values(places), values, atol=1e-11 * np.abs(values).max())
    weights = np.random.default_rng(3).normal(size=len(points))
    together = weights @ dense.durations
    loose = 1e-10 * np.abs(together).max()
    np.testing.assert_allclose(adjoint.weighted(places, weights), together, atol=loose)
