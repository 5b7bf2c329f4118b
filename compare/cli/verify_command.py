"""The command `verify`: proofs proved again, apart from the solver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...nlp import ExactProblem
from ...nlp.proofs import unlike
from ...problem import Case, Coupling, check_regular
from ...verify import (
    CertificateVerdict,
    CertifiedQuestion,
    Clock,
    OutOfTime,
    Refused,
    read_document,
    verify_certificate,
)
from ..audits import asked_as, in_words
from ..blocks import Prose
from ..documents import UNNAMED, AskedQuestion, JudgedFile, VerifyDocument, verify_document, worth
from .certifying import Question, questions_of
from .input import read_case, select
from .options import Options, argument, option
from .output import AnswerOptions, progress


@dataclass(frozen=True, kw_only=True)
class VerifyOptions(Options):
    """The files, and what they are compared with."""

    files: list[Path] = argument("FILE...")
    """Certificates, or states."""
    case: str | None = option("CASE")
    """Compare the problems, number by number, with those of this published case or case file."""
    seconds: float = option("SECONDS", 60.0, "--time", min=0.0)
    """For each file."""


def verify(asked: VerifyOptions, to: AnswerOptions) -> int:
    """Verify certificates independently of the solver.

    The code that does so imports nothing of it.
    """
    for path in asked.files:
        check_regular(path)
    known = None
    stated = None if asked.case is None else read_case(asked.case)
    if stated is not None:
        known = [
            question
            for one in select(stated, None, None)
            for coupling in Coupling
            for question in questions_of(stated, one, coupling)
        ]
    verdicts: list[JudgedFile] = []

    def made() -> VerifyDocument:
        with progress("verify", len(asked.files)) as step:
            for path in asked.files:
                step(path.name)
                verdicts.append((str(path), *_verdict(path, asked.seconds, known)))
        return verify_document(verdicts)

    to.answer(made, lambda shown: _verified(shown, stated))
    good = all(verdict.proves and not isinstance(about, str) for _, verdict, about in verdicts)
    return 0 if good else 1


def _verdict(
    path: Path, seconds: float, asked: Sequence[Question] | None
) -> tuple[CertificateVerdict, CertifiedQuestion | str | None]:
    """What a file is worth, and which question of a case it is about."""
    clock = Clock(seconds)  # for reading, too
    try:
        document = read_document(path, clock)
    except (Refused, OutOfTime):
        verdict = verify_certificate(path, clock=clock)
        return verdict, None if asked is None else str(worth(verdict))
    verdict = verify_certificate(document, clock=clock)
    if asked is None:
        return verdict, None
    return verdict, _about(document, verdict, asked) if verdict.proves else str(worth(verdict))


def _about(
    document: dict[str, Any], verdict: CertificateVerdict, asked: Sequence[Question]
) -> CertifiedQuestion | str:
    """The question of a case that a certificate is about, or why there is none."""
    differs = {}
    for one in asked:
        if isinstance(one.problem, ExactProblem):
            differs[one.asked] = unlike(document, one.problem, verdict.subject)
            if differs[one.asked] is None:
                return one.asked
    own = replace(verdict.question, case_sha256=None)
    named = [why for q, why in differs.items() if replace(q, case_sha256=None) == own]
    return (
        f"its problem differs in {named[0]}" if named else "the case does not contain this problem"
    )


def _verified(document: VerifyDocument, case: Case | None) -> list[Prose]:
    """What `verify` prints: a line a file, whatever the window, and what was asked.

    A file's problem has the ids that the file names; in the case it is called by words, with ids
    only where the file names other ones.
    """
    lines = []
    for one in document.verified:
        lines.append(f"{one.file}: {one.worth}: {one.reason}")
        if one.problem_hash is not None:
            lines.append(f"    {_asked(one.question)}; problem sha256 {one.problem_hash}")
        if isinstance(one.in_case, AskedQuestion):
            found = _found(one.in_case, one.question, case)
            lines.append(f"    the same problem as in the case: {found}")
        elif one.in_case.reason not in (UNNAMED, one.worth):
            lines.append(f"    not in the case: {one.in_case.reason}")
    return [Prose(line, "source") for line in lines]


def _found(found: AskedQuestion, named: AskedQuestion, case: Case | None) -> str:
    """A question of a case in words."""
    if case is None or found.problem is None or found.reading is None:
        return _asked(found)
    ids = (found.problem, found.reading)
    words = in_words if ids == (named.problem, named.reading) else asked_as
    joint = "" if found.joint is None else f"joint {found.joint} alone; "
    return f"{joint}{words(case, *ids)}"


def _asked(question: AskedQuestion) -> str:
    keys = ("case", "problem", "reading", "joint")
    named = [(key, getattr(question, key)) for key in keys]
    parts = [f"{key} {value}" for key, value in named if value is not None]
    return ", ".join(parts) or "a problem without a case"
