"""What holds of every certified interval, whatever the kind of proof, and a search beside it."""

import numpy as np
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import Problem, evaluate
from trajgap.verify import verify_certificate


def dense_best(problem: Problem, count: int = 20_000) -> float:
    """Least total over random durations, gathered around the best of them again and again.

    Where time may be stretched, each is as short as its ratios allow.
    """
    rng, n = np.random.default_rng(1), problem.segments
    low, high = np.maximum(problem.duration_lower, 1e-3), problem.duration_upper
    h, best = np.exp(rng.uniform(np.log(0.05), np.log(12.0), (count, n))), np.inf
    for spread in (0.3, 0.1, 0.03, 0.01, 0.003):
        if problem.curve.homogeneous:
            least = (problem.duration_lower / h).max(axis=1)
            h = h * (np.maximum(evaluate(problem, h).stretch, least) * (1 + 1e-11))[:, None]
            h = h[(h <= high).all(axis=1)]
        else:
            h = np.clip(h, low, high)
        found = evaluate(problem, h)
        kept = (found.ratios <= 1.0).all(axis=(1, 2)) & (found.positions <= 1.0).all(axis=1)
        if not kept.any():
            return best
        totals = np.where(kept, h.sum(axis=1), np.inf)
        best = min(best, float(totals.min()))
        top = np.repeat(h[totals.argsort()[:20]], 60, axis=0)
        h = np.vstack([top[::60], top * np.exp(spread * rng.normal(size=top.shape))])
    return best


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
