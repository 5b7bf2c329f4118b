"""State files of stopped certifications: sealed JSON, of which nothing is taken on trust."""

from __future__ import annotations

import importlib.metadata
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...problem import TrajgapError, check_regular
from ..verify import seal
from .document import problem_document, question
from .exact import ExactProblem
from .outcome import Certified

STATE_FORMAT = "trajgap-state-1"


@dataclass(frozen=True, eq=False)
class StateFile:
    """What a state file holds.

    Attributes
    ----------
    name : str
        Of the file, for messages.
    problem : dict
        As in a certificate.
    state : dict
        For ``resume`` of `certify`, which proves it again.
    """

    name: str
    problem: dict[str, Any]
    state: dict[str, Any]

    def fits(self, problem: ExactProblem) -> bool:
        """Whether it is about exactly this question; its name does not matter."""
        return question(self.problem) == question(problem_document(problem))


def state_document(certified: Certified) -> dict[str, Any] | None:
    """State of a stopped run, ready for JSON; None if there is nothing to go on from.

    Parameters
    ----------
    certified : Certified

    Returns
    -------
    dict or None
    """
    if certified.resume is None:
        return None
    document = {
        "format": STATE_FORMAT,
        "made_by": f"trajgap {importlib.metadata.version('trajgap')}",
        "problem": problem_document(certified.problem),
        "state": certified.resume.document(),
    }
    return {**document, "seal": seal(document)}


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
        If it is no state file, or differs from what was written. The seal guards against damage
        alone: `certify` proves everything in it again.
    """
    name = str(path)
    check_regular(Path(path))
    try:
        document = json.loads(Path(path).read_text("utf-8"))
    except OSError as error:
        raise TrajgapError(f"{name}: cannot be read ({error.strerror}); check the path") from None
    except (ValueError, RecursionError):
        raise TrajgapError(f"{name}: is no JSON; name a state file") from None
    if not isinstance(document, dict) or document.get("format") != STATE_FORMAT:
        raise TrajgapError(f"{name}: is no {STATE_FORMAT}; name a state file")
    rest = {key: value for key, value in document.items() if key != "seal"}
    if seal(rest) != document.get("seal"):
        raise TrajgapError(f"{name}: differs from what was written; start without it")
    if not isinstance(document.get("problem"), dict) or not isinstance(document.get("state"), dict):
        raise TrajgapError(f"{name}: has no problem or no state; start without it")
    return StateFile(name, document["problem"], document["state"])
