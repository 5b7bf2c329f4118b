"""Optima of drawn problems, kept in a folder of the user's for later audits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ....nlp import Solution, Status, kkt, problem_seal
from ....nlp.optimum import KKT_TOLERANCE, solve
from ....nlp.proofs import KeptFiles, as_text, from_text, search_code
from ....problem import TOLERANCE, Problem, check


class AskedOptimum(NamedTuple):
    """A problem, and from how many starts it is solved."""

    problem: Problem
    starts: int


class KeptOptima:
    """The optima that are kept in one folder.

    Parameters
    ----------
    where : bool or Path
        As `KeptFiles` takes it.
    """

    def __init__(self, where: bool | Path) -> None:
        self._files = KeptFiles(where, "optima")

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
        if not self._files.used:
            return [_solved(one) for one in asked]
        question = {
            "problems": [[problem_seal(p), repr(p.curve), starts] for p, starts in asked],
            "code": search_code(),
        }
        return self._files.answers(
            question,
            len(asked),
            lambda: map(_solved, asked),
            _left,
            lambda at, left: _judged(asked[at].problem, *left),
            lambda at: _solved(asked[at]),
        )


def _solved(asked: AskedOptimum) -> Solution:
    return solve(asked.problem, starts=asked.starts)


def _left(found: Solution) -> list[Any]:
    durations = as_text(found.durations) if found.found else None
    return [str(found.status), found.why, durations, repr(found.infimum), repr(found.lower_bound)]


def _judged(
    problem: Problem,
    status: str,
    why: str | None,
    durations: str | None,
    infimum: str,
    lower_bound: str,
) -> Solution:
    """The answer that left this; raises if its durations do not bear out its status."""
    if lower_bound != "None":
        raise ValueError("a bound that nothing here proves")
    limit = None if infimum == "None" else float(infimum)
    if durations is None:
        return Solution(problem, Status(status), why, infimum=limit)
    h = from_text(durations)
    verdict = check(problem, h)
    if h.shape != (problem.segments,) or verdict.max_violation > TOLERANCE:
        raise ValueError("durations that break a limit")
    if status in (Status.CONVERGED, Status.OPTIMAL) and kkt(problem, h).residual > KKT_TOLERANCE:
        raise ValueError("no optimum")
    return Solution(problem, Status(status), why, h, verdict, infimum=limit)
