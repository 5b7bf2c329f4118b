"""Starts beside an answer where way-points nearly coincide: that segment much shorter still."""

from __future__ import annotations

import math

import numpy as np

from ...problem import Array, Problem
from .basins import APART, basins
from .descent import KEPT, restored
from .starts import LogBox, box_above, equal_start

SHORT = 0.02
"""Largest way of a segment, in what each joint covers in all, at which its duration may have two
optima that lie decades apart: with random way-points all that were found had less than 1e-3."""
SHORTER = 3.0
"""Factor by which the segment is shorter in another basin: at least what two basins that the wide
search tells apart differ by."""
PROMISING = 1.05
"""Total of a start over the answer's from which it is left: a descent seldom gains as much."""

BAND = math.log(10.0)
"""Log durations of the short segment that one search looks at: over the whole range a search falls
for the wide basins, where the limits that it keeps may leave a ten thousandth of a band."""


def _reaches(problem: Problem) -> Array:
    """What each joint covers: the span of its way-points, or what its prescribed ends bring it to.

    A joint that is in motion at an end covers |q⁽ʳ⁾|·hʳ/r! of the segment there, of the usual
    duration h.
    """
    curve, way = problem.curve, np.ptp(problem.waypoints, axis=0)
    usual = equal_start(problem)
    for b, h in ((0, usual[0]), (curve.segments, usual[-1])):
        for r, value in curve.prescribed_at(b):
            way = np.maximum(way, np.abs(np.asarray(value)) * h**r / math.factorial(r))
    return np.where(way > 0, way, 1.0)


def short_ways(problem: Problem) -> list[int]:
    """Segments in which every joint moves by little of what it covers in all.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    list of int
        Segments; of curves with virtual breaks, only those between two neighbouring way-points.
    """
    way = np.abs(np.diff(problem.waypoints, axis=0)) / _reaches(problem)
    breaks = problem.curve.waypoint_breaks
    return [
        breaks[w]
        for w in np.flatnonzero(way.max(axis=1) <= SHORT)
        if breaks[w + 1] == breaks[w] + 1
    ]


def shortened(problem: Problem, durations: Array, floor: Array, seed: int) -> Array:
    """For each short way, the best motions of wide searches in which that segment is much shorter.

    A wide search over the whole box seldom ends in such a basin: it is decades away in one
    duration, and a few per cent deep. So there is one over the shorter durations, and one in each
    decade of them; what does not keep the limits at its end is brought to them.

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
        kept: list[Array] = []
        boxes = _boxes(whole, segment, math.log(durations[segment] / SHORTER), most)
        for k, box in enumerate(boxes):
            base = durations.copy()
            base[segment] = np.exp(0.5 * (box.low[segment] + box.high[segment]))
            best = basins(problem, base, box, 1, np.random.default_rng(seed))[0]
            if best.excess > 0.0:
                # Nothing was minimised but the excess: how long the basin's bottom is, is not
                # known before the descent.
                rows = restored(problem, best.durations, box)
                if rows.worst <= KEPT:
                    found.append(rows.durations)
            elif best.total < most:
                (kept if k else found).append(best.durations)
        if kept:
            found.append(min(kept, key=lambda h: float(h.sum())))
    apart: list[Array] = []
    for h in found:
        if all(np.abs(np.log(h / other)).max() > APART for other in apart):
            apart.append(h)
    return np.array(apart).reshape(-1, problem.segments)


def _boxes(whole: LogBox, segment: int, top: float, most: float) -> list[LogBox]:
    """The box with the segment's log duration below ``top``, as a whole and by bands."""
    high = np.maximum(np.minimum(whole.high, math.log(most)), whole.low)
    least = whole.low[segment]
    sides = [(least, top)] if top > least else []
    while top > least:
        sides.append((max(least, top - BAND), top))
        top -= BAND
    boxes = []
    for below, above in sides:
        box = LogBox(whole.low.copy(), high.copy())
        box.low[segment], box.high[segment] = below, above
        boxes.append(box)
    return boxes


def moving_at_floor(problem: Problem, durations: Array, floor: Array) -> bool:
    """Whether a segment at its floor has something below it: a motion, or a bound.

    Where a joint moves the total rises again further down; a bound that is given ends it.

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
    if (at & (problem.duration_lower > 0)).any():
        return True
    breaks = problem.curve.waypoint_breaks
    return any(
        at[b] and (problem.waypoints[w] != problem.waypoints[w + 1]).any()
        for w, b in enumerate(breaks[:-1])
    )
