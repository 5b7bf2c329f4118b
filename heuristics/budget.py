"""Searches that own their loop: counted, watched, and stopped when the budget is spent."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from ..problem import Array, TrajgapError
from .algorithm import Search
from .objective import Bounds, Counted, Objective


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
    dimensions : int
    budget : int
        Positions that may be judged.

    Attributes
    ----------
    totals : list of float
        Best fitness after each position judged so far.
    best : ndarray or None, shape (dimensions,)
        The first position that attained it; None before anything was judged.
    """

    def __init__(self, objective: Objective, dimensions: int, budget: int) -> None:
        self._counted = Counted(objective)
        self._dimensions = dimensions
        self._budget = budget
        self.totals: list[float] = []
        self.best: Array | None = None

    def __call__(self, positions: Array) -> Array:
        """Fitness of a batch; of one that exceeds the budget only the first part is judged.

        Raises
        ------
        TrajgapError
            If the positions are not a batch of the right length.
        BudgetSpent
            If no evaluation is left for some position.
        """
        x = np.asarray(positions, dtype=np.float64)
        if x.ndim != 2 or x.shape[1] != self._dimensions:
            raise TrajgapError(
                f"objective: expected positions of shape (batch, {self._dimensions}), got "
                f"{x.shape}; pass a single one as x[None]"
            )
        left = self._budget - len(self.totals)
        fitness = self._counted(x[:left]) if left else np.empty(0)
        if fitness.size:
            leader = int(np.argmin(fitness))
            least = self.totals[-1] if self.totals else np.inf
            if self.best is None or fitness[leader] < least:
                self.best = x[leader].copy()
            self.totals += np.minimum(np.minimum.accumulate(fitness), least).tolist()
        if len(x) > left:
            raise BudgetSpent
        return fitness


def searched(
    search: Search, objective: Objective, bounds: Bounds, rng: np.random.Generator
) -> tuple[Array, Array, int]:
    """Trace, best position and number of evaluations of a search; it may end early.

    Raises
    ------
    TrajgapError
        If it judged nothing, or handed over something that is no batch of positions.
    """
    per, blocks = search.per_iteration, search.iterations + 1
    budgeted = Budgeted(objective, bounds.lower.size, per * blocks)
    with suppress(BudgetSpent):
        search.search(bounds, rng, budgeted)
    if budgeted.best is None:
        raise TrajgapError(
            f"{search.kind}: judged no position; call the objective that it is given"
        )
    judged = len(budgeted.totals)
    ends = np.minimum(np.arange(1, blocks + 1) * per, judged) - 1
    return np.array(budgeted.totals)[ends], budgeted.best, judged
