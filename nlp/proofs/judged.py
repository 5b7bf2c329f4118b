"""Nothing counts as proved but what `trajgap.verify` proves."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from fractions import Fraction

from ...verify import Refused, read_problem, verify_certificate
from .crew import ProofCrew
from .document import certificate, problem_document
from .exact import ExactProblem
from .outcome import Certified, Outcome

SPARE = 1.0
"""Seconds that judging may take beyond the time limit: what takes no time is judged without one."""
LEAST = 0.5
"""Seconds that judging has whenever it begins: a certificate of usual size takes a tenth of it."""


@dataclass(frozen=True)
class Deadline:
    """The time limit of a certification: what it goes on from, its search and its judging.

    Attributes
    ----------
    end : float
        Of the limit, by `time.perf_counter`.
    """

    end: float

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """So many seconds from now."""
        return cls(time.perf_counter() + seconds)

    @property
    def left(self) -> float:
        """Seconds until then; 0 where it is over."""
        return max(0.0, self.end - time.perf_counter())

    @property
    def judging(self) -> float:
        """Seconds that judging may take: until `SPARE` after the limit, and `LEAST` at least."""
        return max(LEAST, self.end + SPARE - time.perf_counter())


def why_too_large(problem: ExactProblem) -> str | None:
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


def judged(
    found: Certified,
    deadline: Deadline,
    before: Certified | None = None,
    crew: ProofCrew | None = None,
) -> Certified:
    """What was found, with the verdict of `trajgap.verify`; nothing is proved without one.

    Parameters
    ----------
    found : Certified
    deadline : Deadline
        Judging ends `SPARE` after it, or takes `LEAST`. A proof that takes longer to judge does not
        count: it becomes what a state proposes, so that a run with more time can go on from it.
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
    verdict = verify_certificate(document, seconds=deadline.judging, spread=spread)
    if verdict.proves:
        return replace(found, verdict=verdict)
    nothing = replace(
        found, outcome=Outcome.OPEN, lower=Fraction(0), proof=None, verdict=verdict, stopped=True
    )
    if not verdict.out_of_time:
        return replace(nothing, stopped=found.stopped)
    late = nothing if before is None else replace(before, nodes=found.nodes, seconds=found.seconds)
    return replace(late, proposals=found.proposals or found.proof)
