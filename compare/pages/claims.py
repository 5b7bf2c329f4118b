"""Claims on a report page: words, place, digits, verdict, why; and the causes behind them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...nlp import Evidence
from ...problem import file_name
from ..audits import CaseAudit, claim_text, digits_of, named, place, plainly, spoken
from ..documents import Cause, ClaimVerdict, Finding, Judgement, Scope
from .blocks import Behind, Block, Cell, Claimed, Prose, Section, slug, word

_AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that stand in the open, the gravest first."""
_DECIDED = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
"""Verdicts of findings that say something of a claim, those against it first."""
_OPEN_WORDS = 45
"""Words of a reason that stand in the open; what goes beyond is a fold away."""


def against(one: CaseAudit) -> Section:
    """Claims that are refuted, contradicted or depend on the reading, and what lies behind."""
    found = [
        claimed(one, j) for verdict in _AGAINST for j in one.judgements if j.verdict is verdict
    ]
    blocks: list[Block] = [*_alike(found)]
    if one.causes:
        blocks += [Prose("What lies behind", "heading"), *(_behind(one, c) for c in one.causes)]
    if not found:
        title = "What speaks against something printed"
    else:
        title = "Claims refuted, contradicted or open to the reading"
    return Section("against", title, tuple(blocks))


def folded_claims(one: CaseAudit) -> Iterator[Section]:
    """Supported claims, then those that cannot be checked, each behind a fold."""
    for verdict in (ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE):
        found = tuple(claimed(one, j) for j in one.judgements if j.verdict is verdict)
        count = f"{len(found)} claim{'' if len(found) == 1 else 's'} {verdict}"
        yield Section(f"claims-{slug(verdict)}", count, found, folded=True)


def _alike(found: Sequence[Claimed]) -> Iterator[Claimed]:
    """Claims in order; a reason that an earlier one gave is named, not said again."""
    first: dict[tuple[str, ...], Claimed] = {}
    for one in found:
        before = first.setdefault((*one.why, *one.more), one)
        if before is one:
            yield one
        else:
            yield Claimed(
                text=one.text,
                where=one.where,
                printed=one.printed,
                verdict=one.verdict,
                holds=one.holds,
                why=(f"For the same reason as {before.where}.",),
                more=(),
                caveats=one.caveats if one.caveats != before.caveats else (),
                anchor=one.anchor,
                id=one.id,
            )


def claimed(one: CaseAudit, judgement: Judgement) -> Claimed:
    """One claim with its verdict and why."""
    claim = one.case.claim(judgement.claim)
    reasons = [spoken(one.case, reason) for reason in _why(one, judgement)]
    why, more = _opened(reasons)
    return Claimed(
        text=claim_text(claim),
        where=claim.where,
        printed=digits_of(one.case, claim),
        verdict=word(judgement.verdict),
        holds=_holds(judgement),
        why=why,
        more=more,
        caveats=tuple(f"But: {spoken(one.case, caveat)}" for caveat in judgement.caveats),
        anchor=file_name("claim", claim.id),
        id=claim.id,
    )


def _opened(reasons: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Whole sentences up to `_OPEN_WORDS` words, at least one; and all reasons if that cuts."""
    shown: list[str] = []
    room = _OPEN_WORDS
    for reason in reasons[:1]:
        for sentence in _sentences(reason):
            count = len(sentence.split())
            if shown and count > room:
                break
            shown.append(sentence)
            room -= count
    opened = " ".join(shown)
    if list(reasons) == [opened]:
        return (opened,), ()
    return ((opened,) if opened else ()), tuple(reasons)


def _sentences(text: str) -> list[str]:
    parts = text.split(". ")
    return [*(f"{part}." for part in parts[:-1]), parts[-1]]


def _holds(judgement: Judgement) -> str:
    """Under which readings the word holds, and which reference it rests on."""
    parts = []
    count = len(judgement.readings)
    if judgement.scope is Scope.SOME or judgement.verdict is ClaimVerdict.DEPENDS:
        under: dict[ClaimVerdict, list[str]] = {}
        for reading, verdict in judgement.readings.items():
            under.setdefault(verdict, []).append(reading)
        each = [f"{verdict} under {_which(names)}" for verdict, names in under.items()]
        parts.append(f"of {count} readings: {', '.join(each)}" if count > 1 else each[0])
    elif judgement.scope is Scope.ALL and count > 1:
        parts.append(f"under all {count} readings")
    if judgement.evidence is not Evidence.NONE:
        parts.append(f"reference: {judgement.evidence}")
    return "; ".join(parts)


def _which(readings: Sequence[str]) -> str:
    return readings[0] if len(readings) == 1 else str(len(readings))


def _why(one: CaseAudit, judgement: Judgement) -> Iterator[str]:
    """What decides: findings that say the same in other numbers share a line."""
    lines: dict[tuple[str, ...], list[Finding]] = {}
    for f in one.findings:
        if f.claim == judgement.claim and f.decides and f.verdict in _DECIDED:
            lines.setdefault((f.rule, f.verdict, f.kind), []).append(f)
    if not lines:
        yield judgement.why
    for (rule, *_), own in sorted(
        lines.items(), key=lambda line: _DECIDED.index(line[1][0].verdict)
    ):
        messages = list(dict.fromkeys(f.message for f in own))
        readings = list(dict.fromkeys(f.reading for f in own if f.reading))
        every = not readings or len(readings) == len(one.study.readings)
        where = "" if every and len(messages) == 1 else f", {named(readings)}"
        others = len(messages) - 1
        more = f" In other numbers: {others} more finding{'s' * (others > 1)}." if others else ""
        yield f"{messages[0]} ({rule}{where}){more}"


# --- causes ---------------------------------------------------------------------------------------


def _behind(one: CaseAudit, cause: Cause) -> Behind:
    if cause.claim is None:
        says = spoken(one.case, cause.says)
    else:
        says = plainly(one.case, cause, one.findings)
    if len(cause.readings) and len(cause.readings) < len(one.study.readings):
        says += f" (Under {len(cause.readings)} of {len(one.study.readings)} readings.)"
    says, *_ = _opened([says])[0] or (says,)
    hit = dict.fromkeys(c.claim for c in cause.consequences if c.claim and c.claim != cause.claim)
    return Behind(
        weight=word(cause.severity),
        says=says,
        explanations=tuple(f"{e.change} {e.effect}" for e in cause.explanations),
        follows=tuple(_to(one, claim) for claim in hit),
    )


def _to(one: CaseAudit, claim_id: str) -> Cell:
    claim = one.case.claim(claim_id)
    return Cell(place(claim), target=file_name("claim", claim.id))
