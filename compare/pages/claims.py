"""Claims on a report page: words, place, digits, verdict, why; and the causes behind them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ...nlp import Evidence
from ...problem import file_name
from ...problem.cases import AnyClaim
from ..audits import CaseAudit, claim_text, digits_of, named, place, plainly, spoken
from ..documents import Cause, ClaimVerdict, Confidence, Finding, Judgement, Scope, Severity
from .blocks import Behind, Block, Cell, Claimed, Prose, Section, slug, word

_AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that stand in the open, the gravest first."""
_DECIDED = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
"""Verdicts of findings that say something of a claim, those against it first."""
_OPEN_WORDS = 30
"""Words of a reason that stand in the open; what goes beyond is a fold away."""


_KNOWN = {
    Confidence.DIGITS: "follows from the printed digits",
    Confidence.PROVEN: "proven",
    Confidence.BEST_KNOWN: "against the best known motion",
    Confidence.REPLAY: "by replays",
}
"""How a verdict is known, beside its claim."""


_CITED = re.compile(r"\(TG[^()]*\)")
"""The rules and readings that stand behind a reason."""


def against(one: CaseAudit) -> Section:
    """Claims that are refuted, contradicted or depend on the reading, and what lies behind."""
    found = [
        claimed(one, j) for verdict in _AGAINST for j in one.judgements if j.verdict is verdict
    ]
    blocks: list[Block] = [*_alike(found)]
    causes = [c for c in one.causes if not _told(one, c)]
    if causes:
        blocks += [Prose("The causes", "heading"), *(_behind(one, c) for c in causes)]
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
                answer=one.answer,
            )


def claimed(one: CaseAudit, judgement: Judgement) -> Claimed:
    """One claim with its verdict and why."""
    claim = one.case.claim(judgement.claim)
    # The place of the claim stands above its reasons.
    told = (reason.removeprefix(f"{claim.where}: ") for reason in _why(one, judgement))
    reasons = [spoken(one.case, reason) for reason in told]
    why, more = _opened(reasons)
    return Claimed(
        text=claim_text(one.case, claim),
        where=claim.where,
        printed=digits_of(one.case, claim),
        verdict=word(judgement.verdict),
        holds=_holds(judgement),
        why=why,
        more=more,
        caveats=tuple(
            f"{spoken(one.case, caveat.text).rstrip('.')}." for caveat in judgement.caveats
        ),
        anchor=file_name("claim", claim.id),
        id=claim.id,
        answer=answered(claim),
    )


def answered(claim: AnyClaim) -> str:
    """What the authors say of a claim, or that they were asked; empty where they were not."""
    if claim.answer is None:
        return ""
    answer = claim.answer
    came = f"answered {answer.answered}" if answer.answered else "no answer so far"
    said = f"Authors asked {answer.sent}, {came}"
    return f"{said}: {answer.outcome}" if answer.outcome else f"{said}."


def _opened(reasons: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Whole sentences of the first reason up to `_OPEN_WORDS` words, at least one; and the rest."""
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
    if reasons and _CITED.fullmatch(reasons[0].removeprefix(opened).strip()):
        # What is left over names the rules alone: it stays with its sentence.
        opened = reasons[0]
    rest = [reason.removeprefix(opened).strip() for reason in reasons[:1]] + list(reasons[1:])
    return ((opened,) if opened else ()), tuple(reason for reason in rest if reason)


def _sentences(text: str) -> list[str]:
    parts = text.split(". ")
    return [*(f"{part}." for part in parts[:-1]), parts[-1]]


def _holds(judgement: Judgement) -> str:
    """Under which readings the word holds, and which reference it rests on."""
    parts = []
    count = len(judgement.readings)
    known = _KNOWN[judgement.confidence] if isinstance(judgement.confidence, Confidence) else ""
    if judgement.scope is Scope.SOME or judgement.verdict is ClaimVerdict.DEPENDS:
        under: dict[ClaimVerdict, list[str]] = {}
        for reading, verdict in judgement.readings.items():
            under.setdefault(verdict, []).append(reading)
        each = [f"{verdict} under {_which(names)}" for verdict, names in under.items()]
        parts.append(f"of {count} readings: {', '.join(each)}" if count > 1 else each[0])
    elif judgement.scope is Scope.ALL and count > 1:
        every = "under both readings" if count == 2 else f"under all {count} readings"
        proven = judgement.confidence is Confidence.PROVEN
        parts.append(f"{known} {every}" if proven else every)
        known = "" if proven else known
    if judgement.evidence is not Evidence.NONE:
        parts.append(f"reference: {judgement.evidence}")
    parts += [known] if known else []
    return "; ".join(parts)


def _which(readings: Sequence[str]) -> str:
    return readings[0] if len(readings) == 1 else str(len(readings))


def _why(one: CaseAudit, judgement: Judgement) -> Iterator[str]:
    """What decides: each message once, with the rules and the readings that say it."""
    said: dict[str, list[Finding]] = {}
    for f in one.findings:
        if f.claim == judgement.claim and f.decides and f.verdict in _DECIDED:
            said.setdefault(f.message, []).append(f)
    if not said:
        yield judgement.why
    for message, own in sorted(said.items(), key=lambda line: _DECIDED.index(line[1][0].verdict)):
        rules = ", ".join(dict.fromkeys(f.rule for f in own))
        readings = list(dict.fromkeys(f.reading for f in own if f.reading))
        every = not readings or len(readings) == len(one.study.readings)
        yield f"{message} ({rules}{'' if every else f'; {named(readings)}'})"


# --- causes ---------------------------------------------------------------------------------------


def _told(one: CaseAudit, cause: Cause) -> bool:
    """Whether a claim above says all of a warning: nothing rests on it, nothing explains it."""
    if cause.severity is Severity.ERROR or cause.explanations or cause.consequences:
        return False
    return any(j.claim == cause.claim and j.verdict in _AGAINST for j in one.judgements)


def _behind(one: CaseAudit, cause: Cause) -> Behind:
    says = spoken(one.case, cause.says) if cause.claim is None else plainly(one.case, cause)
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
    said = f"{claim_text(one.case, claim)} ({place(claim)})"
    return Cell(said, target=file_name("claim", claim.id))
