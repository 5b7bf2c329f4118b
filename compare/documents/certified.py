"""What `solve --certify` and `verify` answer: intervals of optima, and proofs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from ...nlp import Certified, Outcome
from ...nlp.proofs import decimal
from ...verify import CertificateVerdict, CertifiedQuestion, Subject
from .entry import Count, Document, Entry, OrWhy, Why, known
from .vocabulary import Uncovered, Worth


class CertifiedResult(Entry):
    """What was proved of one problem under one reading."""

    case: str
    problem: str
    reading: str
    joint: str | None
    """The joint that was optimised by itself; null for all together."""
    subject: Subject
    """Curves that the interval covers."""
    outcome: Outcome | Uncovered
    outcome_why: str | None
    lower: OrWhy[float]
    """No feasible total is below it, s; rounded down."""
    upper: OrWhy[float]
    """Total of durations proved feasible, s; rounded up."""
    gap: OrWhy[float]
    """(upper - lower)/upper"""
    nodes: OrWhy[Count]
    """Boxes visited."""
    open_nodes: OrWhy[Count]
    """Boxes not yet proved."""
    seconds: OrWhy[float]
    lower_exact: str | None
    """Decimal or quotient."""
    upper_exact: str | None
    segment_durations: OrWhy[tuple[float, ...]]
    """Of `upper`, s."""
    certificate: str | None
    """File."""
    state: str | None
    """File to go on from."""


class CertifyDocument(Document):
    """What `trajgap solve --certify --json` prints."""

    intervals: tuple[CertifiedResult, ...]


def certify_result(
    case: str,
    problem: str,
    reading: str,
    joint: str | None,
    subject: Subject,
    found: Certified | str,
    certificate: str | None,
    state: str | None,
    why: str | None = None,
) -> CertifiedResult:
    """What was proved of one problem under one reading.

    `joint`: the joint that was optimised by itself; None for all together. `subject`: what the
    interval is to speak about. `found`: or why the problem is not covered. `certificate, state`:
    files that were written. `why`: why the outcome is what it is, where that needs to be said.
    """
    same: dict[str, Any] = {
        "case": case, "problem": problem, "reading": reading, "joint": joint, "subject": subject,
        "certificate": certificate, "state": state,
    }  # fmt: skip
    if isinstance(found, str):
        missing = ("lower", "upper", "gap", "nodes", "open_nodes", "seconds", "segment_durations")
        same |= dict.fromkeys(missing, Why(found)) | {"lower_exact": None, "upper_exact": None}
        return CertifiedResult(**same, outcome=Uncovered.NOT_COVERED, outcome_why=found)
    lower, upper = found.lower if found.proof is not None else None, found.upper
    none = (
        "infeasible" if found.outcome is Outcome.INFEASIBLE else "no feasible durations were found"
    )
    unproved = "nothing is proved yet"
    wide = lower is None or not math.isfinite(found.gap)
    return CertifiedResult.of(
        found,
        **same,
        outcome_why=why,
        lower=outwards(lower, unproved, -1),
        upper=outwards(upper, none, 1),
        gap=Why(none if upper is None else unproved) if wide else found.gap,
        open_nodes=found.open_boxes,
        lower_exact=None if lower is None else decimal(lower),
        upper_exact=None if upper is None else decimal(upper),
        segment_durations=known(
            None if found.durations is None else tuple(map(float, found.durations)), none
        ),
    )


def outwards(value: Fraction | None, why: str, side: int) -> float | Why:
    """A bound in floats, rounded down (side -1) or up (1), or why there is none."""
    if value is None:
        return Why(why)
    try:
        rounded = float(value)
    except OverflowError:
        return Why("beyond the range of floating point")
    if side * (Fraction(rounded) - value) < 0:
        rounded = math.nextafter(rounded, side * math.inf)
    return rounded


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
    """Hash of the case file."""


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
    """Document of `verify`: one verdict per file."""
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
    return VerifiedFile.of(
        verdict,
        file=file,
        worth=worth(verdict),
        subject=verdict.subject if verdict.proves else None,
        lower=outwards(verdict.lower, why, -1),
        upper=outwards(verdict.upper, why, 1),
        question=AskedQuestion.of(verdict.question),
        in_case=AskedQuestion.of(about)
        if isinstance(about, CertifiedQuestion)
        else Why(about or UNNAMED),
    )
