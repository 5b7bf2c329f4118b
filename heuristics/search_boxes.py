"""The finite box in which searches that need one look for durations."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..problem import Problem, TrajgapError
from .algorithm import Algorithm, Search
from .baseline import uniform_rescaling
from .objective import Bounds


def looked_in(method: Algorithm[Any] | Search, problem: Problem) -> Bounds:
    """Where a method looks: algorithms of papers, run as printed, within stated bounds alone."""
    return search_box(problem) if isinstance(method, Search) else Bounds.of(problem)


def search_box(problem: Problem) -> Bounds:
    """Duration bounds of a problem, with finite bounds instead of missing ones.

    Equal durations, stretched until they keep every limit, have some total T; no segment of a
    shorter motion takes T or longer. So T bounds every duration and excludes no optimum. It limits
    the search, not what is admissible: a vector that is stretched beyond it still counts.

    Raises
    ------
    TrajgapError
        If no equal durations keep the limits.
    """
    if np.isfinite(problem.duration_upper).all():
        return Bounds.of(problem)
    try:
        total = float(uniform_rescaling(problem).sum())
    except TrajgapError as error:
        raise TrajgapError(
            f"durations: have no upper bound and none can be derived ({error}); give them one"
        ) from None
    # Three significant digits, rounded up, so the bound still holds.
    scale = 10.0 ** (math.floor(math.log10(total)) - 2)
    bound = round(math.ceil(total / scale) * scale, 9)
    return Bounds(problem.duration_lower, np.minimum(problem.duration_upper, bound))
