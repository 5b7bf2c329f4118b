"""Answers for problems of some segments: the sparse search from the basins of a wide one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import Problem
from .asked import Ask
from .better import BETTER
from .clock import time_up
from .long_solve import covers, solve_long
from .long_start import way_start
from .solution import Solution, Status
from .wide_search import Basin

FROM = 9
"""Segments from which this is quicker: below, dense descents take a fraction of a second."""


def searched_sparsely(
    problem: Problem, ask: Ask, wide: list[Basin]
) -> tuple[Solution | None, bool]:
    """The answer of sparse searches, and whether no other search is needed.

    Parameters
    ----------
    problem : Problem
    ask : Ask
        Without starts of its own: durations after the ways of the segments are the first, basins
        are the others.
    wide : list of Basin
        Of a wide search.

    Returns
    -------
    answer : Solution or None
        *Converged* or *feasible*; None where there is none, or this search does not apply.
    settled : bool
        Whether it is an optimum, and no basin has a shorter motion that keeps the limits.
    """
    if problem.segments < FROM or not covers(problem, ask) or time_up():
        return None, False
    points = np.array([way_start(problem), *(basin.durations for basin in wide)])
    found = solve_long(problem, replace(ask, initial=points))
    if found is None or found.status not in (Status.CONVERGED, Status.FEASIBLE):
        return None, False
    shortest = min((basin.total for basin in wide if basin.excess <= 0.0), default=np.inf)
    missed = shortest < found.total_time * (1 - BETTER)
    return found, found.status is Status.CONVERGED and not missed
