"""What an author can change before submitting, on the page of a draft."""

from __future__ import annotations

from ..audits import CaseAudit
from ..documents import Urgency
from .blocks import Block, Folded, Grid, Section, text, word


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
        blocks.append(Folded(f"{len(opened)} things that a reader cannot check", (grids[-1],)))
    return Section("before-you-submit", "Before you submit", tuple(blocks))
