"""Certificates at work: what a re-proved certificate says about a problem and a solver's answer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from ...problem import TOLERANCE, TrajgapError, Verdict, check
from ...problem.cases import Statement
from ...verify import CertificateVerdict, Subject, verify_certificate
from ..optimum import KEPT, Solution, Status, close, solve
from .certifiers import certify, covered, instant
from .document import fits, shipped
from .exact import ExactProblem, printed_problem
from .judged import why_too_large
from .outcome import GAP


@dataclass(frozen=True)
class ProvedInterval:
    """The interval that a verified certificate proves.

    Attributes
    ----------
    lower : Fraction
        No feasible total is below it, s.
    upper : Fraction or None
        A feasible total, s.
    durations : tuple of Fraction or None
        Of that total.
    infeasible : bool
    """

    lower: Fraction
    upper: Fraction | None
    durations: tuple[Fraction, ...] | None
    infeasible: bool


@lru_cache(maxsize=1024)
def proved(problem: ExactProblem, subject: Subject = Subject.DECLARED) -> ProvedInterval | None:
    """The interval of a shipped certificate, or of a closed form, verified once per process.

    Parameters
    ----------
    problem : ExactProblem
    subject : Subject
        Curves that the interval covers.

    Returns
    -------
    ProvedInterval or None
        None without a certificate of exactly this problem, or if it does not prove its claim
        or leaves an interval wider than 1 %.
    """
    if why_too_large(problem) is not None:
        return None
    document = None if problem.relaxed else shipped(problem, subject)
    if document is None and subject is Subject.DECLARED and covered(problem) is None:
        if not instant(problem):
            return None
        found = certify(problem)
        return _narrow(interval_in(found.verdict, found.durations))
    return None if document is None else proved_again(document)


def interval_of(
    document: dict[str, Any],
    problem: ExactProblem,
    subject: Subject = Subject.DECLARED,
    verdict: CertificateVerdict | None = None,
) -> ProvedInterval | None:
    """The interval of a given certificate, proved again.

    Parameters
    ----------
    document : dict
        Of any origin: nothing in it is trusted.
    problem : ExactProblem
    subject : Subject
    verdict : CertificateVerdict, optional
        What `verify_certificate` said of this very document, if it was asked already.

    Returns
    -------
    ProvedInterval or None
        None if it is about another problem, or one without some of its limits, proves nothing, or
        leaves an interval wider than 1 %.
    """
    if problem.relaxed or why_too_large(problem) is not None:
        return None
    if not fits(document, problem, subject):
        return None
    return proved_again(document, verdict)


def proved_again(
    document: dict[str, Any], verdict: CertificateVerdict | None = None
) -> ProvedInterval | None:
    """What a certificate proves; None if that is nothing, or wider than 1 %."""
    verdict = verdict or verify_certificate(document)
    if not verdict.proves:
        return None
    given = document["claim"]["durations"]
    durations = None if given is None else tuple(Fraction(h) for h in given)
    return _narrow(interval_in(verdict, durations))


def _narrow(found: ProvedInterval | None) -> ProvedInterval | None:
    if found is None or found.upper is None or close(float(found.lower), float(found.upper)):
        return found
    return None


def interval_in(
    verdict: CertificateVerdict | None, durations: tuple[Fraction, ...] | None
) -> ProvedInterval | None:
    """What is proved of an answer, however wide; None if that is nothing."""
    if verdict is None or not verdict.proves or verdict.lower is None:
        return None
    return ProvedInterval(verdict.lower, verdict.upper, durations, verdict.infeasible)


def printed_problem_or_none(statement: Statement, joint: int | None = None) -> ExactProblem | None:
    """`printed_problem` of all joints or of one; None if it cannot be stated exactly."""
    try:
        exact = printed_problem(statement)
    except TrajgapError:
        return None
    return exact if joint is None or len(exact.joints) == 1 else exact.joint(joint)


def with_interval(solution: Solution, found: ProvedInterval | None) -> Solution:
    """Add a proved lower bound of the same problem.

    Parameters
    ----------
    solution : Solution
    found : ProvedInterval or None
        Proved for the same problem in exact numbers.

    Returns
    -------
    Solution
        Solved once more from the certificate's durations if these are shorter; at these durations
        if the answer lies below the bound by no more than the tolerance of a descent. It is
        *optimal* if the bound is within a millionth of its total. Unchanged if nothing is proved,
        or if the answer lies farther below the bound: then one of the two is wrong. Where limits
        were left out of the proof, `why` says so.
    """
    if found is None or found.infeasible:
        return solution
    left_out = solution.problem.limits.unproved
    if left_out and solution.best < math.inf:
        said = "the lower bound is proved without the limits of " + " and ".join(left_out)
        why = said if solution.why is None else f"{solution.why}; {said}"
        return _bounded(replace(solution, why=why), found)
    proved = found.durations
    if proved is not None and not solution.best <= float(sum(proved)) * (1 + TOLERANCE):
        start = np.array([float(h) for h in proved])
        again = solve(solution.problem, initial=start, known=start)
        solution = again if again.best < solution.best else solution
    return _bounded(solution, found)


def _bounded(solution: Solution, found: ProvedInterval) -> Solution:
    """The answer with a lower bound that is proved."""
    lower = float(found.lower)
    if Fraction(lower) > found.lower:
        lower = math.nextafter(lower, -math.inf)
    near = solution.infimum is None and lower * (1.0 - KEPT) <= solution.best < lower
    if near and found.durations is not None:
        solution = _proved_answer(solution, found.durations)
    if not lower <= solution.best < math.inf:
        return solution
    shortest = solution.infimum is None and lower >= solution.best * (1.0 - GAP)
    status = Status.OPTIMAL if shortest else solution.status
    return replace(solution, lower_bound=lower, status=status)


def _proved_answer(solution: Solution, durations: tuple[Fraction, ...]) -> Solution:
    """The answer at proved durations, rounded up; as it was if they do not pass in floats."""
    rounded = [float(h) for h in durations]
    h = np.array(
        [
            math.nextafter(x, math.inf) if Fraction(x) < d else x
            for x, d in zip(rounded, durations, strict=True)
        ]
    )
    found = check(solution.problem, h)
    if found.verdict is not Verdict.PASS:
        return solution
    return replace(solution, vector=h, check=found)
