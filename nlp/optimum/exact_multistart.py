"""Answers of small problems without IPOPT: a wide search, then a descent from each basin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import Array, Problem, TrajgapError, check
from .clock import time_up
from .decided import kept, tolerated
from .descent import Descent, LogBox, descend
from .starts import SETTLED_SEGMENTS, equal_start
from .tracking import Local
from .wide_search import Basin, basins

ROUND = 1e-9
"""Relative room below a least duration, which rounding may take: the checker's tolerance."""
LEAST_SHARE = 1e-12
"""Of the usual duration: no search goes below, where float64 has lost the curve."""
MOST_TIMES = 1e12
"""The same upwards: where limits let a search drift, such as those that all but forbid one side,
durations would leave the range in which a curve has coefficients."""
UNEQUAL = 0.02
"""A duration below this share of the mean makes the tracked NLP slow and blunt: it counts in
durations, not in their logarithms."""
WIDTH = 3.0
"""Log durations by which starts anywhere differ from the usual ones: a factor of 20."""
AT_BOUND = 0.99
"""Share of an upper bound from which a duration counts as held by it."""
RESUMPTIONS = 8
"""Most descents that go on from the end of the best one: two or three suffice where any does."""
WORTHWHILE = 1e-9
"""Relative gain of a resumed descent from which the next one is tried."""


def searchable(problem: Problem) -> bool:
    """Whether the exact descents apply: a determined curve, few enough durations."""
    return not problem.curve.free and problem.segments <= SETTLED_SEGMENTS


def least_durations(problem: Problem) -> Array:
    """Durations, s, that no motion within the velocity limits undercuts; 0 where nothing says so.

    Between two way-points a joint covers |Δq|, which takes |Δq|/V at least.
    """
    least = np.array(problem.duration_lower)
    breaks = problem.curve.waypoint_breaks
    way = np.diff(problem.waypoints, axis=0)
    distance, sides = np.abs(way), problem.limits.sides[:, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        velocity = np.where(way > 0, sides[1], sides[0])
        needed = np.where(distance > 0, distance / velocity, 0.0).max(axis=1)
    for w, seconds in enumerate(needed):
        if breaks[w + 1] == breaks[w] + 1 and np.isfinite(seconds):
            least[breaks[w]] = max(least[breaks[w]], (1.0 - ROUND) * seconds)
    return least


def made_up(problem: Problem, share: float) -> Array:
    """A least duration of each segment, s, that a search makes up; 0 where a higher one is given.

    Parameters
    ----------
    problem : Problem
    share : float
        Of the mean of the usual durations, or of an upper bound where that is shorter: a floor
        above an upper bound would leave nothing to search.

    Returns
    -------
    ndarray, shape (segments,)
        0 where a bound or a velocity limit is higher.
    """
    usual = np.minimum(equal_start(problem).mean(), problem.duration_upper)
    return np.where(least_durations(problem) < share * usual, share * usual, 0.0)


def box_above(problem: Problem, floor: Array) -> LogBox:
    """Bounds on log durations: the problem's own, the least durations, and the floors."""
    usual = float(equal_start(problem).mean())
    least = LEAST_SHARE * np.minimum(usual, problem.duration_upper)
    low = np.maximum(np.maximum(least_durations(problem), floor), least)
    # A least duration above an upper bound leaves no motion; the box stays one for the search.
    high = np.maximum(np.minimum(problem.duration_upper, MOST_TIMES * usual), low)
    return LogBox(np.log(low), np.log(high))


def ordinary(problem: Problem, basin: Basin) -> bool:
    """Whether the tracked NLP is at its best: stretching repairs, durations are alike.

    It is not used where the two sides of limits differ. With a clock of its own a curve's jerk is a
    ratio of polynomials over t′⁵. On the coarse places IPOPT then often runs into its iteration
    limit, and the descents are several times as quick.
    """
    h = basin.durations
    curve = problem.curve
    clocked = curve.piecewise is None and curve.shape(problem.waypoints) is None
    return bool(
        basin.excess == 0.0
        and not problem.limits.uneven
        and not (clocked and np.isfinite(problem.limits.jerk).any())
        and problem.curve.homogeneous
        and not problem.limits.limits_position
        and (h >= UNEQUAL * h.mean()).all()
        and (h < AT_BOUND * problem.duration_upper).all()
    )


def as_local(problem: Problem, found: Descent) -> Local | None:
    """The end of a descent, judged by the checker; None where float64 has lost the curve.

    It has where a segment at a virtual break shrinks towards 0: the system is singular to rounding.
    """
    h = np.clip(found.durations, problem.duration_lower, problem.duration_upper)
    try:
        verdict = check(problem, h)
        if found.feasible and 1.0 < verdict.stretch < 1.0 + ROUND and problem.curve.homogeneous:
            h = np.clip(h * verdict.stretch, problem.duration_lower, problem.duration_upper)
            verdict = check(problem, h)
    except TrajgapError:
        return None
    return Local(h, None, float(h.sum()), found.converged, kept(problem, verdict), found.steps)


def exact_search(problem: Problem, points: Array, floor: Array) -> list[Local]:
    """Local optima of all starts, above the floors; starts that end together are kept apart."""
    box = box_above(problem, floor)
    found: list[Local] = []
    for start in points:
        if found and time_up():
            break
        local = as_local(problem, descend(problem, start, box))
        if local is not None:
            found.append(local)
    return _resumed(problem, found, box)


def _resumed(problem: Problem, found: list[Local], box: LogBox) -> list[Local]:
    """The ends of descents, the best one descended from again for as long as that gains.

    A descent may stop short where its Hessian, made along a bent valley, fits no longer; from its
    end a new one, with a new Hessian, goes on.
    """
    for _ in range(RESUMPTIONS):
        best = min(
            (i for i, local in enumerate(found) if local.feasible),
            key=lambda i: found[i].total,
            default=None,
        )
        if best is None or found[best].converged or time_up():
            break
        before = found[best]
        after = as_local(problem, descend(problem, before.durations, box))
        if after is None or not (after.feasible and after.total <= before.total):
            break
        found[best] = replace(after, iterations=before.iterations + after.iterations)
        if after.total > before.total * (1.0 - WORTHWHILE):
            break
    return found


def exact_starts(problem: Problem, count: int, seed: int, floor: Array) -> list[Basin]:
    """The best basins of a wide search above the floors."""
    generator = np.random.default_rng(seed)
    return basins(problem, equal_start(problem), box_above(problem, floor), count, generator)


def anywhere(problem: Problem, count: int, seed: int, floor: Array) -> Array:
    """Starts drawn over the box, up to `WIDTH` to both sides of the usual durations."""
    box, base = box_above(problem, floor), np.log(equal_start(problem))
    low = np.maximum(box.low, np.minimum(base, box.high) - WIDTH)
    high = np.minimum(box.high, np.maximum(base, box.low) + WIDTH)
    spread = np.random.default_rng(seed).uniform(0.0, 1.0, (count, problem.segments))
    return np.asarray(np.exp(low + spread * (high - low)))


def tolerated_search(problem: Problem, count: int, seed: int, share: float) -> list[Local]:
    """Searches where limits leave no room inside them, only the tolerance of the checker.

    So it is where a position range ends at the way-points, or bounds leave one duration vector. A
    descent needs room to move in: it is given half the tolerance, and `check` judges its end.
    """
    wide, floor = tolerated(problem), made_up(problem, share)
    points = [basin.durations for basin in exact_starts(wide, count, seed, floor)]
    ends = exact_search(wide, np.array(points), floor)
    return [replace(end, feasible=kept(problem, check(problem, end.durations))) for end in ends]
