"""Options of an audit, and its proved intervals: shipped, given in files, or certified in time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...nlp import ExactProblem, Outcome, ProvedInterval, certificate, certify, proved
from ...nlp.proofs import allowance, covered, interval_of
from ...problem import TrajgapError
from ...verify import Subject

SEEDS = 100
"""Seeds of a replay by default: independent runs enough for a probability to a few per cent."""
ALLOWANCES = 3.0
"""For all problems of a case, in what one problem is allowed: most declared and short spline
problems are certified in it, and a usual audit still ends in about a minute. Boxes are counted and
not seconds, so no verdict depends on how busy the machine is."""


@dataclass(frozen=True, kw_only=True)
class AuditOptions:
    """Options of an audit; the fields are the parameters of `audit`.

    Raises
    ------
    TrajgapError
        If there are fewer than two seeds.
    """

    seeds: int = SEEDS
    workers: int | None = 1
    problem: str | None = None
    reading: str | None = None
    progress: Callable[[str], None] | None = None
    certify_seconds: float | None = None
    certificates: Sequence[dict[str, Any]] = ()
    certificates_folder: str | None = None
    draft: bool = False
    cache: bool | Path = False

    def __post_init__(self) -> None:
        if self.seeds < 2:
            raise TrajgapError(
                f"seeds: {self.seeds} show no spread; give 2 or more, 30 is customary"
            )


USUAL = AuditOptions()
"""The options of an audit that names none."""


class Intervals:
    """Where the proved intervals of one audit come from."""

    def __init__(self, options: AuditOptions) -> None:
        seconds = options.certify_seconds
        self._documents = tuple(options.certificates)
        self._made: list[dict[str, Any]] = []
        self._counted = seconds is None
        self._left = ALLOWANCES if seconds is None else seconds
        self._progress = options.progress
        self._cache = options.cache
        self.kept = 0
        """Proofs of earlier runs that were verified and count here."""
        self._found: dict[ExactProblem, ProvedInterval | None] = {}
        self.left_out: list[str] = []
        """Problems that are covered and were not certified, and totals that were not excluded for
        want of boxes, in words."""

    @property
    def documents(self) -> tuple[dict[str, Any], ...]:
        """Certificates that were given, and those that this audit made."""
        return (*self._documents, *self._made)

    def interval(self, problem: ExactProblem, called: str = "the optimum") -> ProvedInterval | None:
        """The interval that is proved for a problem, if there is one.

        Parameters
        ----------
        called : str
            What is proved, in the words of progress lines and of what was left out.
        """
        if problem not in self._found:
            self._found[problem] = self._sought(problem, called)
        return self._found[problem]

    def any_curve(self, problem: ExactProblem) -> ProvedInterval | None:
        """The interval over any curve that a given or shipped certificate proves."""
        return self._by_document(problem, Subject.ANY)

    def _by_document(self, problem: ExactProblem, subject: Subject) -> ProvedInterval | None:
        mine = (interval_of(one, problem, subject) for one in self._documents)
        return next((found for found in mine if found is not None), None) or proved(
            problem, subject
        )

    def _sought(self, problem: ExactProblem, called: str) -> ProvedInterval | None:
        found = self._by_document(problem, Subject.DECLARED)
        if found is not None or covered(problem) is not None:
            return found
        # A third of what is left, so that later problems get their turn too. With less than a tenth
        # of an allowance, or half a second, a search would prove nothing.
        share = self._left / 3
        if share < (0.1 if self._counted else 0.5):
            if self._left > 0:
                left = "no boxes were" if self._counted else "no time was"
                self.left_out.append(f"{called}: {left} left")
            return None
        most = allowance(problem)
        boxes = max(1.0, round(share * most)) if self._counted else math.inf
        seconds = math.inf if self._counted else share
        amount = f"{boxes:.0f} boxes" if self._counted else f"{seconds:.0f} s"
        if self._progress is not None:
            self._progress(f"certifying {called}, at most {amount}")
        began = time.monotonic()
        try:
            # This gap is far below the digits that papers print, and cheap to reach.
            answer = certify(problem, gap=1e-4, seconds=seconds, boxes=boxes, cache=self._cache)
        except TrajgapError:
            return None  # nothing limits its total
        # What was proved with kept proofs costs nothing, and counts as if it had been searched.
        self._left -= answer.nodes / most if self._counted else time.monotonic() - began
        if answer.proof is not None and answer.outcome is not Outcome.OPEN:
            document = certificate(answer)
            found = interval_of(document, problem, verdict=answer.verdict)
            if found is not None:
                self._made.append(document)
                self.kept += answer.kept
        if found is None:
            tried = "with" if self._counted else "for"
            self.left_out.append(f"{called}, tried {tried} {amount}")
        return found
