"""States of stopped certifications: what is proved so far, and what was to come next."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...problem import TrajgapError, check_regular
from ...verify import (
    SECONDS,
    STATE_FORMAT,
    CertifiedQuestion,
    Refused,
    Subject,
    read_document,
    verify_certificate,
)
from .crew import ProofCrew
from .document import document_of, fits, sealed
from .exact import ExactProblem
from .outcome import GAP, Certified, claimed


@dataclass(frozen=True, eq=False)
class StateFile:
    """What a state file holds.

    Attributes
    ----------
    name : str
        Of the file, for messages.
    document : dict
        For ``resume`` of `certify`, which proves it again.
    """

    name: str
    document: dict[str, Any]

    def fits(self, problem: ExactProblem, subject: Subject = Subject.DECLARED) -> bool:
        """Whether it is about exactly this question."""
        return fits(self.document, problem, subject)


def state_document(
    certified: Certified, question: CertifiedQuestion | None = None
) -> dict[str, Any] | None:
    """State of a stopped run, ready for JSON; None if there is nothing to go on from.

    Parameters
    ----------
    certified : Certified
    question : CertifiedQuestion, optional
        Where the problem comes from.

    Returns
    -------
    dict or None
    """
    if not certified.stopped:
        return None
    document = document_of(STATE_FORMAT, certified, question or CertifiedQuestion())
    proposals = certified.proposals
    return sealed({**document, "proposals": None if proposals is None else proposals.document()})


def read_state(path: str | Path) -> StateFile:
    """Read a state file.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    StateFile

    Raises
    ------
    TrajgapError
        If it is not a state file, or differs from what was written. The seal guards against damage
        alone: `certify` proves everything in it again.
    """
    name = str(path)
    check_regular(Path(path))
    try:
        document = read_document(path)
    except Refused as error:
        raise TrajgapError(f"{name}: {error}") from None
    if not isinstance(document, dict) or document.get("format") != STATE_FORMAT:
        raise TrajgapError(f"{name}: is not a {STATE_FORMAT}; name a state file")
    rest = {key: value for key, value in document.items() if key != "seal"}
    if sealed(rest)["seal"] != document.get("seal"):
        raise TrajgapError(f"{name}: was altered; start without it")
    return StateFile(name, document)


def resumed(
    problem: ExactProblem,
    state: Certified | dict[str, Any],
    subject: Subject = Subject.DECLARED,
    gap: float = GAP,
    seconds: float = SECONDS,
    crew: ProofCrew | None = None,
) -> Certified:
    """What a stopped run left, its proof and its answer proved again by `trajgap.verify`.

    Parameters
    ----------
    problem : ExactProblem
    state : Certified or dict
        The run, or its `state_document`.
    subject : Subject
    gap : float
        Up to which an interval counts as certified.
    seconds : float
        Time limit.
    crew : ProofCrew, optional
        Who judges; without one, this process alone.

    Returns
    -------
    Certified

    Raises
    ------
    TrajgapError
        If it does not prove what it says, or is about something else.
    """
    document = state_document(state) if isinstance(state, Certified) else state
    if not isinstance(document, dict) or document.get("format") != STATE_FORMAT:
        raise TrajgapError(f"resume: no {STATE_FORMAT}; give a run that was stopped, or its state")
    spread = None if crew is None else crew.spread
    verdict = verify_certificate(document, seconds=seconds, spread=spread)
    if not verdict.proves:
        raise TrajgapError(f"resume: the state is not proved ({verdict.reason})")
    if not fits(document, problem, subject):
        raise TrajgapError("resume: the state belongs to another problem; start without it")
    return claimed(problem, document, verdict, gap, subject)
