"""Equal durations, stretched until a limit is reached: a baseline, and a box for searches."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..problem import Array, Problem, TrajgapError, Verdict, check, evaluate
from .algorithm import Algorithm, Search
from .objective import Bounds


def uniform_rescaling(problem: Problem) -> Array:
    """Equal segment durations, as short as the limits allow.

    Stretching all durations by c divides velocity, acceleration and jerk by c, c², c³; so one
    evaluation of any equal durations gives the shortest ones. It needs no search and no random
    numbers: a heuristic must beat it to be worth its parameters.

    Returns
    -------
    ndarray, shape (segments,)
        In s; durations outside their bounds are set to the bounds, if that keeps every limit.

    Raises
    ------
    TrajgapError
        If ratios are fixed, no equal durations are shortest (nothing is limited, a joint with
        limit 0 moves, a prescribed derivative is not 0), or they leave the bounds and fail the
        check when set to them.
    """
    if problem.ratios is not None:
        raise TrajgapError(
            "uniform rescaling: the durations have fixed ratios; `solve` scales their total"
        )
    if not problem.curve.homogeneous:
        raise TrajgapError(
            "uniform rescaling: a prescribed derivative is not 0, and stretching would change it"
        )
    stretch = float(evaluate(problem, np.ones((1, problem.segments))).stretch[0])
    if not np.isfinite(stretch):
        raise TrajgapError(
            "uniform rescaling: a joint with limit 0 moves, which no stretch repairs"
        )
    equal = np.full(problem.segments, stretch)
    durations: Array = np.clip(equal, problem.duration_lower, problem.duration_upper)
    if not (durations > 0).all():
        raise TrajgapError(
            "uniform rescaling: nothing moves or nothing is limited, so the total can shrink to "
            "0; give positive lower duration bounds"
        )
    found = check(problem, durations)
    beyond = [p for p in found.peaks if p.quantity == "position" and p.ratio > 1 + found.tolerance]
    if beyond:
        raise TrajgapError(
            f"uniform rescaling: equal durations lead joint {beyond[0].joint} beyond a position "
            "limit, and no uniform stretch changes the path"
        )
    if found.verdict is not Verdict.PASS:
        clipped = " set to the duration bounds" if (durations != equal).any() else ""
        raise TrajgapError(
            f"uniform rescaling: {stretch:g} s per segment{clipped} is {found.verdict}; "
            "no uniform stretch repairs that"
        )
    return durations


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
