"""What `verify` answers: what each certificate is worth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict

from ...verify import CertificateVerdict, CertifiedQuestion, Subject
from .certified import outwards
from .entry import Document, Entry, OrWhy, Why
from .vocabulary import Worth

UNNAMED = "no case was named"
"""Why a certificate is compared with no case."""

JudgedFile = tuple[str, CertificateVerdict, CertifiedQuestion | str | None]
"""A file, its verdict, and the question of a case that it is about, or why there is none; None
where no case was named."""


class AskedQuestion(Entry):
    """Where a problem comes from."""

    case: str | None
    problem: str | None
    reading: str | None
    joint: str | None
    """Null for all joints together."""
    case_sha256: str | None
    """Of the case file."""


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
    question: AskedQuestion
    """As the file names it; nothing proves it."""
    problem_hash: str | None
    """SHA-256 of the problem in the file, computed anew."""
    in_case: OrWhy[AskedQuestion]
    """With `--case`: the question of the case that has exactly this problem."""


class VerifyDocument(Document):
    """What `trajgap verify --json` prints."""

    verified: tuple[VerifiedFile, ...]


def verify_document(verdicts: Iterable[JudgedFile]) -> VerifyDocument:
    """Document of `verify`: one verdict per file.

    Parameters
    ----------
    verdicts : iterable of JudgedFile

    Returns
    -------
    VerifyDocument
    """
    return VerifyDocument(verified=tuple(_verified(*one) for one in verdicts))


def worth(verdict: CertificateVerdict) -> Worth:
    """The words for a verdict."""
    if verdict.out_of_time:
        return Worth.OUT_OF_TIME
    if not verdict.proves:
        return Worth.REFUSED
    return Worth.ALTERED if verdict.altered else Worth.PROVES


def _verified(
    file: str, verdict: CertificateVerdict, about: CertifiedQuestion | str | None
) -> VerifiedFile:
    why = "none is claimed" if verdict.proves else str(worth(verdict))
    return VerifiedFile(
        file=file,
        worth=worth(verdict),
        reason=verdict.reason,
        subject=verdict.subject if verdict.proves else None,
        infeasible=verdict.infeasible,
        lower=outwards(verdict.lower, why, -1),
        upper=outwards(verdict.upper, why, 1),
        question=_asked(verdict.question),
        problem_hash=verdict.problem_hash,
        in_case=_asked(about) if isinstance(about, CertifiedQuestion) else Why(about or UNNAMED),
    )


def _asked(question: CertifiedQuestion) -> AskedQuestion:
    return AskedQuestion(**asdict(question))
