"""Which of several printed times a paper calls its result, never by the order of the file alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from ...problem import Case
from ...problem.cases import ImprovementClaim, StatementClaim, TimeClaim, TotalTimeClaim
from .stated import other_objective

_Time = TypeVar("_Time", bound=TimeClaim)


def own_result(case: Case, times: Sequence[_Time]) -> _Time | None:
    """The printed time that a paper calls its result, of some that could be.

    Not the state before an optimisation, nor a row that minimises something else than the file
    says, where there are others. Of these the one that is called optimal, else the one that an
    improvement leads to, else one that no improvement starts from and that is no named method's
    where others name none; the last of several.

    Parameters
    ----------
    case : Case
    times : sequence of TimeClaim

    Returns
    -------
    TimeClaim or None
        None of none.
    """
    answers = [c for c in times if c.state != "before"] or list(times)
    answers = [c for c in answers if c.objective is None or not other_objective(case, c)] or answers
    improved = [c for c in case.claims if isinstance(c, ImprovementClaim)]
    said = (c for c in case.claims if isinstance(c, StatementClaim) and c.checks == "optimal")
    optimal = {one for statement in said for one in statement.of}
    left = _meant(case, [c.slower for c in improved], answers)
    answers = [c for c in answers if c not in left] or answers
    unnamed = [c for c in answers if c.algorithm is None] or answers
    for meant in (
        [c for c in answers if c.id in optimal],
        _meant(case, [c.faster for c in improved], answers),
        unnamed,
    ):
        if meant:
            return meant[-1]
    return None


def _meant(case: Case, ids: Iterable[str], answers: Sequence[_Time]) -> list[_Time]:
    """The times behind some claims of a time: their own, or those of the same algorithm."""
    found = [case.claim(one) for one in ids]
    named = {c.id for c in found} | {c.of for c in found if isinstance(c, TotalTimeClaim)}
    by = {c.algorithm for c in found} - {None}
    return [c for c in answers if c.id in named or c.algorithm in by]
