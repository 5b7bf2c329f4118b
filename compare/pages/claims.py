"""Claims on a report page with verdict and why, their causes, and what to change in a draft."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from ...problem import file_name
from ..audits import CaseAudit, claim_text, place, plainly
from ..blocks import (
    Block,
    Cell,
    Folded,
    Prose,
    Section,
    claims_shown,
    names,
    slug,
    table,
    word,
)
from ..documents import Cause, ClaimVerdict, Severity, Urgency, opened, worth_little

_AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that stand in the open, the gravest first."""
_OPEN_WORDS = 30
"""Words of a reason that stand in the open; what goes beyond is a fold away."""


def against(one: CaseAudit) -> Section:
    """Claims that are refuted, contradicted or depend on the reading, and what lies behind."""
    chosen = [j for verdict in _AGAINST for j in one.judgements if j.verdict is verdict]
    blocks: list[Block] = [*claims_shown(one.document, chosen, words=_OPEN_WORDS)]
    causes = [c for c in one.causes if not _covered(one, c)]
    if causes:
        blocks += [Prose("The causes", "heading"), *(b for c in causes for b in _behind(one, c))]
    if not chosen:
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
        found = tuple(claims_shown(one.document, own, words=_OPEN_WORDS))
        yield Section(f"claims-{slug(verdict)}", title, found, folded=True)


# --- causes ---------------------------------------------------------------------------------------


def _covered(one: CaseAudit, cause: Cause) -> bool:
    """Whether a claim above says all of a warning: nothing rests on it, nothing explains it."""
    if cause.severity is Severity.ERROR or cause.explanations or cause.consequences:
        return False
    return any(j.claim == cause.claim and j.verdict in _AGAINST for j in one.judgements)


def _behind(one: CaseAudit, cause: Cause) -> Iterator[Block]:
    """One cause, what would explain it, and the claims that fall with it."""
    says, _ = opened(plainly(one.case, cause, names(one.document).implausible), _OPEN_WORDS)
    yield Prose(" ".join(says), word=cause.severity)
    # The one reading of a cause stands in front of it already.
    known = len(cause.readings) == 1
    alike = groupby(cause.explanations, lambda e: (known and e.in_any) or e.effect)
    changes = [f"{' Or: '.join(e.change for e in each)} {effect}" for effect, each in alike]
    shown = tuple(Prose(change, "beside") for change in changes)
    yield from shown[:1]
    if shown[1:]:
        yield Folded("Other changes that would explain it", shown[1:])
    hit = dict.fromkeys(c.claim for c in cause.consequences if c.claim and c.claim != cause.claim)
    if hit:
        claims = [one.case.claim(name) for name in hit]
        rows = [
            (Cell(claim_text(one.case, claim), target=file_name("claim", claim.id)), place(claim))
            for claim in claims
        ]
        title = f"{len(hit)} more claim{'' if len(hit) == 1 else 's'} affected"
        yield Folded(title, (table(("claim", "place"), rows),))


def advised(one: CaseAudit) -> Section:
    """What contradicts itself or is doubtful stands open, what is left open behind a fold."""
    columns = ("", "where", "what was found", "~what to change")
    pressing, left_open = (
        table(columns, [(word(a.urgency), a.where, a.says, a.change) for a in some])
        for some in (
            [a for a in one.advice if a.urgency is not Urgency.OPEN],
            [a for a in one.advice if a.urgency is Urgency.OPEN],
        )
    )
    blocks: list[Block] = [pressing] if pressing.rows else []
    if left_open.rows:
        title = f"{len(left_open.rows)} points that readers cannot check"
        blocks.append(Folded(title, (left_open,)))
    return Section("before-you-submit", "Before you submit", tuple(blocks))
