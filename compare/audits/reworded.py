"""A case whose claims read otherwise: what its problems alone decide is known from the original."""

from __future__ import annotations

import pickle
from typing import Any

from ...nlp import PerJointSolution, Solution, printed_problem_or_none
from ...problem import Case
from ...problem.cases import InstancesBlock
from .chosen_case import Pair
from .instances import InstancesResult
from .replayed_case import Replays
from .study import Study


class Reworded(Study):
    """A study of a changed case, which asks the original for what the change leaves alone.

    Parameters
    ----------
    case : Case
        The original's, with other claims, readings or algorithms.
    original : Study
    certify_seconds : float or None
        As in `Study`.
    """

    def __init__(self, case: Case, original: Study, certify_seconds: float | None = None) -> None:
        chosen = original.chosen["reading"]
        super().__init__(
            case,
            seeds=original.seeds,
            workers=original.workers,
            problem=original.chosen["problem"],
            reading=chosen if chosen in {one.id for one in case.readings} else None,
            progress=original._progress,
            certify_seconds=certify_seconds,
        )
        self.original = original

    def optimum(self, pid: str, rid: str, joint: str | None = None) -> Solution:
        """The original's, where it is the same question."""
        if self._alike(pid, rid):
            return self.original.optimum(pid, rid, joint)
        return super().optimum(pid, rid, joint)

    def per_joint(self, pid: str, rid: str) -> PerJointSolution:
        """The original's, where it is the same question to the same digits."""
        same = self._alike(pid, rid) and self.half_digits(pid, rid) == self.original.half_digits(
            pid, rid
        )
        return self.original.per_joint(pid, rid) if same else super().per_joint(pid, rid)

    def relaxed(self, pid: str, rid: str) -> Solution:
        """The original's, where it is the same question."""
        same = self._alike(pid, rid)
        return self.original.relaxed(pid, rid) if same else super().relaxed(pid, rid)

    def runs(self, algorithm_id: str, pid: str, rid: str) -> Replays:
        """The original's, where the same algorithms search for the same."""
        same = self._replays_alike((pid, rid))
        return (
            self.original.runs(algorithm_id, pid, rid)
            if same
            else super().runs(algorithm_id, pid, rid)
        )

    def spread_runs(self, algorithm_id: str, pid: str, rid: str) -> dict[str, Replays]:
        """The original's, where the same algorithms search for the same."""
        same = self._replays_alike((pid, rid))
        return (
            self.original.spread_runs(algorithm_id, pid, rid)
            if same
            else super().spread_runs(algorithm_id, pid, rid)
        )

    def instances(self, block: InstancesBlock) -> InstancesResult:
        """The original's, where all problems and algorithms are the same."""
        same = self.pairs == self.original.pairs and self._replays_alike(*self.pairs)
        return self.original.instances(block) if same else super().instances(block)

    def _alike(self, pid: str, rid: str) -> bool:
        """Whether the changed case poses the very same problem, digit by digit."""
        if (pid, rid) not in self.original.pairs:
            return False
        return self.once(("alike", pid, rid), lambda: self._compared(pid, rid))

    def _compared(self, pid: str, rid: str) -> bool:
        one, other = (s.case.statement(pid, rid) for s in (self, self.original))
        exact = printed_problem_or_none(one, None) == printed_problem_or_none(other, None)
        return exact and pickle.dumps(one.problem()) == pickle.dumps(other.problem())

    def _replays_alike(self, *pairs: Pair) -> bool:
        mine, theirs = (_replayed(s.case) for s in (self, self.original))
        return mine == theirs and all(self._alike(*pair) for pair in pairs)


def _replayed(case: Case) -> tuple[Any, ...]:
    return case.algorithms, case.document.families
