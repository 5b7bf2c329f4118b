"""The same optimum once more by the other route, to rule out an error of one program."""

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

    For a descent or a formula, the exact NLP solved by IPOPT; for the NLP, a descent. Both
    state the same limits, by different code: symbolic derivatives and multipliers on one side,
    exact extrema and their gradients on the other.

    Returns
    -------
    Solution
        With `other_total`, if the other route knows the curve and ends within the limits.
    """
    problem, h = solution.problem, solution.vector
    if h is None or solution.infimum is not None or problem.limits.braking.any():
        return solution
    start = np.clip(LONGER * h, problem.duration_lower, problem.duration_upper)
    floor = np.minimum(made_up(problem, FLOOR), 0.5 * h)
    if solution.route is not Route.NLP:
        found = [program_search(problem, start, floor, solution.nodal)]
    elif problem.curve.free or problem.segments > DENSE or problem.ratios is not None:
        return solution
    else:
        found = [*exact_search(problem, start[None], floor)]
    totals = [local.total for local in found if local is not None and local.feasible]
    return replace(solution, other_total=min(totals)) if totals else solution
