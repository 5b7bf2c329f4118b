"""What the paper states, in words and digits: the claims and the source of a case."""

from __future__ import annotations

import re

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
    TimeClaim,
    TotalTimeClaim,
)
from ..documents import StatedAnswer, StatedClaim, StatedSource, known, noted
from .sentences import sentence_of, with_units

_TIME = "time"
"""The objective of a claim that was minimised for time alone, in a file that says another one."""
_TERMS = ("time-optimal", "point-to-point", "rest-to-rest", "b-spline")
"""Words of the field with a dash, which may be ids too and stay words in a message."""


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


def spoken(case: Case, text: str) -> str:
    """A message that calls things as a reader knows them: no id stands for a name.

    Claims are called by their places, algorithms by their names, problems by their titles. An id
    that is a word of its own, of the field or of the paper ("time-optimal"), is
    replaced only where a problem stands behind it in brackets.
    """
    texts = [claim.text for claim in case.claims]
    words = " ".join([*_TERMS, case.title, case.source.title, *texts])
    places = {claim.id: place(claim) for claim in case.claims}
    places |= {one.id: f"the {one.name}" for one in case.algorithms}
    problems = "|".join(re.escape(p.id) for p in case.problems)
    for one, where in sorted(places.items(), key=lambda pair: -len(pair[0])):
        literal = where.replace("\\", "\\\\")
        known = rf"(?<![\w-]){re.escape(one)}"
        text = re.sub(rf"{known} \((?:{problems})\)", literal, text)
        if "-" in one and one not in words:
            text = re.sub(rf"{known}(?![\w-])", literal, text)
    for problem in case.problems:
        # Where there is one problem, its name tells nothing.
        name = f" ({problem.title or problem.id})" if len(case.problems) > 1 else ""
        text = text.replace(f" ({problem.id})", name)
    return text[:1].upper() + text[1:]


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
    first = claim.where.split(";")[0].strip()
    # A title names its field as often as it claims: what stands elsewhere too is found there.
    first = re.sub(r"^title, ", "", first)
    for part in ("abstract", "title", "introduction", "conclusion"):
        if re.match(rf"{part}\b", first):
            return f"the {part}"
    head = first.split(", above")[0].split(", below")[0].split(" and ")[0]
    return ", ".join(head.split(", ")[:2])
