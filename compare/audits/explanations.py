"""Innocent explanations of what does not fit in print, each tried by computing."""

from __future__ import annotations

from collections.abc import Iterator

from ...problem import counts_in_words
from ...problem.cases import ConditionsClaim, DurationsClaim, MaximumClaim
from ..documents import Explanation, Finding, HeldOtherwise, quoted
from .chosen_case import Pair
from .roots import LIMITS, TABLES
from .row import Row
from .rules import count_conditions, held_otherwise
from .slips_tried import explained_by_slips
from .stated import place
from .study import Study


def explained(study: Study, root: str, finding: Finding) -> tuple[Explanation, ...]:
    """Changes in print that the numbers allow and that would settle a finding.

    Parameters
    ----------
    study : Study
    root : str
        Of the cause.
    finding : Finding
        The first finding of the cause.

    Returns
    -------
    tuple of Explanation
        Those that explain most with the fewest slips first; several that tie, and one of
        each other kind.
    """
    kind = root.split(" ")[0]
    if kind == TABLES:
        return (
            Explanation(
                change="One table may have been printed twice by mistake.",
                effect="Then the numbers of one of them are not in print, both statements can be "
                "true, and nothing that rests on the missing numbers can be checked.",
            ),
        )
    claim = study.case.claim(finding.claim) if finding.claim else None
    if isinstance(claim, ConditionsClaim) and finding.rule == "TG107":
        return tuple(_at_the_ends(study, claim))
    if claim is None:
        return ()
    under, default = "", False
    if finding.reading is not None and len(study.readings) > 1:
        under = f", under {quoted(finding.reading, study.case.labels)}"
        default = finding.reading == study.case.default_reading.id
    found: list[Explanation] = []
    if kind == LIMITS and isinstance(claim, DurationsClaim | MaximumClaim):
        found += _at_samples(study, claim, finding, under)
    return (*found, *explained_by_slips(study, finding, claim, under, default))


def _at_samples(
    study: Study, claim: DurationsClaim | MaximumClaim, finding: Finding, under: str
) -> Iterator[Explanation]:
    """Limits that were held at some times only."""
    pair = Pair(str(finding.problem), str(finding.reading))
    held = held_otherwise(Row(study, claim, pair))
    effect = "Then they are broken between the samples, and the samples do not show it"
    if isinstance(held, HeldOtherwise) and held.sampled <= 1.0 < held.everywhere:
        yield Explanation(
            change="The limits may have been held at sampled times only: at ten steps a segment "
            "none is broken.",
            effect=f"{effect}{under}.",
            in_any=f"{effect}.",
        )


def _at_the_ends(study: Study, claim: ConditionsClaim) -> Iterator[Explanation]:
    """Rest that is said of all way-points and may be meant of the ends."""
    available = sum(degree + 1 for degree in claim.degrees)
    meant = count_conditions(study, claim.model_copy(update={"rest_at": "ends"}))
    if claim.rest_at != "all" or claim.count is not None or meant != available:
        return
    agreeing = [
        place(other)
        for other in study.case.claims
        if isinstance(other, ConditionsClaim) and other.count and other.count.fraction == meant
    ]
    counted = f", as {agreeing[0]} counts them" if agreeing else ""
    where = place(claim)
    yield Explanation(
        change=f"{where[:1].upper()}{where[1:]} may mean rest at the two ends only.",
        effect=f"Then there are {counts_in_words(meant, available)}{counted}.",
    )
