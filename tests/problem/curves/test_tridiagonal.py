"""Long cubic splines by their velocities: the bound against rational arithmetic, and when it is."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import lapack
from support import exact_route
from trajgap.problem import Interpolant, Limits, Problem, Verdict, check, cubic_spline
from trajgap.problem.curves import tridiagonal
from trajgap.problem.curves.tridiagonal import tridiagonal_fit

ENDS = {
    "clamped": cubic_spline(12),
    "natural": cubic_spline(9, ((2, 0.0),)),
    "moving": cubic_spline(12, ((1, (0.5, -0.2)),), ((2, (1.5, 0.4)),)),
    "turned": cubic_spline(12, ((2, -0.7),), ((1, 0.3),)),
    "two segments": cubic_spline(2, ((2, 0.4),), ((1, 0.3),)),
}


def drawn(curve: Interpolant, spread: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q = 60.0 + np.cumsum(rng.normal(size=(curve.segments + 1, 2)), axis=0)
    q[:, 1] *= 1e-3
    return q, 10.0 ** rng.uniform(-spread, spread, curve.segments)


@pytest.mark.parametrize("spread", [0.3, 3.0, 8.0])
@pytest.mark.parametrize("name", ENDS)
def test_derivatives_are_within_their_bounds_of_exact_ones(name: str, spread: float) -> None:
    curve = ENDS[name]
    q, h = drawn(curve, spread, 4)
    found = tridiagonal_fit(curve.ends, q, h)
    scaled, times = found.trajectory.scaled, [Fraction(x) for x in h]
    for j in range(2):
        own = curve.for_joint(q, j)
        for k, exact in enumerate(exact_route.fitted(own, q[:, j], h)):
            away = [abs(Fraction(scaled[k, p, j]) - c * times[k] ** p) for p, c in enumerate(exact)]
            for r in range(4):
                most = sum(math.perm(p, r) * a for p, a in enumerate(away)) / times[k] ** r
                assert most <= Fraction(found.error[k, r, j])
    # Where durations are alike, the bound is near the rounding of what it bounds.
    speed = np.abs(scaled[:, 1] / h[:, None]).max(axis=0)
    assert spread > 1.0 or (found.error[:, 1] <= 2e-12 * speed).all()


@pytest.mark.parametrize("name", ENDS)
def test_a_solution_that_is_off_is_bounded(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Velocities up and down by turns leave the least residual for their size."""
    curve, solver = ENDS[name], lapack.dptsv
    q, h = drawn(curve, 0.3, 4)
    right = tridiagonal_fit(curve.ends, q, h)
    moved = np.outer((-1.0) ** np.arange(curve.segments + 1), [1e-3, 1e-6])
    moved[[b for b, ((order, _),) in zip((0, -1), curve.ends, strict=True) if order == 1]] = 0.0

    def off(diagonal: np.ndarray, beside: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, ...]:
        *rest, found, info = solver(diagonal, beside, b)
        return (*rest, found + moved if b.ndim == 2 else found, info)

    monkeypatch.setattr(lapack, "dptsv", off)
    found = tridiagonal_fit(curve.ends, q, h)
    away = np.abs(found.trajectory.scaled - right.trajectory.scaled)[:, 1] / h[:, None]
    assert (away <= found.error[:, 1] + right.error[:, 1]).all()
    assert (found.error[:, 1, 0] < 3e-3).all()


def test_a_joint_that_stands_still_has_no_blur() -> None:
    curve = cubic_spline(120)
    q, h = drawn(curve, 1.0, 3)
    q[:, 1] = 2.5
    found = tridiagonal_fit(curve.ends, q, h)
    assert not found.trajectory.scaled[:, 1:, 1].any()
    assert found.error[:, 1:, 1].max() < 1e-230


def test_positions_far_from_zero_keep_their_rounding() -> None:
    curve = cubic_spline(120)
    q, h = drawn(curve, 0.3, 3)
    found = tridiagonal_fit(curve.ends, q + 1e9, h)
    assert (found.error[:, 0] > 1e-8).all()


@pytest.mark.parametrize("duration", [1e-10, 1e10])
def test_durations_beyond_the_analysis_are_left_to_the_blocks(duration: float) -> None:
    curve = cubic_spline(120)
    q, h = drawn(curve, 0.3, 5)
    h[7] = duration
    assert tridiagonal_fit(curve.ends, q, h) is None
    limits = Limits([1e12] * 2, [1e22] * 2)
    assert check(Problem(q, limits, curve), h).verdict is Verdict.PASS


def test_a_limit_left_open_is_judged_by_the_closer_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    curve = cubic_spline(120)
    q, h = drawn(curve, 0.3, 6)
    peaks = check(Problem(q, Limits([1.0] * 2, [1.0] * 2), curve), h).peaks
    limits = [p.value for p in peaks if p.quantity == "velocity"]
    tight = Problem(q, Limits(np.abs(limits)), curve)
    assert check(tight, h, tolerance=1e-12).verdict is Verdict.PASS
    monkeypatch.setattr(tridiagonal, "_MORE", 1e4)
    assert check(tight, h, tolerance=1e-12).verdict is Verdict.PASS
