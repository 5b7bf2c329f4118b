"""`solve --certify`: an interval of each optimum, with its proof in files."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from types import FrameType
from typing import Any

from ...nlp import Certified, ExactProblem, Outcome, Progress, certify, printed_problem
from ...nlp.proofs import StateFile, certificate_text, covered, fits, read_state, state_document
from ...problem import Case, CaseError, Coupling, TrajgapError, file_name, shown_bound
from ...verify import (
    CERTIFICATE_FORMAT,
    OLD_FORMATS,
    STATE_FORMAT,
    CertifiedQuestion,
    Clock,
    Refused,
    Subject,
    number,
    read_document,
    verify_certificate,
)
from ..audits import in_words
from ..blocks import Block, Prose
from ..documents import CertifiedResult, CertifyDocument, Why, certify_result, json_text
from .input import Selected, naming, select
from .motion_results import by_question
from .options import ExitCode, Options, SelectOptions, count, option
from .output import (
    AnswerOptions,
    Steps,
    check_certificates,
    emit,
    interrupted_by,
    kept_proofs,
    new_output,
    progress,
    replace_output,
    say,
)


@dataclass(frozen=True, kw_only=True)
class ProofOptions(Options):
    """What a proof is asked for."""

    gap: float | None = option("G", min=0.0, usual="1e-6")
    """With --certify: relative width to reach."""
    any_curve: bool = option("", False)
    """With --certify: prove a bound for every motion through the way-points, on any curve."""
    certificates: Path | None = option("FOLDER", usual="trajgap-certificates; none with --json")
    """With --certify: folder for certificates and for states of stopped runs."""
    resume: list[Path] | None = option("FILE")
    """With --certify: continue from this state file, which is verified. May be repeated."""
    workers: int | None = count(usual="all cores")
    """With --certify: number of cores for the proof; the result does not depend on it."""


@dataclass(frozen=True, eq=False)
class Question:
    """One problem to certify: all joints together, or one that is optimised by itself."""

    selected: Selected
    asked: CertifiedQuestion
    problem: ExactProblem | str
    """Or why it is not covered."""
    words: str = ""
    """What it is called while it is proved."""
    subject: Subject = Subject.DECLARED
    """What the interval is to speak about."""

    @property
    def file(self) -> str:
        """Name of its files, which no other question has, whatever the case of letters.

        The parts with dots between them, where that is a plain name and its only dots are these;
        else what `file_name` makes of them, which ends with an underscore and a hash.
        """
        asked = self.asked
        parts = [str(x) for x in (asked.case, asked.problem, asked.reading)]
        parts += [] if asked.joint is None else [f"joint-{asked.joint}"]
        parts += ["any-curve"] if self.subject is Subject.ANY else []
        plain = ".".join(parts)
        apart = all(part and "." not in part for part in parts)
        return plain if apart and file_name(plain) == plain else file_name(*parts)


def certify_case(
    case: Case,
    chosen: SelectOptions,
    proof: ProofOptions,
    seconds: float,
    seed: int,
    to: AnswerOptions,
    cache: bool = True,
) -> int:
    """Prove an interval of the optimum of each selected problem and reading."""
    subject = Subject.ANY if proof.any_curve else Subject.DECLARED
    selected = select(case, chosen.problem, chosen.reading, chosen.coupling)
    asked = [q for one in selected for q in _questions(case, one, subject)]
    states = _states(proof.resume or [], asked)
    folder, as_json = proof.certificates, to.as_json
    if folder is None and not as_json:
        folder = Path("trajgap-certificates")
    gap = 1e-6 if proof.gap is None else proof.gap
    if not 0 <= gap < 1:
        why = f"{gap:g} is not a relative width; give 0 or more, below 1"
        raise CaseError(case.file, "--gap", why)
    if folder is not None:
        check_certificates(folder)
        _check_files(folder, asked)
    results: list[CertifiedResult] = []
    settled = Outcome.CERTIFIED, Outcome.INFEASIBLE
    unsettled, kept, stop = False, 0, _Stop()
    with new_output(to.out) as write:
        with (
            progress("certify", len(asked)) as step,
            naming(case.file),
            interrupted_by(stop.remember),
        ):
            for one in asked:
                if stop.asked:
                    break
                step(one.words)
                clock = Clock(seconds + 1.0)  # of a second more to judge an earlier certificate
                found: Certified | str
                if isinstance(one.problem, str):
                    found = one.problem
                else:
                    found = certify(
                        one.problem,
                        subject=subject,
                        gap=gap,
                        seconds=seconds,
                        seed=seed,
                        resume=states[one.file].document if one.file in states else None,
                        report=stop.reporting(one.words, step),
                        workers=proof.workers or os.cpu_count() or 1,
                        cache=cache,
                    )
                kept += not isinstance(found, str) and found.kept
                unsettled |= isinstance(found, str) or found.outcome not in settled
                files = _written(folder, one, found, clock)
                results.append(certify_result(one.asked, subject, found, *files, _why(found)))
        document = CertifyDocument(intervals=tuple(results))
        write(json_text(document))
    emit(document, lambda shown: _certified(shown, case), as_json)
    if folder is not None and not as_json and any(r.certificate for r in results):
        say(f"certificates: {folder}\n")
    if kept and not as_json:
        say(kept_proofs(kept))
    if stop.asked:
        raise KeyboardInterrupt
    return ExitCode.NOT_PROVED if unsettled else 0


def read_certificates(folder: Path) -> list[dict[str, Any]]:
    """The certificates in a folder; other files of it are left alone."""
    option = "--certificates"
    if not folder.is_dir():
        raise CaseError(str(folder), option, "is not a folder; give the one with your files")
    documents = [_read(path) for path in sorted(folder.glob("*.json"))]
    found = [one for one in documents if one.get("format") == CERTIFICATE_FORMAT]
    if not found:
        why = f"holds no {CERTIFICATE_FORMAT}; make one with solve --certify"
        raise CaseError(str(folder), option, why)
    return found


def _questions(case: Case, one: Selected, subject: Subject) -> Iterator[Question]:
    """What is asked under one reading, of all joints or of each, with why it is not covered."""
    # A bound over any curve is one of all joints together: what else would they share.
    coupling = Coupling.SHARED if subject is Subject.ANY else one.problem.coupling
    for question in questions_of(case, one, coupling):
        exact = question.problem
        why = exact if isinstance(exact, str) else covered(exact, subject)
        asked = replace(question, subject=subject)
        yield asked if why is None else replace(asked, problem=why)


def questions_of(case: Case, one: Selected, coupling: Coupling) -> Iterator[Question]:
    """What is asked under one reading, covered or not."""
    statement = case.statement(one.problem_id, one.reading_id)
    said = in_words(case, one.problem_id, one.reading_id)
    ids = (case.id, one.problem_id, one.reading_id)
    alone = coupling is Coupling.PER_JOINT
    labels: Sequence[str | None] = one.problem.joints if alone else [None]
    for j, label in enumerate(labels):
        words = said if label is None else f"joint {label} alone; {said}"
        exact: ExactProblem | str
        try:
            exact = printed_problem(statement)
            exact = exact if label is None else exact.joint(j)
        except CaseError:
            raise
        except TrajgapError as error:
            exact = str(error)
        yield Question(one, CertifiedQuestion(*ids, label, case.sha256), exact, words)


def _states(resume: Sequence[Path], asked: Sequence[Question]) -> dict[str, StateFile]:
    """State files by the files of the question that each is about."""
    found: dict[str, StateFile] = {}
    for path in resume:
        state = read_state(path)
        fits = [
            q.file
            for q in asked
            if not isinstance(q.problem, str) and state.fits(q.problem, q.subject)
        ]
        if not fits:
            raise CaseError(
                state.name, "problem", "is not among those selected; select its case and reading"
            )
        found |= dict.fromkeys(fits, state)
    return found


def _why(found: Certified | str) -> str | None:
    """Why a proof that was found does not count, or what the time was too short for."""
    if isinstance(found, str):
        return None
    if found.verdict is None or found.verdict.proves:
        if found.problem.relaxed:
            left_out = " and ".join(found.problem.relaxed)
            return (
                f"the limits of {left_out} are left out of proofs: the lower bound holds within "
                "them too, and no answer is claimed"
            )
        if found.widened and found.outcome is Outcome.INTERVAL:
            return (
                "lower and upper limits differ, and this kind of proof uses the larger size on "
                "both sides: the lower bound holds, but more time need not close the gap"
            )
        if found.left_out is None:
            return None
        return f"{found.left_out}; --time was too short; resume with more time"
    if found.verdict.out_of_time:
        return "the proof was not verified within --time; resume with more time"
    return f"the proof was refused: {found.verdict.reason}"


def _file(folder: Path, one: Question, kind: str = "") -> Path:
    return folder / f"{one.file}{kind}.json"


def _check_files(folder: Path, asked: Sequence[Question]) -> None:
    """Find out before computing whether what is in the way may be replaced."""
    for one in asked:
        for kind, wanted in (("", CERTIFICATE_FORMAT), (".state", STATE_FORMAT)):
            path = _file(folder, one, kind)
            if path.exists() and _read(path).get("format") not in (wanted, *OLD_FORMATS):
                raise CaseError(
                    str(path), "--certificates", f"is not a {wanted}; name another folder"
                )


def _read(path: Path) -> dict[str, Any]:
    try:
        document = read_document(path)
    except Refused:
        return {}
    return document if isinstance(document, dict) else {}


def _written(
    folder: Path | None, one: Question, found: Certified | str, clock: Clock
) -> tuple[str | None, str | None]:
    """Write certificate and state; a narrower certificate of the same problem is kept."""
    if folder is None or isinstance(found, str):
        return None, None
    certificate, state = _file(folder, one), _file(folder, one, ".state")
    document = state_document(found, one.asked)
    if document is not None:
        replace_output(state, json.dumps(document, separators=(",", ":")) + "\n")
    if found.proof is not None and not _narrower(certificate, found, clock):
        replace_output(certificate, certificate_text(found, one.asked))
    if document is None:
        # What a state of an earlier run would lead to is there.
        state.unlink(missing_ok=True)
    return (
        str(certificate) if found.proof is not None else None,
        str(state) if document is not None else None,
    )


def _narrower(path: Path, found: Certified, clock: Clock) -> bool:
    """Whether the file there proves a narrower interval of the same problem.

    Where the time is too short to prove it again, one that nobody altered is taken at its word:
    what took long to prove is not thrown away.
    """
    old = _read(path)
    if not fits(old, found.problem, found.subject):
        return False
    verdict = verify_certificate(old, clock=clock)
    lower, upper = verdict.lower, verdict.upper
    if verdict.out_of_time and not verdict.altered:
        try:
            lower, upper = (number(old["claim"][key]) for key in ("lower", "upper"))
        except (Refused, LookupError, TypeError):
            return False
    if lower is None or upper is None:
        return False
    return found.upper is None or upper - lower < found.upper - found.lower


class _Stop:
    """Ctrl-C while proofs are searched: the first ends the search, the second the program."""

    def __init__(self) -> None:
        self.asked = False
        self._before = signal.getsignal(signal.SIGINT)

    def remember(self, _signum: int, _frame: FrameType | None) -> None:
        """Answer the first Ctrl-C."""
        self.asked = True
        signal.signal(signal.SIGINT, self._before)

    def reporting(self, name: str, step: Steps) -> Callable[[Progress], None]:
        """What a search calls after every batch: the live line, and the end if asked for."""

        def report(now: Progress) -> None:
            if self.asked:
                raise KeyboardInterrupt
            low = shown_bound(now.lower, "lower", places=6)
            high = shown_bound(now.upper, "upper", places=6)
            rest = f"gap {now.gap:.1e}, {now.open_boxes} open, {now.rate:.0f} nodes/s"
            step.tell(f"{name}: {low} to {high} s, {rest}")

        return report


def _certified(document: CertifyDocument, case: Case) -> list[Block]:
    """Summary of the `solve --certify` document."""
    results = document.intervals
    if not results:
        return [Prose("nothing was begun", "note")]
    apart = any(r.joint is not None for r in results)
    rows: dict[tuple[str, str], list[Sequence[object]]] = {}
    for r in results:
        row = ((r.joint or "all",) if apart else ()) + _cells(r)
        rows.setdefault((r.problem, r.reading), []).append(row)
    names = (">lower s", ">upper s", ">gap", ">nodes", ">open", ">seconds", "outcome")
    columns = (("joint",) if apart else ()) + names
    parts: list[Block] = [Prose(results[0].case, "heading")]
    parts += by_question(rows, columns, apart, case)
    reasons = dict.fromkeys(r.outcome_why for r in results if r.outcome_why)
    parts += [Prose(reason, "note") for reason in reasons]
    return parts + [Prose(f"continue with --resume {r.state}") for r in results if r.state]


def _cells(result: CertifiedResult) -> tuple[object, ...]:
    gap, seconds = result.gap, result.seconds
    # Words that alone might be taken for a guess.
    said: dict[str, str] = {
        Outcome.INFEASIBLE: "infeasible: proved",
        Outcome.OPEN: "nothing proved",
    }
    if Fraction(result.lower_exact or 0) > 0:
        said[Outcome.OPEN] = "no motion proved"
    return (
        _bound(result.lower_exact, "lower"),
        _bound(result.upper_exact, "upper"),
        "" if isinstance(gap, Why) else f"{gap:.1e}",
        *("" if isinstance(n, Why) else n for n in (result.nodes, result.open_nodes)),
        "" if isinstance(seconds, Why) else f"{seconds:.1f}",
        said.get(result.outcome, result.outcome),
    )


def _bound(exact: str | None, side: str) -> str:
    return "none" if exact is None else shown_bound(Fraction(exact), side, places=9)
