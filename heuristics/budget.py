"""Searches that own their loop: counted, watched, and stopped when the budget is spent."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ..problem import Array, TrajgapError
from .algorithm import Search
from .objective import Bounds, Objective, check_shape, nan_returned


class BudgetSpent(BaseException):
    """Ends a search whose evaluations are spent.

    Control flow, not an error: like ``GeneratorExit`` it passes every ``except Exception`` on the
    way out of a search that is not ours.
    """


class Budgeted:
    """An objective for searches that own their loop: it counts, remembers the best, and stops them.

    Parameters
    ----------
    objective : callable
        Maps positions, shape (batch, dimensions), to fitness, shape (batch,).
    budget : int
        Positions that may be judged.

    Attributes
    ----------
    judged : int
        Positions judged so far.
    best : ndarray or None, shape (dimensions,)
        The first position that attained it; None before anything was judged.
    refused : int
        Calls that asked for more than was left.
    """

    def __init__(self, objective: Objective, dimensions: int, budget: int) -> None:
        self._objective = objective
        self._dimensions = dimensions
        self._budget = budget
        # What was judged, in order; the best so far is worked out when somebody asks for it.
        # Room for more than a paper's budget at first; then for twice as many.
        self._fitness = np.empty(min(budget, 8192))
        self._least = np.inf
        self.judged = 0
        self.best: Array | None = None
        self.refused = 0

    @property
    def totals(self) -> Array:
        """Best fitness after each position judged so far, shape (judged,)."""
        least: Array = np.minimum.accumulate(self._fitness[: self.judged])
        return least

    def __call__(self, positions: Array) -> Array:
        """Fitness of a batch; of one that exceeds the budget only the first part is judged.

        Raises
        ------
        TrajgapError
            If the positions are not a batch of the right length, or the objective returns another
            shape than one value per position, or NaN.
        BudgetSpent
            If no evaluation is left for some position.
        """
        x = np.asarray(positions, dtype=np.float64)
        if x.ndim != 2 or x.shape[1] != self._dimensions:
            raise TrajgapError(
                f"objective: expected positions of shape (batch, {self._dimensions}), got "
                f"{x.shape}; pass a single one as x[None]"
            )
        count, begin = len(x), self.judged
        if begin + count > self._budget:
            if begin < self._budget:
                self(x[: self._budget - begin])
            self.refused += 1
            raise BudgetSpent
        if not count:
            return np.empty(0)
        # One frame from here on: this is run for every generation of every run.
        fitness = self._objective(x)
        if getattr(fitness, "shape", None) != (count,):
            check_shape(fitness, count)
        leader = fitness.argmin()  # the first NaN, if there is one
        least = float(fitness[leader])
        if not least >= self._least or self.best is None:
            if least != least:
                raise nan_returned()
            self.best, self._least = x[leader].copy(), least
        end = begin + count
        while end > self._fitness.size:
            self._fitness = np.concatenate([self._fitness, np.empty_like(self._fitness)])
        self._fitness[begin:end] = fitness
        self.judged = end
        return fitness


def searched(
    search: Search, objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> tuple[Array, Array, int]:
    """Trace, best position and number of evaluations of a search; it may end early.

    Raises
    ------
    TrajgapError
        If it evaluated nothing, or passed something that is not a batch of positions.
    """
    per, blocks = search.per_iteration, search.iterations + 1
    budgeted = Budgeted(objective, bounds.lower.size, per * blocks)
    with suppress(BudgetSpent):
        search.search(bounds, rng, budgeted)
    if budgeted.best is None:
        raise TrajgapError(
            f"{search.kind}: evaluated no position; call the objective that it is given"
        )
    judged = budgeted.judged
    ends = np.minimum(np.arange(1, blocks + 1) * per, judged) - 1
    return budgeted.totals[ends], budgeted.best, judged
