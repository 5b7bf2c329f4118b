"""What the loop asks of an algorithm and of its state."""

from __future__ import annotations

from typing import Protocol, TypeVar, runtime_checkable

import numpy as np

from ..problem import Array
from .objective import Bounds, Objective


class State(Protocol):
    """Attributes that the loop reads from every algorithm's state."""

    @property
    def best(self) -> Array:
        """Best position so far, shape (dimensions,)."""

    @property
    def best_fitness(self) -> float:
        """Its fitness."""


S = TypeVar("S", bound=State)


class Algorithm(Protocol[S]):
    """A frozen record of settings that starts a search and advances it."""

    @property
    def kind(self) -> str:
        """Name of the algorithm, by which case files call it."""

    @property
    def open_choices(self) -> tuple[str, ...]:
        """What the paper leaves open, and what was chosen."""

    @property
    def iterations(self) -> int:
        """Steps to make."""

    @property
    def penalty(self) -> float:
        """Fitness of an infeasible position."""

    def init(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> S:
        """Start a search and return its first, evaluated state."""

    def step(
        self, state: S, bounds: Bounds, rng: np.random.Generator, objective: Objective, /
    ) -> S:
        """Advance the search by one iteration."""


@runtime_checkable
class Search(Protocol):
    """A frozen record of settings for a search with its own loop, such as a library's."""

    @property
    def kind(self) -> str:
        """Name of the search."""

    @property
    def iterations(self) -> int:
        """Blocks of ``per_iteration`` evaluations after the first one."""

    @property
    def per_iteration(self) -> int:
        """Evaluations that count as one iteration."""

    @property
    def penalty(self) -> float:
        """Fitness of an infeasible position."""

    def search(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> None:
        """Search until done or until the objective stops it; only evaluated positions count."""
