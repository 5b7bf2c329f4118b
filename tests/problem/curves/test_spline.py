"""Coefficients by other routes: scipy's splines, the papers' 14×14 system, rational arithmetic."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import BPoly, make_interp_spline
from support.samples import DECLARATIONS, FREE, sample_problem
from support.splines_drawn import exact_scaled, waypoints
from support.suite import benchmark
from trajgap.problem import (
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    fit,
    piecewise,
    quintic_spline,
    quintic_spline_virtual,
    rest_to_rest,
    septic_spline,
    three_five_three,
)
from trajgap.problem.curves.refined import refined_coefficients
from trajgap.problem.curves.spline import coefficients

STEPS = (0.7, 0.5, 1.4, 0.3, 1.5, 0.7, 1.6)
FIRST, LAST, BENT = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7), (0.0, 1.1, -0.6)
REST2, REST3, REST4 = (tuple((r, 0.0) for r in range(1, n + 1)) for n in (2, 3, 4))
CURVES = {
    "cubic": (cubic_spline(7), ((1, 0.0),) * 2),
    "natural cubic": (cubic_spline(5, ((2, 0.0),)), ((2, 0.0),) * 2),
    "cubic, slopes": (
        cubic_spline(4, ((1, FIRST),), ((1, LAST),)),
        ((1, FIRST), (1, LAST)),
    ),
    "cubic, mixed": (
        cubic_spline(3, ((1, FIRST),), ((2, BENT),)),
        ((1, FIRST), (2, BENT)),
    ),
    "cubic, turned": (
        cubic_spline(3, ((2, LAST),), ((1, FIRST),)),
        ((2, LAST), (1, FIRST)),
    ),
    "quintic": (quintic_spline(7), (REST2, REST2)),
    "quintic, moving": (quintic_spline(5, ((1, FIRST), (2, BENT))), (((1, FIRST), (2, BENT)),) * 2),
    "septic": (septic_spline(5), (REST3, REST3)),
    "cubic, virtual 2": (cubic_spline_virtual(2), (REST2, REST2)),
    "cubic, virtual 3": (cubic_spline_virtual(3), (REST2, REST2)),
    "cubic, virtual 5": (cubic_spline_virtual(5), (REST2, REST2)),
    "quintic, virtual": (quintic_spline_virtual(6), (REST3, REST3)),
    "quintic, virtual inside": (quintic_spline(7, virtual=(4, 2), ends=REST3), (REST3, REST3)),
    "septic, virtual inside": (septic_spline(7, virtual=(3, 5), ends=REST4), (REST4, REST4)),
}
"""Splines, and what holds at either end: one order and value, or several."""


@pytest.mark.parametrize("seed", range(12))
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


@pytest.mark.parametrize("degree", [3, 5, 7, 9])
def test_polynomials_between_given_derivatives_are_hermites(degree: int) -> None:
    q, orders, t = waypoints(4), (degree - 1) // 2, np.array([0.0, 0.7, 1.2, 2.6])
    rest = BPoly.from_derivatives(t, [[row, *[np.zeros(3)] * orders] for row in q])
    mine = fit(rest_to_rest(3, degree), q, np.diff(t))
    at = np.linspace(0.01, 2.59, 100)
    for order in range(4):
        other = rest(at, order)
        np.testing.assert_allclose(mine(at, order), other, atol=1e-10 * np.abs(other).max())
    first, last = np.random.default_rng(degree).normal(size=(2, orders, 3))
    prescribed = [tuple((r + 1, tuple(v)) for r, v in enumerate(end)) for end in (first, last)]
    curve = piecewise((degree,), 2, prescribed[0], finish=prescribed[1])
    moving = BPoly.from_derivatives([0.0, 1.4], [[q[0], *first], [q[1], *last]])
    at = np.linspace(0.0, 1.4, 51)
    np.testing.assert_allclose(fit(curve, q[:2], [1.4])(at), moving(at), atol=1e-11)


def test_353_is_the_papers_system() -> None:
    theirs = SimpleNamespace(**benchmark("author_code"))
    q = waypoints(4)
    for h in np.random.default_rng(2).uniform(0.2, 3.0, (20, 3)):
        mine = coefficients(three_five_three(), q, h)
        for j in range(3):
            pieces = theirs.coefficients(q[:, j], *h)
            for k, piece in enumerate(pieces):
                ascending = piece[::-1] * h[k] ** np.arange(piece.size)
                np.testing.assert_allclose(mine[k, : piece.size, j], ascending, atol=1e-11)


def test_353_peaks_are_the_author_codes() -> None:
    theirs = SimpleNamespace(**benchmark("author_code"))
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
