"""What holds of every certified interval, whatever the kind of proof."""

from __future__ import annotations

import numpy as np
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import Problem
from trajgap.verify import verify_certificate


def judged(problem: Problem, found: Certified, best: float) -> Outcome:
    """The outcome, once the interval, its answer and its proof hold beside the best total known."""
    if found.outcome is Outcome.INFEASIBLE:
        assert best == np.inf
    else:
        assert float(found.lower) <= best * (1 + 1e-9)
        if found.upper is not None:
            assert found.lower <= found.upper
            assert found.durations is not None
            assert keeps_limits(exact_problem(problem), found.durations)
    if found.proof is not None:
        verdict = verify_certificate(certificate(found))
        assert verdict.proves, verdict
        assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
    return found.outcome
