"""A draft with edits made, and a study of it that asks the original for what they leave alone."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any, cast

from ...nlp import PerJointSolution, Solution, printed_problem_or_none
from ...problem import Case, Printed
from ...problem.cases import AnyClaim
from ..documents import Edit
from .kept_replays import Replays
from .study import Pair, Study

CLAIM, READINGS = "claim", "readings"
"""Keys of edits that are no key of a claim: it is left out, or the text says what is meant."""


def edited(case: Case, edits: Iterable[Edit]) -> Case:
    """The case as it reads after edits.

    It counts as not read from a file.
    """
    claims = {claim.id: claim for claim in case.claims}
    readings = case.document.readings
    for edit in edits:
        if edit.claim is None:
            readings = tuple(one for one in readings if one.id in edit.becomes)
        elif edit.key == CLAIM:
            claims.pop(edit.claim, None)
        elif edit.claim in claims:
            claim = claims[edit.claim]
            value = _shaped(getattr(claim, edit.key), edit.becomes)
            claims[edit.claim] = claim.model_copy(update={edit.key: value})
    document = case.document.model_copy(
        update={"claims": tuple(claims.values()), "readings": readings}
    )
    return replace(case, document=document, sha256=None)


def printed_under(claim: AnyClaim, key: str) -> tuple[str, ...]:
    """What a claim prints under a key, number by number; its words where it is meant as a whole."""
    if key == CLAIM:
        return (claim.text,) if claim.text else ()
    return tuple(map(str, _flat(getattr(claim, key))))


def _flat(value: Any) -> list[Any]:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [one for part in value for one in _flat(part)]
    return [] if value is None else [value]


def _shaped(before: Any, digits: Sequence[str]) -> Any:
    """Digits in the shape of what stood there."""
    numbers = iter([Printed(one) for one in digits])
    if not isinstance(before, tuple):
        return next(numbers)
    if before and isinstance(before[0], tuple):
        return tuple(tuple(islice(numbers, len(row))) for row in before)
    return tuple(numbers)


class Reworded(Study):
    """A study of a changed case, which asks the original for what the change leaves alone.

    Parameters
    ----------
    case : Case
        The original's, with other claims, readings or algorithms.
    """

    def __init__(self, case: Case, original: Study, certify_seconds: float | None = None) -> None:
        reading = original.options.reading
        super().__init__(
            case,
            original.options,
            reading=reading if reading in {one.id for one in case.readings} else None,
            certify_seconds=certify_seconds,
            certificates=(),
            certificates_folder=None,
            cache=False,
        )
        self.original = original

    def optimum(self, pair: Pair, joint: str | None = None) -> Solution:
        """The original's, where it is the same question."""
        return self._asked(self._alike(pair)).optimum(pair, joint)

    def per_joint(self, pair: Pair) -> PerJointSolution:
        """The original's, where it is the same question to the same digits."""
        same = self._alike(pair) and self.half_digits(pair) == self.original.half_digits(pair)
        return self._asked(same).per_joint(pair)

    def relaxed(self, pair: Pair) -> Solution:
        """The original's, where it is the same question."""
        return self._asked(self._alike(pair)).relaxed(pair)

    def runs(self, algorithm_id: str, pair: Pair) -> Replays:
        """The original's, where the same algorithms search for the same."""
        return self._asked(self._replays_alike(pair)).runs(algorithm_id, pair)

    def spread_runs(self, algorithm_id: str, pair: Pair) -> dict[str, Replays]:
        """The original's, where the same algorithms search for the same."""
        return self._asked(self._replays_alike(pair)).spread_runs(algorithm_id, pair)

    @property
    def drawing(self) -> Study:
        """The original, where all problems and algorithms are the same."""
        same = self.pairs == self.original.pairs and self._replays_alike(*self.pairs)
        return self.original if same else self

    def _asked(self, same: bool) -> Study:
        """Who answers: the original what it answers alike, else this study as any other."""
        return self.original if same else cast(Study, super())

    def _alike(self, pair: Pair) -> bool:
        """Whether the changed case poses the very same problem, digit by digit."""
        if pair not in self.original.pairs:
            return False
        return self.once(("alike", pair), lambda: self._compared(pair))

    def _compared(self, pair: Pair) -> bool:
        one, other = (s.case.statement(*pair) for s in (self, self.original))
        exact = printed_problem_or_none(one, None) == printed_problem_or_none(other, None)
        return exact and pickle.dumps(one.problem()) == pickle.dumps(other.problem())

    def _replays_alike(self, *pairs: Pair) -> bool:
        mine, theirs = (
            (s.case.algorithms, s.case.document.families) for s in (self, self.original)
        )
        return mine == theirs and all(self._alike(pair) for pair in pairs)
