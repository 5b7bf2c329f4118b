"""Problems of the bound over all curves, and an answer that is checked."""

import numpy as np
import pytest
from support.puma import PUMA, PUMA_LIMITS
from trajgap.nlp import Evidence
from trajgap.nlp.proofs.any_curve.estimate import AnyCurveEstimate
from trajgap.nlp.proofs.any_curve.reach import profile
from trajgap.problem import (
    Problem,
    three_five_three,
)

PUMA_PROBLEM = Problem(PUMA, PUMA_LIMITS, three_five_three())


def verified(problem: Problem, found: AnyCurveEstimate) -> float:
    """Total of an answer whose curves are built and judged one by one."""
    assert found.total_time is not None, found.why
    assert found.durations is not None
    assert found.nodal_velocities is not None
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
