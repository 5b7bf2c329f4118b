"""Optima of drawn problems, kept in a folder of the user's for later audits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ....nlp import Solution, Status, kkt, problem_seal
from ....nlp.optimum import KKT_TOLERANCE, solve
from ....nlp.proofs import KeptFiles, as_text, from_text, search_code
from ....problem import Problem, Verdict, check


class AskedOptimum(NamedTuple):
    """A problem, and from how many starts it is solved."""

    problem: Problem
    starts: int


class KeptOptima(KeptFiles):
    """The optima that are kept in one folder."""

    kind = "optima"

    def solved(self, asked: Sequence[AskedOptimum]) -> Sequence[Solution]:
        """Answers of `solve`: those of an earlier audit, or else found now and kept.

        Parameters
        ----------
        asked : sequence of AskedOptimum
            A group that is kept, judged and discarded as a whole.

        Returns
        -------
        sequence of Solution
            Of what was kept: status, durations with their check, and infimum.
        """
        return self.answers(
            lambda: {
                "problems": [[problem_seal(p), repr(p.curve), starts] for p, starts in asked],
                "code": search_code(),
            },
            len(asked),
            lambda: map(_solved, asked),
            _left,
            lambda at, left: _judged(asked[at], *left),
            lambda at: _solved(asked[at]),
        )


def _solved(asked: AskedOptimum) -> Solution:
    return solve(asked.problem, starts=asked.starts)


def _left(found: Solution) -> list[Any]:
    durations = as_text(found.durations) if found.found else None
    return [str(found.status), found.why, durations, repr(found.infimum), repr(found.lower_bound)]


def _judged(asked: AskedOptimum, status: str, why: str | None, durations: str, *_: str) -> Solution:
    """The answer that left this; raises if its durations do not bear out its status.

    What no durations bear out, such as that there are none, is searched for again.
    """
    if status not in (Status.CONVERGED, Status.FEASIBLE):
        return _solved(asked)
    problem, h = asked.problem, from_text(durations)
    verdict = check(problem, h)
    if verdict.limits is not Verdict.PASS:
        raise ValueError("durations that break a limit")
    if status == Status.CONVERGED and kkt(problem, h).residual > KKT_TOLERANCE:
        raise ValueError("no optimum")
    return Solution(problem, Status(status), why, h, verdict)
