"""Problems of cubic splines that are certified, and a search beside them."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

import numpy as np
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic.system import cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import problem_document
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline_virtual,
    evaluate,
)
from trajgap.verify import read_problem
from trajgap.verify.cubic.system import Cubic

NATURAL = ((2, 0.0),)


def dense_best(problem: Problem, count: int = 40_000) -> float:
    """Smallest total over many directions, each stretched as little as it may be."""
    rng = np.random.default_rng(1)
    n = problem.segments
    shares = rng.dirichlet(np.full(n, 0.8), count)
    for width in (0.3, 0.1, 0.03):
        totals = _totals(problem, shares)
        near = shares[np.argsort(totals)[:50]]
        moved = np.repeat(near, 200, axis=0) * np.exp(rng.normal(0, width, (10_000, n)))
        shares = np.vstack([shares, moved / moved.sum(axis=1, keepdims=True)])
    return float(_totals(problem, shares).min())


def _totals(problem: Problem, shares: np.ndarray) -> np.ndarray:
    shares = np.maximum(shares, 1e-9)
    stretch = evaluate(problem, shares).stretch
    stretch = np.maximum(stretch, (problem.duration_lower / shares).max(axis=1))
    stretch[(shares * stretch[:, None] > problem.duration_upper).any(axis=1)] = np.inf
    return np.asarray(stretch * shares.sum(axis=1))


def base_problem() -> Problem:
    q = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
    return Problem(q, Limits([1.1, 0.9], [1.9, 2.3], [7.0, 9.0]), cubic_spline_virtual(3))


@lru_cache(maxsize=1)
def base() -> Certified:
    return certify(base_problem(), gap=0.02)


def both(problem: Problem, cap: int) -> tuple[Prover, Cubic]:
    """Solver and verifier for one problem, by their own routes."""
    exact = exact_problem(problem)
    prover = Prover(cubic_system(exact, Fraction(11)), cap)
    proof = {"powers": list(prover.system.powers), "second": prover.system.second, "cap": cap}
    return prover, Cubic(read_problem(problem_document(exact)), proof)
