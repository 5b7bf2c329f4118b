"""What `case diff` answers: where two transcriptions of one paper differ."""

from __future__ import annotations

from collections.abc import Iterable

from ...problem.cases import Difference
from .entry import Document, Entry


class DifferingField(Entry):
    """One place at which two transcriptions differ."""

    field: str
    """Where, such as "claims.total.value"."""
    first: str
    """What stands there in the first file; digits in quotes are printed ones."""
    second: str
    """The same of the second file."""


class CaseDiffDocument(Document):
    """What `trajgap case diff --json` prints."""

    first: str
    """Name of the first file."""
    second: str
    """Name of the second file."""
    differences: tuple[DifferingField, ...]
    """Empty if the transcriptions agree."""


def diff_document(first: str, second: str, found: Iterable[Difference]) -> CaseDiffDocument:
    """Document of `case diff`: what was found between two files."""
    differing = (DifferingField(field=d.field, first=d.first, second=d.second) for d in found)
    return CaseDiffDocument(first=first, second=second, differences=tuple(differing))
