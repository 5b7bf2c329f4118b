"""How a proof about all curves is made and judged."""

from __future__ import annotations

from functools import partial

from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.exact import ExactProblem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import (
    Problem,
    load_case,
)
from trajgap.verify import CertificateVerdict, Subject
from trajgap.verify import verify_certificate as verify

certify_any = partial(certify, subject=Subject.ANY)


def proved(found: Certified) -> CertificateVerdict:
    """The certificate of a result, checked again, and found to say the same."""
    verdict = verify(certificate(found))
    assert verdict.proves, verdict
    assert not verdict.altered
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
    assert verdict.infeasible == (found.outcome is Outcome.INFEASIBLE)
    assert verdict.subject is Subject.ANY
    return verdict


# --- shipped problems -----------------------------------------------------------------------------


def printed(case: str, problem: str, reading: str) -> ExactProblem:
    return printed_problem(load_case(case).statement(problem, reading))


def interval(problem: Problem, gap: float = 1e-6) -> tuple[float, float]:
    """A certified interval of the wanted width."""
    found = certify_any(problem, gap=gap, seconds=30)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED, found
    assert found.upper is not None
    assert 0 <= found.gap <= gap
    return float(found.lower), float(found.upper)
