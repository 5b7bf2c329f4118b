"""Questions about all curves: their problems, and how estimates and proofs are judged."""

from functools import partial

import numpy as np
import pytest
from numpy.typing import ArrayLike
from support.puma import PUMA, PUMA_LIMITS
from trajgap.nlp import Evidence
from trajgap.nlp.proofs.any_curve.estimate import AnyCurveEstimate
from trajgap.nlp.proofs.any_curve.reach import profile
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import ExactProblem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import Limits, Problem, cubic_spline, load_case, three_five_three
from trajgap.verify import CertificateVerdict, Subject, verify_certificate as verify

certify_any = partial(certify, subject=Subject.ANY)
PUMA_PROBLEM = Problem(PUMA, PUMA_LIMITS, three_five_three())
_WALK = np.random.default_rng(5).normal(0.0, 1.0, (4, 2)).round(2)
DETOUR = Problem(_WALK, Limits([2.0, 1.5], [2.0, 3.0]), cubic_spline(3), 0.0, [20.0, 30.0, 40.0])
"""One box does not settle it."""


def spline_problem(
    waypoints: ArrayLike,
    velocity: ArrayLike = np.inf,
    acceleration: ArrayLike = np.inf,
    ends: tuple[tuple[int, float], ...] = ((1, 0.0),),
    **bounds: ArrayLike,
) -> Problem:
    """A C2 cubic spline from a few numbers."""
    q = np.asarray(waypoints, dtype=float)
    q = q[:, None] if q.ndim == 1 else q
    limits = Limits(np.asarray(velocity), np.asarray(acceleration), joints=q.shape[1])
    return Problem(q, limits, cubic_spline(len(q) - 1, ends), **bounds)


def random_problem(rng: np.random.Generator, segments: int, joints: int) -> Problem:
    q = rng.normal(size=(segments + 1, joints))
    return spline_problem(q, rng.uniform(0.8, 3.0, joints), rng.uniform(1.0, 6.0, joints))


def proved(found: Certified) -> CertificateVerdict:
    """The certificate of a result, checked again, and found to say the same."""
    verdict = verify(certificate(found))
    assert verdict.proves, verdict
    assert not verdict.altered
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
    assert verdict.infeasible == (found.outcome is Outcome.INFEASIBLE)
    assert verdict.subject is Subject.ANY
    return verdict


def printed(case: str, problem: str, reading: str) -> ExactProblem:
    return printed_problem(load_case(case).statement(problem, reading))


def interval(problem: Problem, gap: float = 1e-6) -> tuple[float, float]:
    """A certified interval of the wanted width."""
    found = certify_any(problem, gap=gap, seconds=30)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED, found
    assert 0 <= found.gap <= gap
    return float(found.lower), float(found.upper)


def verified(problem: Problem, found: AnyCurveEstimate) -> float:
    """Total of an answer whose curves are built and judged one by one."""
    assert found.total_time is not None, found.why
    assert found.evidence is Evidence.BEST_KNOWN
    limits = problem.limits
    for k, h in enumerate(found.durations):
        for j in range(problem.waypoints.shape[1]):
            step = float(problem.waypoints[k + 1, j] - problem.waypoints[k, j])
            v0, v1 = found.nodal_velocities[k : k + 2, j]
            if np.isnan(v0) or h == 0:
                assert abs(step) <= limits.velocity[j] * h * (1 + 1e-12) or h == 0
                continue
            if step == v0 == v1 == 0:
                continue
            curve = profile(step, v0, v1, h, limits.velocity[j], limits.acceleration[j])
            assert curve.time[-1] == h
            assert curve.velocity[[0, -1]] == pytest.approx([v0, v1], abs=1e-12)
            assert curve.displacement == pytest.approx(step, abs=1e-12)
            assert np.abs(curve.velocity).max() <= limits.velocity[j] * (1 + 1e-12)
            # Corners may differ by no more than rounding.
            rounding = 8 * np.finfo(np.float64).eps * np.abs(curve.velocity).max()
            change = np.maximum(0.0, np.abs(np.diff(curve.velocity)) - rounding)
            assert (change / np.diff(curve.time)).max() <= limits.acceleration[j] * (1 + 1e-9)
    assert found.total_time == pytest.approx(found.durations.sum(), rel=1e-15)
    return found.total_time
