"""Which of several printed times a paper calls its result, never by the order of the file alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

from ...problem import Case
from ...problem.cases import ImprovementClaim, StatementClaim, TimeClaim, TotalTimeClaim
from .stated import other_objective

_Time = TypeVar("_Time", bound=TimeClaim)


def own_result(case: Case, times: Sequence[_Time]) -> _Time | None:
    """The printed time that a paper calls its result: the last of `own_results`, None of none."""
    return next(reversed(own_results(case, times)), None)


def own_results(case: Case, times: Sequence[_Time]) -> list[_Time]:
    """The printed times that a paper calls its results, of some that could be.

    Not the state before an optimisation, nor a row that minimises something else than the file
    says, where there are others. Of these the ones that are called optimal, else those that an
    improvement leads to, else those that no improvement starts from and that are no named method's
    where others name none, before all of them those that are said to keep the limits. Several
    joints or problems have a row each.

    Returns
    -------
    list of TimeClaim
        Empty of none.
    """
    answers = [c for c in times if c.state != "before"] or list(times)
    answers = [c for c in answers if c.objective is None or not other_objective(case, c)] or answers
    improved = [c for c in case.claims if isinstance(c, ImprovementClaim)]
    said = [c for c in case.claims if isinstance(c, StatementClaim)]
    optimal = {one for c in said if c.checks == "optimal" for one in c.of}
    kept = {one for c in said if c.checks == "within_limits" for one in c.of}
    left = _meant(case, [c.slower for c in improved], answers)
    answers = [c for c in answers if c not in left] or answers
    unnamed = [c for c in answers if c.algorithm is None] or answers
    choices = (
        [c for c in answers if c.id in optimal],
        _meant(case, [c.faster for c in improved], answers),
        [c for c in unnamed if c.id in kept],
        unnamed,
    )
    return next((meant for meant in choices if meant), [])


def bare_totals(case: Case, problem: str) -> list[TotalTimeClaim]:
    """Totals of all joints on the problem's own curve, printed apart from durations."""
    return [
        c
        for c in case.claims
        if isinstance(c, TotalTimeClaim)
        and (c.joint, c.other_curve) == (None, None)
        and c.problem in (None, problem)
    ]


def _meant(case: Case, ids: Iterable[str], answers: Sequence[_Time]) -> list[_Time]:
    """The times behind some claims of a time: their own, or those of the same algorithm."""
    found = [case.claim(one) for one in ids]
    named = {c.id for c in found} | {c.of for c in found if isinstance(c, TotalTimeClaim)}
    by = {c.algorithm for c in found} - {None}
    return [c for c in answers if c.id in named or c.algorithm in by]
