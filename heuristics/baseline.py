"""The baseline without parameters: equal durations, stretched until a limit is reached."""

from __future__ import annotations

import numpy as np

from ..problem import Array, Problem, TrajgapError, Verdict, check, evaluate


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
