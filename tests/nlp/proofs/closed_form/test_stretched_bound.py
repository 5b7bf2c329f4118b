"""Certificates of the stretched uniform cubic B-spline: closed form, own check, and attacks."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from trajgap.nlp.proofs.answer import keeps_limits, uniform_coefficients
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Outcome
from trajgap.problem import Limits, Problem, fit, solve_in_closed_form, uniform_cubic_b_spline
from trajgap.verify import Clock
from trajgap.verify import verify_certificate as verify
from trajgap.verify.curve import _uniform


def random_problem(seed: int) -> Problem:
    rng = np.random.default_rng(seed)
    count, joints = int(rng.integers(2, 7)), int(rng.integers(1, 4))
    q = rng.normal(0.4, 1.3, (count, joints))
    scale = rng.uniform(0.3, 4.0, (3, joints))
    some = rng.random(3) < 0.7
    some[rng.integers(0, 3)] = True
    v, a, j = (scale[i] if some[i] else np.full(joints, np.inf) for i in range(3))
    lower = rng.uniform(0.1, 1.5, count - 1) if rng.random() < 0.4 else 0.0
    return Problem(q, Limits(v, a, j), uniform_cubic_b_spline(count, "stretched"), lower)


@pytest.mark.parametrize("seed", range(12))
def test_the_interval_holds_the_closed_form(seed: int) -> None:
    problem = random_problem(seed)
    found = certify(problem)
    assert found.outcome is Outcome.CERTIFIED
    assert found.gap < 1e-11
    durations = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
    best = float(np.maximum(durations, problem.duration_lower).sum())
    assert float(found.lower) <= best * (1 + 1e-12)
    assert found.upper is not None
    assert float(found.upper) >= best * (1 - 1e-12)
    verdict = verify(certificate(found))
    assert str(verdict).startswith("proves")
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)


@pytest.mark.parametrize("seed", range(6))
def test_no_segment_can_be_shorter(seed: int) -> None:
    problem = random_problem(seed)
    found = certify(problem)
    assert found.durations is not None
    for k in range(problem.segments):
        shorter = list(found.durations)
        shorter[k] *= 1 - Fraction(1, 10**9)
        assert not keeps_limits(exact_problem(problem), shorter)


def test_the_curve_is_the_same_by_three_routes() -> None:
    # From the control vertices, from the slopes at the way-points, and from the fit in floats.
    q = [Fraction(x) for x in ("0.3", "1.25", "-0.75", "2", "1.9")]
    vertices = uniform_coefficients([[x] for x in q])[0]
    assert vertices == _uniform(q, Clock(60))
    curve = fit(
        uniform_cubic_b_spline(5, "stretched"), np.array([[float(x)] for x in q]), [1.0] * 4
    )
    for e in (0.1, 1.5, 2.75, 3.9):
        piece = vertices[int(e)]
        value = sum(float(c) * (e - int(e)) ** p for p, c in enumerate(piece))
        assert value == pytest.approx(float(curve(e)[0]), abs=1e-12)


def test_positions_are_judged() -> None:
    # It overshoots its highest way-point, whatever the durations.
    q = np.array([[0.0], [1.0], [0.9], [0.0]])
    curve = uniform_cubic_b_spline(4, "stretched")
    tight = Problem(q, Limits(1.0, position_upper=1.0), curve)
    assert certify(tight).outcome is Outcome.OPEN
    wide = certificate(certify(Problem(q, Limits(1.0, position_upper=1.2), curve)))
    assert verify(wide).proves
    wide["problem"]["position_upper"] = ["1"]
    assert "derivative 0 exceeds" in verify(wide).reason
