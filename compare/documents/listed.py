"""What `cases` answers: the published cases."""

from __future__ import annotations

from collections.abc import Iterable

from ...problem import Case
from .entry import Document, Entry


class ListedCase(Entry):
    """A published case."""

    id: str
    title: str
    problems: tuple[str, ...]
    """Ids."""
    readings: tuple[str, ...]
    """Ids."""
    claims: int
    """Their number."""


class CasesDocument(Document):
    """What `trajgap cases --json` prints."""

    cases: tuple[ListedCase, ...]


def cases_document(cases: Iterable[Case]) -> CasesDocument:
    """Document of `cases`: what is shipped."""
    return CasesDocument(
        cases=tuple(
            ListedCase(
                id=case.id,
                title=case.title,
                problems=tuple(p.id for p in case.problems),
                readings=tuple(r.id for r in case.readings),
                claims=len(case.claims),
            )
            for case in cases
        )
    )
