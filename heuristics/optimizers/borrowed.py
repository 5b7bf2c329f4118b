"""An optimiser that is not ours under our objective: what it is given, and what it must not do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from ...problem import Array, TrajgapError
from ..objective import Bounds, Objective
from ..settings import clean, positive, whole

_OUT_OF_CUBE = 1e-9
"""Share of a duration's range by which a position may leave it: libraries that map a unit cube
onto the bounds round there. It is set to the bound before it is judged."""


@dataclass(frozen=True, eq=False)
class BorrowedTask:
    """The task that is passed to an optimiser."""

    fun: Callable[[Array], Any]
    """Fitness, s: of one position, shape (dimensions,), as a float; of a batch, shape (batch,
    dimensions), as (batch,)."""
    box: Array
    """Shape (dimensions, 2). Least and largest value of each coordinate, finite, s."""
    budget: int
    """Number of positions that may be evaluated; the search is stopped at the next one."""
    rng: np.random.Generator
    """The only source of randomness; see `number` for libraries that take a number."""
    penalty: float
    """Fitness of an infeasible position, s."""

    @property
    def lower(self) -> Array:
        """Least value of each coordinate, shape (dimensions,)."""
        return self.box[:, 0]

    @property
    def upper(self) -> Array:
        """Largest value of each coordinate, shape (dimensions,)."""
        return self.box[:, 1]

    def draw(self, count: int) -> Array:
        """Draw positions uniformly, shape (count, dimensions)."""
        return self.rng.uniform(self.lower, self.upper, (count, len(self.box)))

    def number(self) -> int:
        """Draw a seed for a library that takes a whole number."""
        return int(self.rng.integers(1, 2**31 - 1))


class Guarded:
    """The objective as optimisers want it, which remembers the first thing that they do wrong.

    Parameters
    ----------
    kind : str
        Name of the optimiser, for messages.
    objective : callable
        Judges a batch.
    box : ndarray, shape (dimensions, 2)
    """

    def __init__(self, kind: str, objective: Objective, box: Array) -> None:
        self._kind, self._objective, self._box = kind, objective, box
        self._lower, self._upper = box[:, 0].copy(), box[:, 1].copy()
        self.fault: TrajgapError | None = None

    def __call__(self, positions: Any) -> Any:
        """Fitness of one position or of a batch.

        Raises
        ------
        TrajgapError
            If a position has the wrong shape, is not a number, or leaves the bounds.
        """
        if self.fault is not None:
            raise self.fault
        try:
            x = np.asarray(positions, dtype=np.float64)
        except (TypeError, ValueError):
            raise self._wrong("asked for the fitness of something that is not numeric") from None
        count = len(self._box)
        if x.ndim not in (1, 2) or x.shape[-1] != count:
            raise self._wrong(
                f"asked for the fitness of shape {x.shape}; give ({count},) or (batch, {count})"
            )
        batch = x[None] if x.ndim == 1 else x
        # Most positions are within; NaN is not, and what rounding moved out is looked at closely.
        if not ((batch >= self._lower) & (batch <= self._upper)).all():
            batch = self.held(batch, "asked for the fitness of")
        fitness = self._objective(batch)
        return float(fitness[0]) if x.ndim == 1 else fitness

    def held(self, x: Array, doing: str) -> Array:
        """Positions within the bounds, or an error that says where they leave them."""
        if np.isnan(x).any():
            raise self._wrong(f"{doing} NaN")
        lower, upper = self._box.T
        away = np.maximum(lower - x, x - upper)
        if (away > _OUT_OF_CUBE * (upper - lower)).any():
            at = int(np.argmax(away.max(axis=0)))
            value = x[int(np.argmax(away[:, at])), at]
            raise self._wrong(
                f"{doing} {value:g} s for duration {at + 1}, outside its bounds "
                f"{lower[at]:g} to {upper[at]:g} s"
            )
        return np.clip(x, lower, upper)

    def judge_answer(self, answer: object) -> None:
        """Look at what an optimiser returned, if that can be a position or a value at all.

        The answer that counts is the best position that was judged; a NaN or a position out of
        bounds still says that the optimiser went wrong.
        """
        value = getattr(answer, "x", answer)
        if isinstance(value, tuple) and value:
            value = value[0]
        if not isinstance(value, (list, float, int, np.ndarray, np.generic)):
            return
        try:
            x = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            return
        if np.isnan(x).any():
            raise self._wrong("returned NaN")
        if x.shape == (len(self._box),):
            self.held(x[None], "returned")

    def _wrong(self, said: str) -> TrajgapError:
        self.fault = TrajgapError(f"{self._kind}: {said}")
        return self.fault


@dataclass(frozen=True)
class Borrowed:
    """A search with its own loop that must follow the rules of `Guarded`.

    Unlike for the papers' algorithms, which are run as printed, a position out of bounds or with a
    NaN is a fault of the search and ends it with a message.
    """

    kind: str
    """Name of the search."""
    searching: Callable[[BorrowedTask], object]
    """``searching(task)``; picklable. Its return value is only checked for faults."""
    iterations: Annotated[int, whole(0)] = 5999
    """Blocks of evaluations after the first one."""
    per_iteration: Annotated[int, whole(1)] = 1
    """Evaluations that count as one iteration."""
    penalty: Annotated[float, positive()] = 1e6
    """Fitness of an infeasible position, s; finite, because many searches subtract."""
    options: Mapping[str, object] = field(default_factory=dict, hash=False)
    """Options that were passed to the search, for the record."""

    def __post_init__(self) -> None:
        clean(self)

    def search(self, bounds: Bounds, rng: np.random.Generator, objective: Objective) -> None:
        """Search until done or stopped.

        Raises
        ------
        TrajgapError
            If the bounds are infinite, or the search does what `Guarded` forbids.
        """
        box = np.stack([bounds.lower, bounds.upper], axis=1)
        if not np.isfinite(box).all():
            raise TrajgapError(f"{self.kind}: needs finite duration bounds; give the problem some")
        guarded = Guarded(self.kind, objective, box)
        budget = self.per_iteration * (self.iterations + 1)
        try:
            answer = self.searching(BorrowedTask(guarded, box.copy(), budget, rng, self.penalty))
        except Exception:
            # A library may wrap what the objective raised into an error of its own.
            if guarded.fault is not None:
                raise guarded.fault from None
            raise
        if guarded.fault is not None:
            raise guarded.fault
        guarded.judge_answer(answer)
