"""Proofs of earlier runs, kept in a folder of the user's and proved again before they count.

Whatever stands in a file of that folder, it costs time at most: only what `trajgap.verify` proves
of the very question that is asked is used, and only if it reaches the gap that is asked for.
"""

from __future__ import annotations

import importlib.metadata
import inspect
import json
import os
import sys
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from ...problem import TrajgapError, replace_file
from ...verify import (
    CertifiedQuestion,
    Refused,
    Subject,
    read_document,
    seal,
    verify_certificate,
)
from ..clock import RunClock
from .crew import ProofCrew
from .document import certificate, fits, problem_document
from .exact import ExactProblem
from .outcome import Certified, Outcome, claimed

VARIABLE = "TRAJGAP_CACHE"
"""Environment variable with another folder for what is kept; empty for none."""
FORMAT = "trajgap kept proof 1"
"""Of the files; what begins with anything else is none of them."""
MOST_KEPT = 256 * 2**20
"""Bytes of all files together: thousands of proofs of usual size. The oldest make way."""
_ODD = (OSError, LookupError, TypeError, ValueError, ArithmeticError, RecursionError)
"""What a file of any content may raise while it is read; `Refused` is a `ValueError`."""
_LIBRARIES = ("casadi", "numba", "numpy", "scipy")
"""What searches compute with: another version may find another proof of the same question."""


def cache_folder() -> Path | None:
    """The folder where proofs are kept; None where the environment says that none are.

    Returns
    -------
    Path or None
        ``proofs`` in what `VARIABLE` names, or in the system's usual place for caches.
    """
    named = os.environ.get(VARIABLE)
    if named is not None:
        return Path(named) / "proofs" if named else None
    from platformdirs import user_cache_path

    return user_cache_path("trajgap", appauthor=False) / "proofs"


class KeptProofs:
    """The proofs that are kept in one folder.

    Parameters
    ----------
    folder : Path or None
        Made when something is kept; None keeps nothing and knows nothing.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder

    def taken(
        self,
        problem: ExactProblem,
        subject: Subject,
        gap: float,
        seed: int,
        clock: RunClock,
        crew: ProofCrew | None = None,
    ) -> Certified | None:
        """What was proved before to the very question, proved again.

        Parameters
        ----------
        problem : ExactProblem
        subject : Subject
        gap : float
            Relative width that the interval has to reach.
        seed : int
        clock : RunClock
            Of which proving again may take what is left.
        crew : ProofCrew, optional
            Who proves it again; without one, this process alone.

        Returns
        -------
        Certified or None
            None where nothing is kept, or what is kept does not prove it in that time.
        """
        file = self._file(problem, subject, gap, seed)
        if file is None:
            return None
        try:
            kept = read_document(file)
            document, nodes = _parts(kept)
            if not fits(document, problem, subject):
                return None
            left, spread = clock.left, None if crew is None else crew.spread
            verdict = verify_certificate(document, seconds=left, spread=spread)
            if not verdict.proves or verdict.altered or verdict.lower is None:
                return None
            if verdict.question != CertifiedQuestion():
                return None  # words that no run has put there
            found = claimed(problem, document, verdict, gap, subject)
            found = replace(found, nodes=nodes, kept=True)
        except _ODD:
            return None
        return found if _settled(found, gap) else None

    def keep(self, found: Certified, gap: float, seed: int) -> None:
        """Keep a proof that settles its question; where that is impossible, nothing happens.

        Parameters
        ----------
        found : Certified
            As `trajgap.nlp.certify` returns it, with its verdict.
        gap : float
        seed : int
        """
        if found.verdict is None or not found.verdict.proves or not _settled(found, gap):
            return
        file = self._file(found.problem, found.subject, gap, seed)
        if file is None:
            return
        kept = {"format": FORMAT, "nodes": found.nodes, "certificate": certificate(found)}
        # A full disk, a folder that is read-only: the next run takes as long as this one.
        with suppress(OSError, TrajgapError):
            replace_file(file, json.dumps(kept, separators=(",", ":")) + "\n")
            self._make_room()

    def _file(self, problem: ExactProblem, subject: Subject, gap: float, seed: int) -> Path | None:
        if self._folder is None:
            return None
        asked = {
            "problem": problem_document(problem),
            "subject": str(subject),
            "gap": repr(float(gap)),
            "seed": seed,
            "code": _code(),
        }
        return self._folder / f"{seal(asked)}.json"

    def _make_room(self) -> None:
        """Remove the oldest files until the rest is small enough."""
        assert self._folder is not None
        files = [(file, file.stat()) for file in self._folder.glob("*.json")]
        total = sum(status.st_size for _, status in files)
        for file, status in sorted(files, key=lambda one: one[1].st_mtime):
            if total <= MOST_KEPT:
                return
            file.unlink(missing_ok=True)
            total -= status.st_size


def _parts(kept: Any) -> tuple[dict[str, Any], int]:
    """Certificate and number of boxes of a file that was read; raises if it is of another form."""
    if type(kept) is not dict or set(kept) != {"format", "nodes", "certificate"}:
        raise ValueError("no kept proof")
    document, nodes = kept["certificate"], kept["nodes"]
    if kept["format"] != FORMAT or type(document) is not dict or document.get("proof") is None:
        raise ValueError("no kept proof")
    if type(nodes) is not int or not 0 <= nodes < 2**53:
        raise ValueError("no number of boxes")
    return document, nodes


def _settled(found: Certified, gap: float) -> bool:
    """Whether a run ended because its question was settled, as any other run of it will."""
    if found.proof is None or found.stopped or found.left_out is not None:
        return False
    if found.outcome is Outcome.INFEASIBLE:
        return True
    if found.outcome is not Outcome.CERTIFIED or found.upper is None:
        return False
    return found.upper - found.lower <= Fraction(gap) * found.upper


@cache
def _code() -> str:
    """Hash of all that a search consists of: our files, and versions of what they compute with."""
    hashed = [f"python {'.'.join(map(str, sys.version_info[:3]))}"]
    hashed += [f"{name} {importlib.metadata.version(name)}" for name in _LIBRARIES]
    for known in (Certified, TrajgapError, Refused):
        folder = Path(inspect.getfile(known)).parent
        folder = folder.parent if known is Certified else folder
        hashed += [seal(file.read_text("utf-8")) for file in sorted(folder.rglob("*.py"))]
    return seal(hashed)
