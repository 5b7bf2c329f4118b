"""Searches near the optima of single joints, kept in a folder of the user's for later audits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...problem import Array, Verdict, check
from ..per_joint import LEFT, Near, nearby
from .document import problem_seal
from .kept import search_code
from .kept_files import KeptFiles, as_text, from_text


class KeptNearby(KeptFiles):
    """Answers questions as `nearby` does, with what earlier runs left in one folder."""

    kind = "durations"

    def __call__(self, questions: list[Near]) -> Sequence[list[Array]]:
        """Answers of the questions, a group that is kept and discarded as a whole.

        Parameters
        ----------
        questions : list of Near

        Returns
        -------
        sequence of list of ndarray
            One list for each question, in it the durations of each joint.
        """
        return self.answers(
            lambda: {"questions": [_words(one) for one in questions], "code": search_code()},
            len(questions),
            lambda: [nearby(one) for one in questions],
            lambda found: [as_text(h) for h in found],
            lambda at, left: _judged(questions[at], left),
            lambda at: nearby(questions[at]),
        )


def _words(question: Near) -> list[Any]:
    weights = question.weights
    return [
        [problem_seal(problem) for problem in question.problems],
        [as_text(h) for h in question.starts],
        [repr(cap) for cap in question.caps],
        None if weights is None else as_text(weights),
    ]


def _judged(question: Near, left: list[str]) -> list[Array]:
    """Durations that were left; raises if they break a limit, a bound or the cap of their joint."""
    found = [from_text(text) for text in left]
    for problem, h, cap in zip(question.problems, found, question.caps, strict=True):
        if h.shape != (problem.segments,) or h.sum() > cap * (1 + LEFT):
            raise ValueError("no durations within the cap")
        if check(problem, h).limits is not Verdict.PASS:
            raise ValueError("durations that break a limit")
    return found
