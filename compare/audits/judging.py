"""Verdicts: the findings about a claim combined, and their severity made to fit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ...nlp import Evidence
from ...problem import Case
from ...problem.cases import ImprovementClaim, TotalTimeClaim
from ..documents import (
    DECIDING,
    NAMELESS,
    UNDECIDED,
    ClaimVerdict,
    Confidence,
    Finding,
    Judgement,
    Named,
    Said,
    Scope,
    Severity,
    Why,
    grouped,
    with_readings,
)
from .roots import AGAINST

_RANK = (Evidence.NONE, Evidence.CERTIFIED, Evidence.BEST_KNOWN, Evidence.UNCONVERGED)
"""The weakest reference last: a verdict rests on the weakest of what stands behind it."""


def judge(
    claim: str,
    findings: Iterable[Finding],
    admissible: Sequence[str],
    computed: Sequence[str] | None = None,
    named: Named = NAMELESS,
) -> Judgement:
    """Combine the deciding findings about one claim into its verdict.

    Under each reading a claim is refuted if a deciding finding refutes it, else inconsistent if
    one contradicts it, else supported if one supports it, else not checkable. The claim has that
    word if every reading gives the same one; else it depends on the reading.

    Parameters
    ----------
    computed : sequence of str, optional
        The readings that were computed, of which the verdict speaks; all by default.
    named : Named, optional
        What the readings are called; by their ids if left out.
    """
    about = [f for f in findings if f.claim == claim]
    own = [f for f in about if f.decides]
    each: dict[str, ClaimVerdict] = {}
    for reading in computed or admissible:
        there = {f.verdict for f in own if f.reading in (None, reading)}
        each[reading] = next((v for v in DECIDING if v in there), ClaimVerdict.NOT_CHECKABLE)
    words = list(dict.fromkeys(each.values()))
    verdict = words[0] if len(words) == 1 else ClaimVerdict.DEPENDS
    if verdict is ClaimVerdict.NOT_CHECKABLE:
        informs = not own and bool(about)
        sentences = next(
            (f.sentences if f.decides else _informing(f) for f in (*own, *about)),
            ("no rule applies to this claim",),
        )
        scope, evidence = Scope.NO, Evidence.NONE
        confidence: Confidence | Why = UNDECIDED
    else:
        informs = False
        partial = len(words) > 1 or len(each) < len(admissible)
        scope = Scope.SOME if partial else Scope.ALL
        behind = [f for f in own if f.verdict in words and f.verdict in DECIDING]
        evidence = max((f.evidence for f in behind), key=_RANK.index, default=Evidence.NONE)
        said = (Said(f.verdict, f.rule, f.kind, f.sentences, f.reading) for f in behind)
        depends = verdict is ClaimVerdict.DEPENDS
        sentences = tuple(
            sentence
            for one in grouped(said, tuple(each), named)
            for sentence in with_readings(one, tuple(each), named, word=depends, why=True)
        )
        # One finding contradicts a claim, so the strongest counts; support, and what depends on
        # the reading, rests on all of them.
        ways = [f.confidence for f in behind if isinstance(f.confidence, Confidence)]
        strongest = min if verdict in AGAINST else max
        confidence = strongest(ways, key=list(Confidence).index, default=UNDECIDED)
    return Judgement(
        claim=claim,
        verdict=verdict,
        scope=scope,
        evidence=evidence,
        confidence=confidence,
        sentences=sentences,
        readings=each,
        informs=informs,
    )


def _informing(finding: Finding) -> tuple[str, ...]:
    """What a finding says that decides nothing, marked as such."""
    *most, last = finding.sentences
    return *most, f"{last} ({finding.rule}, informational)"


def rested(case: Case, judgements: Iterable[Judgement]) -> tuple[Judgement, ...]:
    """Judgements in which no improvement is supported by a total that is refuted.

    A percentage follows from two printed totals; where one of them is refuted, so many per cent are
    those of no motion, and whether the true ones are as many cannot be said.

    Their order stays.
    """
    given = list(judgements)
    refuted = {one.claim for one in given if one.verdict is ClaimVerdict.REFUTED}

    def fallen(claim: str) -> bool:
        one = case.claim(claim)
        return claim in refuted or (isinstance(one, TotalTimeClaim) and one.of in refuted)

    found = []
    for one in given:
        claim = case.claim(one.claim)
        if isinstance(claim, ImprovementClaim) and one.verdict is ClaimVerdict.SUPPORTED:
            lost = [case.claim(i).where for i in (claim.slower, claim.faster) if fallen(i)]
            if lost:
                one = _open(one, " and ".join(dict.fromkeys(lost)))
        found.append(one)
    return tuple(found)


def _open(judgement: Judgement, where: str) -> Judgement:
    """A judgement taken back, for what it rests on is refuted at some place."""
    return Judgement(
        claim=judgement.claim,
        verdict=ClaimVerdict.NOT_CHECKABLE,
        scope=Scope.NO,
        evidence=Evidence.NONE,
        confidence=UNDECIDED,
        sentences=(f"It rests on what {where} prints, which is refuted.", *judgement.sentences),
        readings=dict.fromkeys(judgement.readings, ClaimVerdict.NOT_CHECKABLE),
    )


def weigh(
    findings: Iterable[Finding], judgements: Iterable[Judgement], admissible: Sequence[str]
) -> tuple[Finding, ...]:
    """Findings whose severity fits the verdict on their claim.

    What a proof says under one reading is an error only where every admissible reading is against
    the claim; otherwise it is a warning, for the reading may not be the one meant.

    Their order stays.
    """
    refuted = {
        j.claim
        for j in judgements
        if set(j.readings) == set(admissible) and all(v in AGAINST for v in j.readings.values())
    }
    return tuple(
        f.model_copy(update={"severity": Severity.WARNING})
        if f.severity is Severity.ERROR and f.reading is not None and f.claim not in refuted
        else f
        for f in findings
    )
