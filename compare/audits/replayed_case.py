"""Replays of a case's algorithms, each computed once."""

from __future__ import annotations

import os
from typing import Any

from ...heuristics import (
    KINDS,
    Algorithm,
    DeathPenalty,
    JointRuns,
    Run,
    from_settings,
    run_many,
    run_many_per_joint,
)
from ...problem import Coupling, TrajgapError
from ..documents import capital
from .chosen_case import ChosenCase, Pair
from .replay_settings import LISTED, spread_settings
from .stated import in_words

Replays = tuple[Run, ...] | tuple[JointRuns, ...]
"""Runs of one algorithm, one for each seed: of all joints, or of each joint by itself."""
SPREAD_SEEDS = 3
"""Seeds under each of the spread settings, of which there are sixteen: enough to see a median
move across them."""
WORTH_PROCESSES = 50_000
"""Iterations of all seeds of a replay from which further processes pay: fewer take some seconds
side by side, and each process takes two to import what it needs."""


class ReplayedCase(ChosenCase):
    """A case with the replays of its algorithms."""

    def algorithm(self, algorithm_id: str) -> Algorithm[Any] | None:
        """The case's algorithm, or None if its kind is not implemented."""
        block = next(a for a in self.case.algorithms if a.id == algorithm_id)
        if block.kind is None or block.kind not in KINDS:
            return None
        try:
            return from_settings(block.kind, block.parameters)
        except TrajgapError as error:
            why = str(error).removeprefix(f"{block.kind}: ")
            raise TrajgapError(f"{self.case.file}: algorithms.{algorithm_id}: {why}") from None

    @property
    def not_replayed(self) -> tuple[str, ...]:
        """Algorithms without an implementation here, each as one sentence with the nearest kind."""
        found = []
        for block in self.case.algorithms:
            if block.kind is None:
                found.append(f"{block.name}: the case file names no algorithm that trajgap has.")
            elif block.kind not in KINDS:
                try:
                    from_settings(block.kind, {})
                except TrajgapError as error:
                    found.append(f"{block.name}: {error}")
        return tuple(found)

    def called(self, algorithm_id: str) -> str:
        """An algorithm as a sentence calls it, by its name."""
        return f"the {next(a.name for a in self.case.algorithms if a.id == algorithm_id)}"

    def unreplayed(self, algorithm_id: str, pair: Pair) -> str | None:
        """Why an algorithm is not replayed on a problem, as a sentence; None if it is."""
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None:
            return (
                f"{capital(self.called(algorithm_id))} is of a kind that is not implemented here."
            )
        problem = self.problem(pair)
        try:
            # What judges the positions of every run says whether it can.
            DeathPenalty(problem, algorithm.penalty)
        except TrajgapError as error:
            return f"{capital(self.called(algorithm_id))} is not replayed: {error}."
        return None

    def runs(self, algorithm_id: str, pair: Pair) -> Replays:
        """Replays of an algorithm under the listed choices, one per seed; empty if there are none.

        `unreplayed` says why.
        """
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None or self.unreplayed(algorithm_id, pair) is not None:
            return ()
        return self.once(
            ("runs", algorithm_id, pair),
            lambda: self._replay(algorithm, algorithm_id, pair, self.seeds),
        )

    def _replay(self, algorithm: Algorithm[Any], name: str, pair: Pair, seeds: int) -> Replays:
        problem = self.problem(pair)
        called = next((a.name for a in self.case.algorithms if a.id == name), name)
        under = in_words(self.case, *pair)
        self.progress(f"{seeds} replays of {called}; {under}")
        workers = self.workers
        if workers is None:
            long = seeds * algorithm.iterations >= WORTH_PROCESSES
            workers = (os.cpu_count() or 1) if long else 1
        if problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1:
            return run_many_per_joint(algorithm, problem, range(seeds), workers)
        return run_many(algorithm, problem, range(seeds), workers)

    def settings(self, algorithm_id: str) -> dict[str, Algorithm[Any]]:
        """The algorithm as listed, and under settings spread over all that the paper leaves open.

        `spread_settings` says how; empty where the algorithm's kind is not implemented.
        """
        algorithm = self.algorithm(algorithm_id)
        if algorithm is None:
            return {}
        block = next(a for a in self.case.algorithms if a.id == algorithm_id)
        return spread_settings(algorithm, block.settings)

    def spread_runs(self, algorithm_id: str, pair: Pair) -> dict[str, Replays]:
        """Replays under each of `settings`, fewer where it is not the listed one; as `runs`."""
        if self.unreplayed(algorithm_id, pair) is not None:
            return {}

        def compute() -> dict[str, Replays]:
            few = min(SPREAD_SEEDS, self.seeds)
            return {
                name: self.runs(algorithm_id, pair)
                if name == LISTED
                else self._replay(algorithm, f"{algorithm_id}, {name}", pair, few)
                for name, algorithm in self.settings(algorithm_id).items()
            }

        return self.once(("spread", algorithm_id, pair), compute)
