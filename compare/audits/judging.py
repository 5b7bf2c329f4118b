"""Verdicts: the findings about a claim combined, and their severity made to fit."""

from __future__ import annotations

from collections.abc import Iterable

from ...nlp import Evidence
from ..documents import ClaimVerdict, Finding, Judgement, Scope, Severity


def judge(claim: str, findings: Iterable[Finding], readings: Iterable[str]) -> Judgement:
    """Combine the deciding findings about one claim into its verdict.

    Under each reading a claim is refuted if a deciding finding refutes it, else inconsistent if
    one contradicts it, else supported if one supports it, else not checkable. A verdict that
    holds under some readings only says so; what no reading decides is not checkable.
    """
    about = [f for f in findings if f.claim == claim]
    own = [f for f in about if f.decides]
    order = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
    each: dict[str, ClaimVerdict] = {}
    for reading in readings:
        there = {f.verdict for f in own if f.reading in (None, reading)}
        found = next((v for v in order if v in there), ClaimVerdict.NOT_CHECKABLE)
        each[reading] = found
    per_reading = list(each.values())
    decided = [v for v in per_reading if v is not ClaimVerdict.NOT_CHECKABLE]
    if not decided:
        beside = [f"{f.rule}, which decides nothing: {f.message}" for f in about if not f.decides]
        why = next((f.message for f in own), next(iter(beside), "no rule applies to this claim"))
        nothing = ClaimVerdict.NOT_CHECKABLE
        return Judgement(
            claim=claim,
            verdict=nothing,
            scope=Scope.NO,
            evidence=Evidence.NONE,
            why=why,
            readings=each,
        )
    verdict = next(v for v in order if v in decided)
    if verdict is not ClaimVerdict.SUPPORTED and decided.count(verdict) < len(per_reading):
        supported = decided.count(ClaimVerdict.SUPPORTED)
        if supported:
            verdict = ClaimVerdict.SUPPORTED
    scope = Scope.ALL if per_reading.count(verdict) == len(per_reading) else Scope.SOME
    behind = [f for f in own if f.verdict is verdict]
    rank = [Evidence.NONE, Evidence.CERTIFIED, Evidence.BEST_KNOWN]
    evidence = max((f.evidence for f in behind), key=rank.index, default=Evidence.NONE)
    against = [f for f in own if f.verdict in order[:2] and f.verdict is not verdict]
    said = [f"{f.rule}: {f.message}" for f in behind]
    said += [f"But {f.verdict} under {f.reading or 'all'}, {f.rule}: {f.message}" for f in against]
    why = " ".join(dict.fromkeys(said))
    return Judgement(
        claim=claim, verdict=verdict, scope=scope, evidence=evidence, why=why, readings=each
    )


def weigh(findings: Iterable[Finding], judgements: Iterable[Judgement]) -> tuple[Finding, ...]:
    """Findings whose severity fits the verdict on their claim.

    What a proof says under one reading is an error only where the claim falls under every
    admissible reading; otherwise it is a warning, for the reading may not be the one meant.

    Parameters
    ----------
    findings : iterable of Finding
    judgements : iterable of Judgement
        Of the claims, over all admissible readings.

    Returns
    -------
    tuple of Finding
        In their order.
    """
    against = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)
    fallen = {
        j.claim for j in judgements if j.readings and all(v in against for v in j.readings.values())
    }
    return tuple(
        f.model_copy(update={"severity": Severity.WARNING})
        if f.severity is Severity.ERROR and f.reading is not None and f.claim not in fallen
        else f
        for f in findings
    )
