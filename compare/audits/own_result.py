"""Which printed times a paper calls its result, and every total that it prints of one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf
from typing import TypeVar

from ...problem import Case
from ...problem.cases import (
    AnyClaim,
    Claim,
    ImprovementClaim,
    StatementClaim,
    TimeClaim,
    TotalTimeClaim,
)
from ..documents import ClaimVerdict, Severity
from .printed_row import PrintedRow
from .stated import RowClaim, other_objective, own_total, place, printed_total

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

    There are none of no times.
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


UNSAID = "The text does not claim that these durations keep the limits."
"""What follows a broken limit where no word of the paper is contradicted by it."""


def said_to_keep(case: Case, claim: AnyClaim) -> bool:
    """Whether the paper says that these durations keep the limits.

    It does where a statement about limits or optimality names them, or the total that is printed of
    them. Nothing else does: a table of limits, a named algorithm or a row of a comparison says what
    was asked, not that this row answers it.
    """
    totals = {c.id for c in case.claims if isinstance(c, TotalTimeClaim) and c.of == claim.id}
    return any({claim.id, *totals}.intersection(c.of) for c in _statements(case))


def meant_to_keep(case: Case, claim: AnyClaim) -> bool:
    """Whether durations are meant as an answer within the limits, said or not.

    They are if the paper says so, or an algorithm found them and they are not the state before an
    optimisation. Where no statement names any durations, they are too, unless they are what an
    improvement starts from.
    """
    if said_to_keep(case, claim):
        return True
    if isinstance(claim, TimeClaim) and claim.state == "before":
        return False
    improved = any(isinstance(c, ImprovementClaim) and c.slower == claim.id for c in case.claims)
    return claim.algorithm is not None or not (_statements(case) or improved)


def said_of(
    case: Case, claim: AnyClaim, verdict: ClaimVerdict, severity: Severity
) -> tuple[ClaimVerdict, Severity]:
    """What a verdict on the limits means for the claim of the durations.

    A broken limit refutes only what is said to keep it.
    """
    if said_to_keep(case, claim):
        return verdict, severity
    supported = verdict is ClaimVerdict.SUPPORTED and severity is Severity.INFO
    if supported and meant_to_keep(case, claim):
        return verdict, severity
    return ClaimVerdict.NOT_CHECKABLE, Severity.INFO


def _statements(case: Case) -> list[StatementClaim]:
    """Statements about limits or optimality that name what they speak of."""
    about = ("within_limits", "optimal")
    found = [c for c in case.claims if isinstance(c, StatementClaim) and c.checks in about]
    return [c for c in found if c.of]


# --- totals of one result -------------------------------------------------------------------------


def other_totals(row: PrintedRow[Claim]) -> list[TotalTimeClaim]:
    """Totals that other claims state of a row and that no value of its own digits rounds to.

    Only a row with durations has any. Digits may be rounded or cut off.
    """
    own = row.total
    if own is None or not isinstance(row.claim, RowClaim):
        return []
    low, high = own.interval[0], max(own.interval[1], row.longest_total)
    found = []
    for one in row.study.case.claims:
        if isinstance(one, TotalTimeClaim) and one.of == row.claim.id:
            printed = row.measured(one.value, "time")
            apart = printed.lower > high or printed.cut_off().upper < low
            found += [one] if apart and row.study.fits(one, row.pair) else []
    return found


def contradicts_its_parts(row: PrintedRow[Claim]) -> bool:
    """Whether a total printed beside durations is not their sum, rounded or cut off."""
    number = printed_total(row.claim)
    if number is None or not isinstance(row.claim, RowClaim):
        return False
    box, total = row.durations, row.time(number)
    longest = float((box.upper + (box.upper - box.lower) / 2).sum())
    return bool(total.lower > longest or total.cut_off().upper < _raised_low(row))


def _raised_low(row: PrintedRow[Claim]) -> float:
    """Low end of the sum of durations whose digits were rounded up, s."""
    box = row.durations
    return float((box.lower - (box.upper - box.lower) / 2).sum())


def contradicting_lows(row: PrintedRow[AnyClaim]) -> dict[str, float]:
    """Other totals that are printed of a row and contradict its own, each with its low end, s."""
    study = row.study
    if not isinstance(row.claim, TimeClaim):
        return {}
    found = {}
    for other in other_totals(row):
        own = PrintedRow(study, other, row.pair)
        shown, interval = own.total or ("", (inf, inf))
        found[f"{shown} ({place(other)})"] = rounded_up_low(own, interval)
    if contradicts_its_parts(row):
        plain = sum(number.decimal for number in study.case.printed_durations(row.claim))
        found[f"durations that add up to {plain} {study.time_unit}"] = _raised_low(row)
    return found


def total_excludes(row: PrintedRow[AnyClaim], time: float) -> bool:
    """Whether a total that is printed beside durations stands for no such time, s.

    A total that is the sum of the printed digits says no more than they do.
    """
    number = own_total(row.claim)
    if number is None or not isinstance(row.claim, RowClaim):
        return False
    total = row.time(number)
    low = total.lower - (total.upper - total.lower) / 2
    return not low <= time <= total.cut_off().upper


def rounded_up_low(row: PrintedRow[AnyClaim], interval: tuple[float, float]) -> float:
    """Low end of a printed total whose digits were rounded up, as durations are to keep a limit.

    Rounding up moves the low end of each number down by another half of its last place; a total
    beside durations is then the sum of what was rounded up.
    """
    low, high = interval
    own = low - (high - low) / 2
    return min(low, _raised_low(row)) if isinstance(row.claim, RowClaim) else own
