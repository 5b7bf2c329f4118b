"""Answers for problems of some segments: the sparse search from the basins of a wide one."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ...problem import Array, Problem
from .asked import Ask
from .clock import time_up
from .exact_multistart import exact_starts
from .long_solve import covers, solve_long
from .long_start import way_start
from .solution import Solution, Status

FROM = 9
"""Segments from which this is quicker: below, dense descents take a fraction of a second."""


def settled_sparsely(problem: Problem, ask: Ask, floor: Array) -> Solution | None:
    """The answer of sparse searches where it is an optimum above every floor, or None.

    Parameters
    ----------
    problem : Problem
    ask : Ask
        Without starts of its own.
    floor : ndarray, shape (segments,)
        Least durations of the wide search, s.

    Returns
    -------
    Solution or None
    """
    if problem.segments < FROM or not covers(problem, ask) or time_up():
        return None
    began = time.perf_counter()
    wide = exact_starts(problem, ask.starts - 1, ask.seed, floor)
    points = np.array([way_start(problem), *(basin.durations for basin in wide)])
    found = solve_long(problem, replace(ask, initial=points))
    if found is None or found.status is not Status.OPTIMAL:
        return None
    seconds = time.perf_counter() - began - found.build_seconds
    return replace(found, solve_seconds=seconds)
