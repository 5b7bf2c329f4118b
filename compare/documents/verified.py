"""What `verify` answers: what each certificate is worth."""

from __future__ import annotations

from collections.abc import Iterable

from ...nlp import Subject, Verdict
from .certified import outwards
from .entry import Document, Entry, OrWhy
from .vocabulary import Worth


class VerifiedFile(Entry):
    """One file."""

    file: str
    worth: Worth
    reason: str
    subject: Subject | None
    """Null where the file is refused."""
    infeasible: bool
    lower: OrWhy[float]
    """s, rounded down."""
    upper: OrWhy[float]
    """s, rounded up."""


class VerifyDocument(Document):
    """What `trajgap verify --json` prints."""

    verified: tuple[VerifiedFile, ...]


def verify_document(verdicts: Iterable[tuple[str, Verdict]]) -> VerifyDocument:
    """Document of `verify`: one verdict per file.

    Parameters
    ----------
    verdicts : iterable of (str, Verdict)
        By file.

    Returns
    -------
    VerifyDocument
    """
    return VerifyDocument(verified=tuple(_verified(*one) for one in verdicts))


def worth(verdict: Verdict) -> Worth:
    """The words for a verdict."""
    if not verdict.proves:
        return Worth.REFUSED
    return Worth.ALTERED if verdict.altered else Worth.PROVES


def _verified(file: str, verdict: Verdict) -> VerifiedFile:
    why = "none is claimed" if verdict.proves else "refused"
    return VerifiedFile(
        file=file,
        worth=worth(verdict),
        reason=verdict.reason,
        subject=verdict.subject if verdict.proves else None,
        infeasible=verdict.infeasible,
        lower=outwards(verdict.lower, why, -1),
        upper=outwards(verdict.upper, why, 1),
    )
