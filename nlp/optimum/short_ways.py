"""Starts beside an answer where way-points nearly coincide: that segment much shorter still."""

from __future__ import annotations

import numpy as np

from ...problem import Array, Problem
from .descent import LogBox
from .exact_multistart import box_above
from .wide_search import basins

SHORT = 0.02
"""Largest way of a segment, in spans of each joint, at which its duration may have two optima that
lie decades apart: with random way-points all that were found had less than 1e-3."""
SHORTER = 3.0
"""Factor by which the segment is shorter in another basin: at least what two basins that the wide
search tells apart differ by."""
PROMISING = 1.05
"""Total of a start over the answer's from which it is left: a descent seldom gains as much."""


def short_ways(problem: Problem) -> list[int]:
    """Segments in which every joint moves by little of its span.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    list of int
        Segments; of curves with virtual breaks, only those between two neighbouring way-points.
    """
    span = np.ptp(problem.waypoints, axis=0)
    way = np.abs(np.diff(problem.waypoints, axis=0)) / np.where(span > 0, span, 1.0)
    breaks = problem.curve.waypoint_breaks
    return [
        breaks[w]
        for w in np.flatnonzero(way.max(axis=1) <= SHORT)
        if breaks[w + 1] == breaks[w] + 1
    ]


def shortened(problem: Problem, durations: Array, floor: Array, seed: int) -> Array:
    """For each short way, the best motion of a wide search in which that segment is much shorter.

    A wide search over the whole box seldom ends in such a basin: it is decades away in one
    duration, and a few per cent deep.

    Parameters
    ----------
    problem : Problem
    durations : ndarray, shape (segments,)
        The answer, s.
    floor : ndarray, shape (segments,)
        Least durations that are tried, s.
    seed : int

    Returns
    -------
    ndarray, shape (starts, segments)
        s; none where nothing comes near the answer.
    """
    found = []
    whole = box_above(problem, floor)
    most = PROMISING * float(durations.sum())
    for segment in short_ways(problem):
        high = np.maximum(np.minimum(whole.high, np.log(most)), whole.low)
        high[segment] = np.log(durations[segment] / SHORTER)
        if not high[segment] > whole.low[segment]:
            continue
        base = durations.copy()
        base[segment] = np.exp(0.5 * (whole.low[segment] + high[segment]))
        generator = np.random.default_rng(seed)
        best = basins(problem, base, LogBox(whole.low, high), 1, generator)[0]
        if best.excess == 0.0 and best.total < most:
            found.append(best.durations)
    return np.array(found).reshape(-1, problem.segments)


def moving_at_floor(problem: Problem, durations: Array, floor: Array) -> bool:
    """Whether a joint moves in a segment at its floor: the total rises again further down.

    Parameters
    ----------
    problem : Problem
    durations, floor : ndarray, shape (segments,)
        s.

    Returns
    -------
    bool
    """
    at = (floor > 0) & (durations <= 1.01 * floor)
    breaks = problem.curve.waypoint_breaks
    return any(
        at[b] and (problem.waypoints[w] != problem.waypoints[w + 1]).any()
        for w, b in enumerate(breaks[:-1])
    )
