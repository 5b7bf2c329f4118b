"""The same optimum once more by the other route: what two programs agree on is no slip of one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .basins import exact_search
from .rounds import program_search
from .solution import Route, Solution
from .starts import DENSE, made_up

LONGER = 1.1
"""Times as long as the answer at which the other route begins: far enough that every limit has room
and nothing of the first search is left, near enough for the same basin."""
FLOOR = 1e-4
"""Least duration of that search, in shares of the mean of equal ones."""


def with_other_route(solution: Solution) -> Solution:
    """The answer with the total that the other route reaches from a longer motion beside it.

    The exact NLP, solved by IPOPT, beside a descent or a formula; a descent beside the NLP. Both
    state the same limits, by different code: symbolic derivatives and multipliers on one side,
    exact extrema and their gradients on the other.

    Parameters
    ----------
    solution : Solution

    Returns
    -------
    Solution
        With `other_total`, where the other route knows the curve and ends within the limits.
    """
    if not solution.found or solution.infimum is not None:
        return solution
    total = _descended(solution) if solution.route is Route.NLP else _programmed(solution)
    return solution if total is None else replace(solution, other_total=total)


def _programmed(solution: Solution) -> float | None:
    problem, h = solution.problem, solution.durations
    assert h is not None
    start = np.clip(LONGER * h, problem.duration_lower, problem.duration_upper)
    floor = np.minimum(made_up(problem, FLOOR), 0.5 * h)
    local = program_search(problem, start, floor, solution.nodal)
    return local.total if local is not None and local.feasible else None


def _descended(solution: Solution) -> float | None:
    problem, h = solution.problem, solution.durations
    assert h is not None
    if problem.curve.free or problem.segments > DENSE or problem.ratios is not None:
        return None
    start = np.clip(LONGER * h, problem.duration_lower, problem.duration_upper)
    floor = np.minimum(made_up(problem, FLOOR), 0.5 * h)
    found = [local for local in exact_search(problem, start[None], floor) if local.feasible]
    return min((local.total for local in found), default=None)
