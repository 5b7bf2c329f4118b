"""Nothing counts as proved but what `trajgap.verify` proves."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from ...verify import Refused, read_problem, verify_certificate
from .document import certificate, problem_document
from .exact import ExactProblem
from .outcome import Certified, Outcome
from .state import SECONDS


def unstated(problem: ExactProblem) -> str | None:
    """Why no certificate can state a problem, since something in it is too large; or None.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    str or None
    """
    try:
        read_problem(problem_document(problem))
    except Refused as error:
        return f"no certificate can state the problem ({error})"
    return None


def judged(found: Certified) -> Certified:
    """What was found, with the verdict of `trajgap.verify`; nothing is proved without one.

    Parameters
    ----------
    found : Certified

    Returns
    -------
    Certified
    """
    if found.proof is None:
        return found
    verdict = verify_certificate(certificate(found), seconds=SECONDS)
    if verdict.proves:
        return replace(found, verdict=verdict)
    nothing = replace(found, outcome=Outcome.OPEN, lower=Fraction(0), proof=None)
    return replace(nothing, verdict=verdict)
