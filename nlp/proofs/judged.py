"""Nothing counts as proved but what `trajgap.verify` proves."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from ...verify import Refused, verify_certificate
from ..clock import RunClock
from .crew import ProofCrew
from .document import certificate, stated_problem
from .exact import ExactProblem
from .outcome import Certified, Outcome


def why_too_large(problem: ExactProblem) -> str | None:
    """Why no certificate can state a problem, because something in it is too large; or None.

    Parameters
    ----------
    problem : ExactProblem

    Returns
    -------
    str or None
    """
    try:
        stated_problem(problem)
    except Refused as error:
        return f"no certificate can state the problem ({error})"
    return None


def judged(
    found: Certified,
    clock: RunClock,
    before: Certified | None = None,
    crew: ProofCrew | None = None,
) -> Certified:
    """What was found, with the verdict of `trajgap.verify`; nothing is proved without one.

    Parameters
    ----------
    found : Certified
    clock : RunClock
        Judging ends a second after its limit, or takes half a second. A proof that takes longer to
        judge does not count: it becomes what a state proposes, so a run with more time can go
        on from it.
    before : Certified, optional
        What the state that the run went on from proved, with its verdict: it holds if time is up.
    crew : ProofCrew, optional
        Who judges; without one, this process alone.

    Returns
    -------
    Certified
    """
    if found.proof is None:
        return found
    document, spread = certificate(found), None if crew is None else crew.spread
    verdict = verify_certificate(document, seconds=clock.judging, spread=spread)
    if verdict.proves:
        return replace(found, verdict=verdict)
    nothing = replace(
        found, outcome=Outcome.OPEN, lower=Fraction(0), proof=None, verdict=verdict, stopped=True
    )
    if not verdict.out_of_time:
        return replace(nothing, stopped=found.stopped)
    late = nothing if before is None else replace(before, nodes=found.nodes, seconds=found.seconds)
    return replace(late, proposals=found.proposals or found.proof)
