"""The commands `solve --certify` and `verify`: proofs written to files, and proved again."""

from __future__ import annotations

import json
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from types import FrameType
from typing import Any

from ...nlp import (
    FORMAT,
    Certified,
    ExactProblem,
    Outcome,
    Progress,
    Verdict,
    certify,
    printed_problem,
    verify,
)
from ...nlp.proofs import (
    STATE_FORMAT,
    StateFile,
    certificate,
    certificate_text,
    covered,
    question,
    read_state,
    state_document,
)
from ...problem import (
    Case,
    CaseError,
    Coupling,
    TrajgapError,
    check_regular,
    file_name,
    read_regular,
)
from ..documents import certify_document, certify_result, verify_document
from . import proof_tables as cli_proofs
from .input import Posed, naming, read_case, select
from .output import (
    Steps,
    check_certificates,
    emit,
    json_text,
    new_output,
    progress,
    replace_output,
    say,
)

CERTIFICATE_FOLDER = Path("trajgap-certificates")
NOT_PROVED = 3
"""Exit code where an interval is wider than asked for, or nothing is proved."""
_LARGEST = 64_000_000
"""Largest certificate or state that is looked at before it is replaced, bytes."""
_SETTLED = (Outcome.CERTIFIED, Outcome.INFEASIBLE)


@dataclass(frozen=True, eq=False)
class Question:
    """One problem to certify: all joints together, or one that is optimised by itself."""

    name: str
    posed: Posed
    joint: str | None
    problem: ExactProblem | str
    """Or why it is not covered."""


def certify_case(
    source: str,
    problem: str | None,
    reading: str | None,
    coupling: str | None,
    gap: float,
    seconds: float,
    seed: int,
    folder: Path | None,
    resume: Sequence[Path],
    as_json: bool,
    out: Path | None,
) -> int:
    """Prove an interval of the optimum of each selected problem and reading."""
    case = read_case(source)
    chosen = select(case, problem, reading, coupling)
    asked = [q for one in chosen for q in _questions(case, one)]
    states = _states(resume, asked)
    folder = CERTIFICATE_FOLDER if folder is None and not as_json else folder
    if not 0 <= gap < 1:
        raise CaseError(source, "--gap", f"{gap:g} is no relative width; give 0 or more, below 1")
    if folder is not None:
        check_certificates(folder)
        _check_files(folder, asked)
    results: list[dict[str, Any]] = []
    unsettled, stop = False, _Stop()
    with new_output(out) as write:
        with progress("certify", len(asked)) as step, naming(case.file), stop.listening():
            for one in asked:
                if stop.asked:
                    break
                step(one.name)
                found: Certified | str = (
                    one.problem
                    if isinstance(one.problem, str)
                    else certify(
                        one.problem,
                        gap=gap,
                        seconds=seconds,
                        seed=seed,
                        resume=states[one.name].state if one.name in states else None,
                        report=stop.reporting(one.name, step),
                    )
                )
                why = None
                if not isinstance(found, str):
                    step.tell(f"{one.name}: the proof is checked")
                    found, why = _checked(found)
                unsettled |= isinstance(found, str) or found.outcome not in _SETTLED
                files = _written(folder, one.name, found)
                ids = (case.id, one.posed.problem_id, one.posed.reading_id, one.joint)
                results.append(certify_result(*ids, found, *files, why))
        document = certify_document(results)
        write(json_text(document))
    emit(document, cli_proofs.certified, as_json)
    if folder is not None and not as_json and any(r["certificate"] for r in results):
        say(f"certificates: {folder}\n")
    if stop.asked:
        raise KeyboardInterrupt
    return NOT_PROVED if unsettled else 0


def _questions(case: Case, one: Posed) -> Iterator[Question]:
    posing = case.posing(one.problem_id, one.reading_id)
    name = f"{case.id}.{one.problem_id}.{one.reading_id}"
    labels: list[str | None] = [None]
    if one.problem.coupling is Coupling.PER_JOINT:
        labels = list(one.problem.joints)
    for j, label in enumerate(labels):
        own = name if label is None else f"{name}.joint-{label}"
        try:
            exact = printed_problem(posing)
            exact = exact if label is None else exact.joint(j)
            why = covered(exact)
        except CaseError:
            raise
        except TrajgapError as error:
            why = str(error)
        yield Question(own, one, label, exact if why is None else why)


def _states(resume: Sequence[Path], asked: Sequence[Question]) -> dict[str, StateFile]:
    """State files by the name of the question that each is about."""
    found: dict[str, StateFile] = {}
    for path in resume:
        state = read_state(path)
        fits = [q.name for q in asked if not isinstance(q.problem, str) and state.fits(q.problem)]
        if not fits:
            raise CaseError(
                state.name, "problem", "is none of those selected; name the case and reading of it"
            )
        found |= dict.fromkeys(fits, state)
    return found


def _checked(found: Certified) -> tuple[Certified, str | None]:
    """Nothing is called certified that the verifier does not prove again."""
    if found.proof is None:
        return found, None
    verdict = verify(certificate(found))
    if verdict.proves:
        return found, None
    nothing = replace(found, outcome=Outcome.OPEN, lower=Fraction(0), proof=None)
    return nothing, f"the proof found is refused: {verdict.reason}"


def _file(folder: Path, name: str, kind: str = "") -> Path:
    return folder / f"{file_name(name)}{kind}.json"


def _check_files(folder: Path, asked: Sequence[Question]) -> None:
    """Find out before computing whether what is in the way may be replaced."""
    for one in asked:
        for kind, wanted in (("", FORMAT), (".state", STATE_FORMAT)):
            path = _file(folder, one.name, kind)
            if path.exists() and _read(path).get("format") != wanted:
                raise CaseError(str(path), "--certificates", f"is no {wanted}; name another folder")


def _read(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(read_regular(path, _LARGEST, "name another folder"))
    except (ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}


def _written(
    folder: Path | None, name: str, found: Certified | str
) -> tuple[str | None, str | None]:
    """Write certificate and state; a narrower certificate of the same problem is kept."""
    if folder is None or isinstance(found, str):
        return None, None
    certificate, state = _file(folder, name), _file(folder, name, ".state")
    document = state_document(found)
    if document is not None:
        replace_output(state, json.dumps(document, separators=(",", ":")) + "\n")
    if found.proof is not None:
        text = certificate_text(found)
        if not _narrower(certificate, json.loads(text), found):
            replace_output(certificate, text)
    return (
        str(certificate) if found.proof is not None else None,
        str(state) if document is not None else None,
    )


def _narrower(path: Path, new: dict[str, Any], found: Certified) -> bool:
    """Whether the file there proves a narrower interval of the same problem."""
    old = _read(path)
    if not isinstance(old.get("problem"), dict) or question(old["problem"]) != question(
        new["problem"]
    ):
        return False
    verdict = verify(old)
    if not verdict.proves or verdict.lower is None or verdict.upper is None:
        return False
    if verdict.subject != found.subject:
        return False
    return found.upper is None or verdict.upper - verdict.lower < found.upper - found.lower


class _Stop:
    """Ctrl-C while proofs are searched: the first ends the search, the second the program."""

    def __init__(self) -> None:
        self.asked = False

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Remember the first Ctrl-C."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = signal.getsignal(signal.SIGINT)

        def remember(signum: int, frame: FrameType | None) -> None:
            self.asked = True
            signal.signal(signal.SIGINT, before)

        signal.signal(signal.SIGINT, remember)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)

    def reporting(self, name: str, step: Steps) -> Callable[[Progress], None]:
        """What a search calls after every batch: the live line, and the end if asked for."""

        def report(now: Progress) -> None:
            if self.asked:
                raise KeyboardInterrupt
            step.tell(
                f"{name}: {now.lower:.6f} to {now.upper:.6f} s, gap {now.gap:.1e}, "
                f"{now.open_boxes} open, {now.rate:.0f} nodes/s"
            )

        return report


def verify_files(files: Sequence[Path], as_json: bool, out: Path | None) -> int:
    """Prove certificates again; 1 if any is refused."""
    for path in files:
        check_regular(path)
    with new_output(out) as write:
        verdicts: list[tuple[str, Verdict]] = []
        with progress("verify", len(files)) as step:
            for path in files:
                step(path.name)
                verdicts.append((str(path), verify(path)))
        document = verify_document(verdicts)
        write(json_text(document))
    if as_json:
        emit(document, lambda _: (), as_json)
    else:
        say(cli_proofs.verified(document))
    return 0 if all(verdict.proves for _, verdict in verdicts) else 1
