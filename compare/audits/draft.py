"""The same judgement for an author before submission: what to change, with the numbers to print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from decimal import ROUND_CEILING, Decimal

from ...problem import Array, Check, Problem, Verdict, check, from_si
from ...problem.cases import (
    AnyClaim,
    DurationsClaim,
    MaximumClaim,
    StatementClaim,
    TotalTimeClaim,
)
from ..documents import Advice, Cause, ClaimVerdict, Finding, Judgement, Severity, Urgency
from .card_errors import plainly
from .chosen_case import Pair
from .fixed_ratios import optimum_called
from .stated import spoken
from .study import Study

_DECIMALS = 4
"""Decimals of proposed durations where the draft prints none to follow."""
_UNITS_UP = 20
"""Units of the last digit by which rounded durations are lengthened at most until they keep the
limits: rounding up alone nearly always does, since longer segments are slower ones."""


_FIXES = {
    "TG102": "Print the longest duration of each segment over the rows.",
    "TG104": "Two of your tables are alike: put the right numbers into one of them.",
    "TG107": "Drop conditions or raise a degree until they are as many as the coefficients.",
    "TG109": "Print one duration for each segment.",
    "TG202": "Name a curve that is continuous, or say that its velocity jumps.",
    "TG205": "Print the control vertices that follow from your way-points.",
    "TG601": "Compare joint angles and positions with your model of the robot.",
}
"""How to fix what a rule finds, where no number is needed."""
_COMPUTED = {
    "TG103": "Print {computed}, or correct the totals that it compares.",
    "TG105": "Print one total in both places: {printed} or {computed}.",
    "TG203": "Print {computed} as the largest value, taken at the true extremum.",
    "TG208": "Print {computed}, or say how it was sampled.",
}
"""The same with the number that was computed."""


def advise(
    study: Study,
    causes: Sequence[Cause],
    judgements: Sequence[Judgement],
) -> tuple[Advice, ...]:
    """What an author can change before submitting, the gravest first.

    Parameters
    ----------
    study : Study
    causes : sequence of Cause
    judgements : sequence of Judgement
        Of the same audit.

    Returns
    -------
    tuple of Advice
        One for each cause, for each claim whose answer depends on the reading, for each that cannot
        be checked, and for what is left open.
    """
    found = [_of_cause(study, cause) for cause in causes]
    said = {one.claim for one in found}
    for judgement in judgements:
        claim = study.case.claim(judgement.claim)
        if claim.id in said:
            continue
        if judgement.verdict is ClaimVerdict.DEPENDS:
            found.append(_of_readings(study, claim, judgement))
        elif judgement.verdict is ClaimVerdict.NOT_CHECKABLE:
            why = spoken(study.case, judgement.why).removeprefix(f"{claim.where}: ")
            found.append(
                Advice(
                    urgency=Urgency.OPEN,
                    where=claim.where,
                    claim=claim.id,
                    says=f"A reader cannot check this: {why}",
                    change="Print what is missing, or say less.",
                )
            )
    found += _left_open(study)
    return tuple(sorted(found, key=lambda one: list(Urgency).index(one.urgency)))


def _of_cause(study: Study, cause: Cause) -> Advice:
    claim = study.case.claim(cause.claim) if cause.claim else None
    where = claim.where if claim is not None else "the whole draft"
    change = "" if cause.head is None else _change(study, claim, cause.head)
    against = cause.severity is Severity.ERROR
    return Advice(
        urgency=Urgency.CONTRADICTED if against else Urgency.DOUBTFUL,
        where=where,
        claim=cause.claim,
        says=plainly(study.case, cause),
        change=change or "Compare the numbers with those of your program, and correct the text.",
    )


def _change(study: Study, claim: AnyClaim | None, head: Finding) -> str:
    """How to fix what a finding is about; empty where there is nothing special to say."""
    if head.rule in _FIXES:
        return _FIXES[head.rule]
    if head.rule == "TG101" and isinstance(claim, DurationsClaim | MaximumClaim):
        return f"Print {_sum_of(study, claim)} as the total, or correct the parts."
    if head.rule in _COMPUTED and head.computed is not None:
        return _COMPUTED[head.rule].format(computed=head.computed, printed=head.printed)
    if claim is None or head.rule not in ("TG201", "TG301", "TG302"):
        return ""
    for pid, rid in _pairs(study, head):
        timed = _timed(study, claim, pid, rid)
        if head.rule == "TG201":
            said = "" if timed is None else _longer(study, timed, pid, rid)
        else:
            said = _shorter(study, timed or claim, pid, rid)
        if said:
            return said
    return ""


def _sum_of(study: Study, claim: DurationsClaim | MaximumClaim) -> str:
    """The sum of printed parts to the last of their digits, which a paper can print."""
    return f"{sum(one.decimal for one in claim.durations)} {study.time_unit}"


def _pairs(study: Study, head: Finding) -> Iterator[Pair]:
    """Problems and readings that a finding speaks of, the default reading first."""
    for pid, rid in sorted(study.pairs, key=lambda pair: pair[1] != study.main_reading):
        if head.problem in (None, pid) and head.reading in (None, rid):
            yield pid, rid


def _timed(study: Study, claim: AnyClaim, pid: str, rid: str) -> AnyClaim | None:
    """The claim of durations that a claim is or speaks about, under one problem and reading."""
    about = claim.of if isinstance(claim, StatementClaim) else ()
    for one in (claim, *(study.case.claim(name) for name in about)):
        if study.has_durations(one) and study.fits(one, pid, rid):
            return one
    return None


def _longer(study: Study, claim: AnyClaim, pid: str, rid: str) -> str:
    """Durations that keep the limits as printed: those of the draft, stretched and rounded up."""
    if study.unmoved(claim, pid, rid) is not None:
        return ""
    found = study.claim_check(claim, pid, rid)
    if found.feasible_time is None:
        return ""
    durations = study.case.claim_durations(claim, rid).value * max(found.stretch, 1.0)
    problem = study.claim_problem(claim, pid, rid)
    shown = _printable(study, claim, problem, durations, pid, rid)
    if shown is None:
        return f"Multiply all durations by {found.stretch:.6g}, and print enough digits."
    return (
        f"Multiply all durations by {found.stretch:.6g}, which reaches the limits exactly, and "
        f"round up: {shown} keep every limit as printed."
    )


def _shorter(study: Study, claim: AnyClaim, pid: str, rid: str) -> str:
    """Do not call it optimal, and a motion that is shorter."""
    if not isinstance(claim, DurationsClaim | MaximumClaim | TotalTimeClaim):
        return "Say “near-optimal” with the distance instead of “optimal”."
    found = study.claim_optimum(claim, pid, rid)
    if found.durations is None:
        return "Say “near-optimal” with the distance instead of “optimal”."
    problem = study.claim_problem(claim, pid, rid)
    shown = _printable(study, claim, problem, found.durations, pid, rid)
    shorter = f": {shown} keep every limit as printed" if shown else ""
    return (
        f"Say how far it is from the {optimum_called(found.problem, found.evidence)}, "
        f"{found.best:.6g} s, instead of "
        f"calling it optimal; or print the shorter motion{shorter}."
    )


def _printable(
    study: Study, claim: AnyClaim, problem: Problem, durations: Array, pid: str, rid: str
) -> str | None:
    """Durations rounded up to the draft's decimals that `check` passes; None if none is found."""
    unit = study.case.statement(pid, rid).units.time or "s"
    digits = [
        -int(exponent)
        for number in study.case.printed_durations(claim)
        if isinstance(exponent := number.decimal.as_tuple().exponent, int)
    ]
    step = Decimal(1).scaleb(-(max(digits, default=_DECIMALS)))
    in_unit = [Decimal(from_si(float(h), unit)) for h in durations]
    rounded = [value.quantize(step, rounding=ROUND_CEILING) for value in in_unit]
    for up in range(_UNITS_UP):
        tried = [value + up * step for value in rounded]
        if _checked(problem, tried, durations, unit).verdict is Verdict.PASS:
            total = sum(tried)
            return f"{', '.join(map(str, tried))} {unit} (total {total} {unit})"
    return None


def _checked(problem: Problem, tried: Sequence[Decimal], like: Array, unit: str) -> Check:
    seconds = like.copy()
    scale = from_si(1.0, unit)
    for k, value in enumerate(tried):
        seconds[k] = float(value) / scale
    return check(problem, seconds)


def _of_readings(study: Study, claim: AnyClaim, judgement: Judgement) -> Advice:
    whys = {r.id: r.why.removesuffix(".") for r in study.case.readings}
    groups: dict[ClaimVerdict, list[str]] = {}
    for rid, word in judgement.readings.items():
        groups.setdefault(word, []).append(whys.get(rid, rid))
    parts = [f"{word} if {_some(names)}" for word, names in groups.items()]
    return Advice(
        urgency=Urgency.DOUBTFUL,
        where=claim.where,
        claim=claim.id,
        says=f"Your text can be read in {len(judgement.readings)} ways, and this is "
        f"{'; '.join(parts)}.",
        change="Say in the text which is meant: units, curve, knots and ends.",
    )


def _some(names: Sequence[str]) -> str:
    """The first reason, and how many more there are."""
    more = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
    return f"“{names[0]}”{more}"


def _left_open(study: Study) -> Iterator[Advice]:
    """What the case file lists as open: assumptions, and settings of algorithms."""
    for assumption in study.case.assumptions:
        yield Advice(
            urgency=Urgency.OPEN,
            where="the text",
            claim=None,
            says=f"Left open: {assumption.text}",
            change=f"Say which holds. Assumed here: {assumption.choice}",
        )
    for block in study.case.algorithms:
        for line in block.open:
            yield Advice(
                urgency=Urgency.OPEN,
                where=block.where or block.name,
                claim=None,
                says=f"Left open for {block.name}: {line}",
                change="Print it, so that others can run the algorithm again.",
            )
