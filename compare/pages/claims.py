"""Claims on a report page with verdict and why, their causes, and what to change in a draft."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby

from ...nlp import Evidence
from ...problem import file_name
from ...problem.cases import AnyClaim
from ..audits import CaseAudit, claim_text, digits_of, place, plainly
from ..documents import (
    Cause,
    Caveat,
    CaveatKind,
    ClaimVerdict,
    Confidence,
    Judgement,
    Named,
    Said,
    Scope,
    Severity,
    Urgency,
    capital,
    grouped,
    opened,
    qualified,
    same_reason,
    under,
    with_readings,
    worth_little,
)
from .blocks import Behind, Block, Cell, Claimed, Folded, Grid, Prose, Section, slug, text, word

_AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that stand in the open, the gravest first."""
_OPEN_WORDS = 30
"""Words of a reason that stand in the open; what goes beyond is a fold away."""


_KNOWN = {
    Confidence.DIGITS: "follows from the printed digits",
    Confidence.PROVEN: "proven",
    Confidence.COMPUTED: "computed",
    Confidence.BEST_KNOWN: "against the best known motion",
    Confidence.UNCONVERGED: "against a search that did not converge",
    Confidence.REPLAY: "by replays",
}
"""How a verdict is known, beside its claim."""


def against(one: CaseAudit) -> Section:
    """Claims that are refuted, contradicted or depend on the reading, and what lies behind."""
    found = [
        claimed(one, j) for verdict in _AGAINST for j in one.judgements if j.verdict is verdict
    ]
    blocks: list[Block] = [*shown_once(found)]
    causes = [c for c in one.causes if not _covered(one, c)]
    if causes:
        blocks += [Prose("The causes", "heading"), *(_behind(one, c) for c in causes)]
    if not found:
        title = "Evidence against printed statements"
    else:
        title = "Claims refuted, contradicted or dependent on the reading"
    return Section("against", title, tuple(blocks))


def folded_claims(one: CaseAudit) -> Iterator[Section]:
    """Supported claims, then those that cannot be checked, each behind a fold."""
    for verdict in (ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE):
        own = [j for j in one.judgements if j.verdict is verdict]
        beside = worth_little(own)
        title = f"{len(own)} claim{'' if len(own) == 1 else 's'} {verdict}"
        title += f": {beside}" if beside else ""
        found = tuple(shown_once([claimed(one, j) for j in own]))
        yield Section(f"claims-{slug(verdict)}", title, found, folded=True)


def claimed(one: CaseAudit, judgement: Judgement) -> Claimed:
    """One claim with its verdict and why."""
    claim = one.case.claim(judgement.claim)
    why, more = _opened(_why(one, judgement))
    return Claimed(
        text=claim_text(one.case, claim),
        where=claim.where,
        printed=digits_of(one.case, claim),
        verdict=replace(
            word(judgement.verdict), text=qualified(judgement.verdict, judgement.beside)
        ),
        holds=_holds(judgement, names(one)),
        why=why,
        more=(*more, *(str(_sentence(c)) for c in judgement.caveats if c.kind in _POINTS)),
        caveats=tuple(_caveats(judgement)),
        anchor=file_name("claim", claim.id),
        id=claim.id,
        answer=answered(claim),
    )


_POINTS = (CaveatKind.POINTS, CaveatKind.SOME_POINTS)
"""Doubted way-points: in full behind a fold."""


def _caveats(judgement: Judgement) -> Iterator[Caveat]:
    """Remarks on a verdict, without doubtful way-points if the verdict names them already."""
    for caveat in judgement.caveats:
        if caveat.kind not in _POINTS:
            yield _sentence(caveat)
        elif caveat.kind is CaveatKind.SOME_POINTS:
            yield _sentence(replace(caveat, why=""))


def _sentence(caveat: Caveat) -> Caveat:
    """A caveat that begins and ends as a sentence does."""
    if caveat.why:
        return Caveat(caveat.kind, capital(caveat.says), f"{caveat.why.rstrip('.')}.")
    return Caveat(caveat.kind, f"{capital(caveat.says)}.")


def answered(claim: AnyClaim) -> str:
    """What the authors say of a claim, or that they were asked; empty if they were not."""
    if claim.answer is None:
        return ""
    answer = claim.answer
    came = f"answered {answer.answered}" if answer.answered else "no answer so far"
    said = f"Authors asked {answer.sent}, {came}"
    return f"{said}: {answer.outcome}" if answer.outcome else f"{said}."


def _opened(
    reasons: Sequence[tuple[tuple[str, ...], str]],
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Sentences of the first reason that stand in the open, and the rest; each with its rule."""
    if not reasons:
        return (), ()
    (first, rule), *others = reasons
    shown, rest = opened(first, _OPEN_WORDS)
    if not rest:
        shown = (*shown, rule)
    else:
        rest = (*rest, rule)
    after = [" ".join(filter(None, (*one, behind))) for one, behind in others]
    return (" ".join(filter(None, shown)),), tuple(filter(None, (" ".join(rest).strip(), *after)))


def _holds(judgement: Judgement, named: Named) -> str:
    """Under which readings the word holds, and which reference it rests on."""
    parts = []
    every = tuple(judgement.readings)
    count = len(every)
    known = _KNOWN[judgement.confidence] if isinstance(judgement.confidence, Confidence) else ""
    if judgement.scope is Scope.SOME or judgement.verdict is ClaimVerdict.DEPENDS:
        found: dict[ClaimVerdict, list[str]] = {}
        for reading, verdict in judgement.readings.items():
            found.setdefault(verdict, []).append(reading)
        each = [f"{verdict} {under(which, every, named)}" for verdict, which in found.items()]
        parts.append(", ".join(each))
    elif judgement.scope is Scope.ALL and count > 1:
        all_ = "under both readings" if count == 2 else f"under all {count} readings"
        proven = judgement.confidence is Confidence.PROVEN
        parts.append(f"{known} {all_}" if proven else all_)
        known = "" if proven else known
    if judgement.evidence is not Evidence.NONE:
        parts.append(f"reference: {judgement.evidence}")
    parts += [known] if known else []
    return "; ".join(parts)


def names(one: CaseAudit) -> Named:
    """What the readings of a case are called."""
    far = one.readings.implausible if one.readings is not None else {}
    return Named(one.case.labels, far, one.study.main_reading)


def _why(one: CaseAudit, judgement: Judgement) -> list[tuple[tuple[str, ...], str]]:
    """The sentences of what decides, each reason once, and the rule that says it in brackets."""
    said = [
        Said(f.verdict, f.rule, f.kind, f.sentences, f.reading)
        for f in one.findings
        if f.claim == judgement.claim and f.decides
    ]
    every, depends = tuple(judgement.readings), judgement.verdict is ClaimVerdict.DEPENDS
    found = grouped(said, every, names(one))
    return [
        (with_readings(reason, every, names(one), word=depends), f"({reason.rule})")
        for reason in found
    ] or [(judgement.sentences, "")]


# --- causes ---------------------------------------------------------------------------------------


def _covered(one: CaseAudit, cause: Cause) -> bool:
    """Whether a claim above says all of a warning: nothing rests on it, nothing explains it."""
    if cause.severity is Severity.ERROR or cause.explanations or cause.consequences:
        return False
    return any(j.claim == cause.claim and j.verdict in _AGAINST for j in one.judgements)


def _behind(one: CaseAudit, cause: Cause) -> Behind:
    says, _ = opened(plainly(one.case, cause, names(one).implausible), _OPEN_WORDS)
    # The one reading of a cause stands in front of it already.
    known = len(cause.readings) == 1
    hit = dict.fromkeys(c.claim for c in cause.consequences if c.claim and c.claim != cause.claim)
    return Behind(
        weight=word(cause.severity),
        says=" ".join(says),
        explanations=tuple(
            f"{' Or: '.join(e.change for e in alike)} {effect}"
            for effect, alike in groupby(
                cause.explanations, lambda e: (known and e.in_any) or e.effect
            )
        ),
        follows=tuple(_to(one, claim) for claim in hit),
    )


def _to(one: CaseAudit, claim_id: str) -> Cell:
    claim = one.case.claim(claim_id)
    said = f"{claim_text(one.case, claim)} ({place(claim)})"
    return Cell(said, target=file_name("claim", claim.id))


def shown_once(found: Sequence[Claimed]) -> Iterator[Claimed]:
    """Claims in order, without what an earlier one has said.

    Returns
    -------
    iterator of Claimed
        Claims of the same words and the same verdict are one with several places. A reason that an
        earlier claim gave is named, and a long caveat is given in full once.
    """
    groups: dict[tuple[str, ...], list[Claimed]] = {}
    for one in found:
        groups.setdefault((one.text, one.verdict.text, one.holds), []).append(one)
    first: dict[tuple[str, ...], Claimed] = {}
    seen: set[Caveat] = set()
    for group in groups.values():
        one = _joined(group)
        before = first.setdefault((*one.why, *one.more), one)
        if before is not one:
            one = replace(one, why=(same_reason(before.text, before.where, one.where),), more=())
        caveats = tuple(
            Caveat(c.kind, f"{c.says} (see above).") if c in seen else c for c in one.caveats
        )
        seen.update(caveat for caveat in one.caveats if caveat.why)
        yield replace(one, caveats=caveats)


def _joined(group: Sequence[Claimed]) -> Claimed:
    """Claims of the same words as one, with the reasons of the others a fold away."""
    one, *others = group
    if not others:
        return one
    more = [
        f"{other.where}: {' '.join((*other.why, *other.more))}"
        for other in others
        if (other.why, other.more) != (one.why, one.more)
    ]
    return replace(
        one,
        where="; ".join(dict.fromkeys(c.where for c in group)),
        printed="; ".join(dict.fromkeys(c.printed for c in group if c.printed)),
        more=(*one.more, *more),
        caveats=tuple(dict.fromkeys(caveat for c in group for caveat in c.caveats)),
        answer=" ".join(dict.fromkeys(c.answer for c in group if c.answer)),
        also=tuple(c.anchor for c in others),
    )


def advised(one: CaseAudit) -> Section:
    """What contradicts itself or is doubtful stands open, what is left open behind a fold."""
    pressing = [a for a in one.advice if a.urgency is not Urgency.OPEN]
    opened = [a for a in one.advice if a.urgency is Urgency.OPEN]
    columns = ("", "where", "what was found", "what to change")
    grids = [
        Grid(
            columns,
            tuple((word(a.urgency), text(a.where), text(a.says), text(a.change)) for a in some),
            prose=True,
        )
        for some in (pressing, opened)
        if some
    ]
    blocks: list[Block] = list(grids[:1] if pressing else [])
    if opened:
        blocks.append(Folded(f"{len(opened)} points that readers cannot check", (grids[-1],)))
    return Section("before-you-submit", "Before you submit", tuple(blocks))
