"""What the paper states, in words and digits: the claims and the source of a case."""

from __future__ import annotations

from ...problem import Case
from ...problem.cases import (
    AnyClaim,
    Claim,
    ConditionsClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MotionValueClaim,
    PhasesClaim,
    TimeClaim,
    TotalTimeClaim,
)
from ..documents import StatedAnswer, StatedClaim, StatedSource, known, noted
from .sentences import sentence_of, with_units

_TIME = "time"
"""The objective of a claim that was minimised for time alone, in a file that says another one."""


def prints_durations(claim: Claim) -> bool:
    """Whether a claim prints durations, so that a motion can be built from it."""
    return isinstance(claim, DurationsClaim | MaximumClaim)


def stated_claims(case: Case) -> tuple[StatedClaim, ...]:
    """Every claim of a case: its words, place and digits."""
    return tuple(
        StatedClaim(
            claim=claim.id,
            quantity=claim.quantity,
            text=claim_text(case, claim),
            where=claim.where,
            printed=digits_of(case, claim),
            objective=known(
                other_objective(case, claim),
                "time alone" if isinstance(claim, TimeClaim) else "no printed time",
            ),
            answer=known(_answer(claim), "the authors were not asked"),
        )
        for claim in case.claims
    )


def stated_source(case: Case) -> StatedSource:
    """Where the numbers of a case were printed."""
    named = case.source.model_dump()
    typed = case.document.transcription
    unsaid = "not said in the case file"
    return StatedSource(
        **{**named, "year": known(named["year"], "not named in the case file")},
        transcribed_by=known(typed.by if typed else None, unsaid),
        checked_by=known((typed.checked_by or None) if typed else None, unsaid),
    )


def _answer(claim: AnyClaim) -> StatedAnswer | None:
    if claim.answer is None:
        return None
    return StatedAnswer(
        sent=claim.answer.sent,
        answered=known(claim.answer.answered, "no answer so far"),
        outcome=claim.answer.outcome,
    )


def other_objective(case: Case, claim: AnyClaim | TimeClaim) -> str | None:
    """What was minimised for a printed time; None if that is time alone, or nothing else is said.

    Parameters
    ----------
    case : Case
    claim : AnyClaim

    Returns
    -------
    str or None
    """
    if not isinstance(claim, TimeClaim):
        return None
    said = claim.objective or case.document.objective
    return None if said is None or said.strip().lower() == _TIME else said.strip().rstrip(".")


def claim_text(case: Case, claim: AnyClaim) -> str:
    """What a claim says: its own words, or one sentence from what it prints."""
    return claim.text or sentence_of(case, claim)


def digits_of(case: Case, claim: AnyClaim) -> str:
    """The digits that a claim prints, with the paper's unit; empty where it prints none."""
    units = case.document.units
    time = f" {units.time}" if units.time else ""
    if isinstance(claim, DurationsClaim | MaximumClaim):
        shown = ", ".join(map(str, claim.durations)) + time
        return shown + (f"; total {claim.total}{time}" if claim.total is not None else "")
    if isinstance(claim, TotalTimeClaim):
        return f"{claim.value}{time}"
    if isinstance(claim, PhasesClaim):
        return ", ".join(map(str, (*claim.phases, *(claim.ramps or ())))) + time
    if isinstance(claim, ImprovementClaim):
        parts = [f"{claim.percent} %"] if claim.percent is not None else []
        return "; ".join(parts + ([f"{claim.seconds}{time}"] if claim.seconds is not None else []))
    if isinstance(claim, MotionValueClaim):
        return ", ".join(with_units(case, claim))
    if isinstance(claim, ConvergenceClaim):
        return f"{claim.iterations} iterations"
    if isinstance(claim, ConditionsClaim) and claim.count is not None:
        return f"{claim.count} conditions"
    return ""


def in_words(case: Case, problem: str, reading: str) -> str:
    """A problem and a reading in words, each where the case has several; else the problem."""
    only = case.title if len(case.problems) == 1 else problem
    title = next((p.title for p in case.problems if p.id == problem), "") or only
    said = [title] if len(case.problems) > 1 or len(case.readings) < 2 else []
    return "; ".join([*said, *([case.labels[reading]] if len(case.readings) > 1 else [])])


def in_words_among(case: Case, problem: str, reading: str) -> str:
    """What `in_words` says; empty where there is one problem under one reading alone."""
    several = len(case.problems) > 1 or len(case.readings) > 1
    return in_words(case, problem, reading) if several else ""


def asked_as(case: Case, problem: str, reading: str) -> str:
    """A problem and a reading in words, with the ids by which a command asks for them if it can."""
    words = in_words(case, problem, reading)
    if len(case.problems) == len(case.readings) == 1:
        return words
    return noted(words, f"problem {problem}, reading {reading}")


def place(claim: Claim) -> str:
    """Where a claim stands, as short as it can be found: the first place that it names."""
    # A title names its field as often as it claims: what stands elsewhere too is found there.
    first = claim.where.split(";")[0].strip().removeprefix("title, ")
    for part in ("abstract", "title", "introduction", "conclusion"):
        if first.startswith(part):
            return f"the {part}"
    head = first.split(", above")[0].split(", below")[0].split(" and ")[0]
    return ", ".join(head.split(", ")[:2])
