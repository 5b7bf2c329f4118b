"""Proofs of earlier runs, kept in a folder of the user's and proved again before they count.

Whatever stands in a file of that folder, it costs time at most: only what `trajgap.verify` proves
of the very question that is asked is used, and only if it reaches the gap that is asked for.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from ...problem import TrajgapError
from ...verify import CertifiedQuestion, Refused, Subject, verify_certificate
from ..clock import RunClock
from .crew import ProofCrew
from .document import certificate, fits, problem_document
from .exact import ExactProblem
from .kept_files import UNREADABLE, KeptFiles, code_hash, folder_of
from .outcome import Certified, Outcome, claimed


class KeptProofs(KeptFiles):
    """The proofs that are kept in one folder."""

    kind = "proof"

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
            None if nothing is kept, or what is kept does not prove it in that time.
        """
        if not self.used:
            return None
        try:
            document, nodes = _parts(self.read(_asked(problem, subject, gap, seed)))
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
        except UNREADABLE:
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
        if (
            not self.used
            or found.verdict is None
            or not found.verdict.proves
            or not _settled(found, gap)
        ):
            return
        self.write(
            _asked(found.problem, found.subject, gap, seed),
            {"nodes": found.nodes, "certificate": certificate(found)},
        )


def _asked(problem: ExactProblem, subject: Subject, gap: float, seed: int) -> dict[str, Any]:
    return {
        "problem": problem_document(problem),
        "subject": str(subject),
        "gap": repr(float(gap)),
        "seed": seed,
        "code": search_code(),
    }


def _parts(kept: dict[str, Any]) -> tuple[dict[str, Any], int]:
    """Certificate and number of boxes of a file that was read; raises if it is of another form."""
    if set(kept) != {"nodes", "certificate"}:
        raise ValueError("no kept proof")
    document, nodes = kept["certificate"], kept["nodes"]
    if type(document) is not dict or document.get("proof") is None:
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


def search_code() -> str:
    """Hash of the exact side, of the problem and of the verifier."""
    own = folder_of(Certified).parent
    return code_hash(own, folder_of(TrajgapError), folder_of(Refused))
