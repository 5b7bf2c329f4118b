"""What a search leaves behind: its answer untouched, its trace, its seed and settings."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ..problem import Array
from .algorithm import Algorithm, Search
from .repair import Handling


def _rebuilt(record: Run | JointRuns) -> tuple[Any, ...]:
    """How pickle makes a record again: by its constructor, which makes the arrays read-only."""
    return type(record), tuple(getattr(record, field.name) for field in fields(record))


@dataclass(frozen=True, eq=False)
class Run:
    """One search and its answer, untouched."""

    algorithm: str
    """Kind of the algorithm."""
    settings: Algorithm[Any] | Search
    """The settings that were used, with the number of iterations that were run."""
    problem: str
    """Name of the problem."""
    seed: int
    stream: tuple[int, ...]
    """Spawn key of the random stream under the seed; empty for the seed's own."""
    durations: Array
    """Shape (segments,). Best segment durations as the algorithm found them, s; with a stretch,
    those that its best position represents."""
    reported_time: float
    """What the algorithm reports, Σ t by its own objective, s; inf if nothing feasible was
    found."""
    trace: Array
    """Shape (iterations + 1,). Best total so far after the initial swarm and after each iteration,
    s; inf before anything feasible was found."""
    evaluations: int
    """Duration vectors judged by the objective."""
    iterations: int
    feasible: bool
    """Whether the algorithm's own objective found a feasible vector. `trajgap.problem.check`
    remains the only judge of the answer."""
    objective: Handling
    """Treatment of vectors that break a limit."""
    position: Array
    """Shape (segments,). Best position as searched, s; it differs from the durations only with a
    stretch."""

    def __post_init__(self) -> None:
        for array in (self.durations, self.trace, self.position):
            array.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt(self)

    def __str__(self) -> str:
        stream = "".join(f".{key}" for key in self.stream)
        found = f"{self.reported_time:.6f} s" if self.feasible else "nothing feasible found"
        return (
            f"{self.algorithm} on {self.problem}, seed {self.seed}{stream}: {found}\n"
            f"durations       {np.array2string(self.durations, precision=6)} s\n"
            f"budget          {self.iterations} iterations, {self.evaluations} evaluations"
        )


@dataclass(frozen=True, eq=False)
class JointRuns:
    """Separate searches of the joints; every segment then takes the longest of their durations."""

    algorithm: str
    problem: str
    seed: int
    runs: tuple[Run, ...]
    durations: Array
    """Shape (segments,). Longest duration of each segment, s."""
    reported_time: float
    """Their sum, s; inf if some joint found nothing feasible."""
    feasible: bool
    """Whether every joint found something feasible. This does not hold for the longest durations: a
    joint that keeps its limits with its own durations may break them with longer ones."""

    def __post_init__(self) -> None:
        self.durations.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt(self)

    def __str__(self) -> str:
        found = f"{self.reported_time:.6f} s" if self.feasible else "some joint found nothing"
        return (
            f"{self.algorithm} on {self.problem}, each joint separately, seed {self.seed}: "
            f"{found}\n"
            f"durations       {np.array2string(self.durations, precision=6)} s (longest)"
        )
