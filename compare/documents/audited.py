"""What `audit` answers: findings, verdicts, where the time goes, readings, instances."""

from __future__ import annotations

from typing import Annotated

from .advice import Advice
from .card import VerdictCard
from .cause import Cause
from .entry import Count, Document, Entry, Fact, OrWhy
from .finding import Finding, Judgement
from .instances import ExaminedInstances
from .provenance import Provenance
from .reached import Reached
from .side_by_side import ReadingsSummary
from .stated import StatedClaim, StatedSource
from .waterfall import Waterfall


class AuditedCase(Entry):
    """What was found of one case."""

    case: str
    title: str
    source: StatedSource
    card: VerdictCard
    errors: Count
    """How many causes have severity error."""
    causes: tuple[Cause, ...]
    """What speaks against something printed, each once; the gravest first."""
    advice: OrWhy[tuple[Advice, ...]]
    """With `--draft`: what its author can change before submitting, the gravest first."""
    claims: tuple[StatedClaim, ...]
    """What the paper states; the other keys name a claim by its id."""
    findings: tuple[Finding, ...]
    verdicts: tuple[Judgement, ...]
    """On every claim."""
    waterfalls: tuple[Waterfall, ...]
    """Where the time goes, for each problem and reading."""
    reached: tuple[Reached, ...]
    """How near each of the paper's algorithms gets, from committed runs at the paper's budget."""
    readings: OrWhy[ReadingsSummary]
    """The readings side by side."""
    left_out: Annotated[tuple[str, ...], Fact("not certified")]
    """What the time budget left uncertified."""
    not_replayed: Annotated[tuple[str, ...], Fact("not replayed")]
    """Algorithms that no implementation here replays, and why."""
    families: tuple[ExaminedInstances, ...]
    """Relative claims on instances drawn from the robot's workspace."""
    provenance: Provenance


class AuditDocument(Document):
    """What `trajgap audit --json` prints."""

    cases: tuple[AuditedCase, ...]
