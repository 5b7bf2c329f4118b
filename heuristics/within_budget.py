"""One search within a budget of evaluations, whatever it counts itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..problem import Array, Problem, TrajgapError
from .algorithm import Algorithm, Search
from .baseline import looked_in
from .budget import Budgeted, BudgetSpent
from .loop import states
from .repair import Handling, judge_of
from .settings import COUNT, SEED, checked
from .time_limit import TimeSpent, time_limit


@dataclass(frozen=True, eq=False)
class BudgetedRun:
    """The result of one search within its budget, as recorded by the objective."""

    durations: Array
    """Shape (segments,). Durations of the best position evaluated, s; with a stretch, those that it
    represents."""
    reported_time: float
    """Its fitness, s; inf if no feasible vector was evaluated."""
    totals: Array
    """Shape (evaluations,). Best fitness after each evaluation, s; inf before anything feasible was
    judged."""

    @property
    def evaluations(self) -> int:
        """Positions that were judged."""
        return self.totals.size


def run_within(
    method: Algorithm[Any] | Search,
    problem: Problem,
    seed: int,
    budget: int,
    objective: str = Handling.DEATH_PENALTY,
    seconds: float | None = None,
    stream: tuple[int, ...] = (),
) -> BudgetedRun:
    """Search until the method ends or its budget is spent.

    The objective counts evaluations: a method cannot exceed its budget, and its answer is the best
    position that was evaluated, whatever it reports.

    Parameters
    ----------
    method : Algorithm or Search
        From `find_optimizer`, for the same budget.
    problem : Problem
        All joints share one duration vector. If it states no upper bound, a search with its own
        loop is restricted to `search_box`.
    budget : int
        Evaluations.
    objective : str
        "death-penalty", "stretch" or "rescale", see `Handling`.
    seconds : float, optional
        Interrupts a search that takes longer; see `time_limit`.
    stream : tuple of int
        Spawn key under the seed; (j,) is what `run_per_joint` gives to joint j.

    Raises
    ------
    TrajgapError
        If the objective cannot judge the problem, or the search evaluated nothing, continued after
        its budget was spent, or took too long.

    Examples
    --------
    >>> from trajgap.heuristics import find_optimizer
    >>> from trajgap.problem import Limits, Problem, three_five_three
    >>> waypoints = [[0.1], [0.7], [1.2], [0.9]]
    >>> problem = Problem(waypoints, Limits(6.0, 8.0), three_five_three(), 0.1, 3.0)
    >>> found = run_within(find_optimizer("random", 500), problem, seed=1, budget=500)
    >>> found.evaluations, len(found.totals)
    (500, 500)
    """
    budget = checked(COUNT, "budget", budget)
    judge = judge_of(problem, method.penalty, objective)
    bounds = looked_in(method, problem)
    # The same stream as `run`: the same seed gives the same search.
    sequence = np.random.SeedSequence(checked(SEED, "seed", seed), spawn_key=stream)
    rng = np.random.Generator(np.random.PCG64(sequence))
    budgeted = Budgeted(judge, problem.segments, budget)
    try:
        with time_limit(seconds):
            if isinstance(method, Search):
                method.search(bounds, rng, budgeted)
            else:
                for _ in states(method, budgeted, bounds, rng):
                    pass
    except BudgetSpent:
        pass
    except TimeSpent:
        raise TrajgapError(
            f"{method.kind}: took longer than {seconds:g} s; raise the time limit, or find where "
            "it hangs"
        ) from None
    if budgeted.refused > 1:
        raise TrajgapError(
            f"{method.kind}: continued after its budget of {budget} evaluations was spent; do not "
            "catch the exception of the objective"
        )
    if budgeted.best is None:
        raise TrajgapError(
            f"{method.kind}: evaluated no position; call the function that it is given"
        )
    totals = budgeted.totals
    totals[totals >= method.penalty] = np.inf
    return BudgetedRun(
        durations=judge.decode(budgeted.best[None])[0],
        reported_time=float(totals[-1]),
        totals=totals,
    )
