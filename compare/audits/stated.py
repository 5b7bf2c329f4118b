"""What the paper states, in words and digits: the claims and the source of a case."""

from __future__ import annotations

import re

from ...problem import Case
from ...problem.cases import (
    AnyClaim,
    ConditionsClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    TotalTimeClaim,
)
from ..documents import StatedClaim, StatedSource, known

_KINDS = {"durations": "Segment durations", "maximum": "Longest segment durations"}
"""How claims without words of their own are called; others by their quantity."""


def stated_claims(case: Case) -> tuple[StatedClaim, ...]:
    """Every claim of a case: its words, place and digits."""
    return tuple(
        StatedClaim(
            claim=claim.id,
            quantity=claim.quantity,
            text=claim_text(claim),
            where=claim.where,
            printed=digits_of(case, claim),
        )
        for claim in case.claims
    )


def stated_source(case: Case) -> StatedSource:
    """Where the numbers of a case were printed."""
    named = case.source.model_dump()
    return StatedSource(**{**named, "year": known(named["year"], "not named in the case file")})


def claim_text(claim: AnyClaim) -> str:
    """What a claim says: its own words, or its kind, place and algorithm."""
    if claim.text:
        return claim.text
    said = _KINDS.get(claim.quantity, claim.quantity.replace("_", " ").capitalize())
    said += f" of joint {claim.joint}" if claim.joint else ""
    return said + (f", {claim.algorithm}" if claim.algorithm else "") + "."


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
    if isinstance(claim, PeakClaim):
        digits = ", ".join(map(str, claim.printed))
        return f"{digits} {getattr(units, claim.derivative) or ''}".strip()
    if isinstance(claim, ConvergenceClaim):
        return f"{claim.iterations} iterations"
    if isinstance(claim, ConditionsClaim) and claim.count is not None:
        return f"{claim.count} conditions"
    return ""


def spoken(case: Case, text: str) -> str:
    """A message in which claims are called by their places instead of their ids.

    An id that is a word of its own is replaced only where a problem stands behind it in brackets.
    """
    places = {claim.id: place(claim) for claim in case.claims}
    problems = "|".join(re.escape(p.id) for p in case.problems)
    for one, where in sorted(places.items(), key=lambda pair: -len(pair[0])):
        literal = where.replace("\\", "\\\\")
        known = rf"(?<![\w-]){re.escape(one)}"
        text = re.sub(rf"{known} \((?:{problems})\)", literal, text)
        if "-" in one:
            text = re.sub(rf"{known}(?![\w-])", literal, text)
    return text


def place(claim: AnyClaim) -> str:
    """Where a claim stands, as short as it can be found: the first place that it names."""
    first = claim.where.split(";")[0].strip()
    if first.startswith("abstract"):
        return "the abstract"
    head = first.split(", above")[0].split(", below")[0].split(" and ")[0]
    return ", ".join(head.split(", ")[:2])
