"""Answers of small problems by Newton descents on the exact extrema, in milliseconds.

In front of the other ways of `solve`: what does not settle here, to the same conditions that judge
every other answer, goes to them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...problem import Array, Interpolant, Problem, Verdict, check
from ...problem.curves import PERM, layout
from . import newton_kernel as kernel
from .clock import seconds_left
from .exact_multistart import LEAST_SHARE, least_durations
from .optimality import kkt
from .solution import Solution, Status

MOST_SEGMENTS, MOST_UNKNOWNS = 8, 48
"""Sizes up to which dense algebra in one call beats everything else."""
DESCENTS = 3
"""Descents for each start that is asked for: one costs a hundredth of a solve by IPOPT."""
MEMBERS = 24
"""Places for each segment that are looked at for starts."""
MANY = 4
"""Times as many where a limit on positions or a bound may cut the box into parts."""
USUAL, WIDE, SHRUNKEN = 2.3, 7.0, 0.25
"""Spread of those places as in `wide_search.basins`: a factor of 10, of 1,000, and how often a
segment of a wide one is at its least duration."""
APART = 0.3
"""Log durations by which two starts differ at least."""
AT_FLOOR = 1.01
"""A duration below this multiple of a floor that the search made up has gone to it."""
BETTER = 1e-9
"""Relative gain by which a descent that did not converge puts the others in doubt."""
PART = 24
"""Places that one call looks at; a call costs as much as one place."""
PROVEN = 1e-6
"""Relative distance from a proved lower bound at which a total is no longer challenged: the shipped
certificates leave 9e-7 open, which further descents would not tell apart from the optimum."""
FARTHEST = 25.0
"""Log durations above the usual ones at which every search ends: powers of them stay in range."""
LIMIT = 1e-8
"""KKT residual up to which an answer is taken: that of `judgement.KKT_TOLERANCE`."""
DESCENT = 20.0
"""Places that a descent costs: measured 9 to 22. Where so much is not left, none is begun."""
_descents = kernel.descents
"""The descents; compiling them takes ten seconds, interpreting them a tenth to a half of one."""


@dataclass(frozen=True, eq=False)
class _Plan:
    """What the kernel needs to know of a declaration."""

    rows: tuple[NDArray[np.int64], ...]
    smooth: NDArray[np.int64]
    unknowns: int


@lru_cache(maxsize=64)
def _plan(curve: Interpolant) -> _Plan:
    system = layout(curve)
    inner = [curve.smooth_order(b) for b in range(1, curve.segments)]
    rows = (system.kinds, system.breaks, system.orders, system.degrees, system.column)
    return _Plan(rows, np.array([-1, *inner, -1], dtype=np.int64), max(system.unknowns, 1))


def covered(problem: Problem) -> bool:
    """Whether the descents of this module apply to a problem.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    bool
        True for determined polynomials with few segments whose motions may be stretched in time,
        and of which every joint may move.
    """
    curve = problem.curve.piecewise
    if curve is None or curve.free or curve.segments > MOST_SEGMENTS or not curve.homogeneous:
        return False
    if problem.limits.uneven:
        return False
    limits = problem.limits.derivatives
    bounded = bool(
        (np.isfinite(limits).any(axis=1) & (np.ptp(problem.waypoints, axis=0) > 0)).any()
    )
    return bounded and bool((limits > 0).all()) and _plan(curve).unknowns <= MOST_UNKNOWNS


class Descents:
    """The compiled descents of one problem, with their room."""

    def __init__(self, problem: Problem) -> None:
        self.place_seconds = 0.0
        """What the last place took, where the time is limited."""
        curve = problem.piecewise
        plan = _plan(curve)
        n, joints = curve.segments, problem.waypoints.shape[1]
        limits = problem.limits.derivatives
        with np.errstate(divide="ignore"):
            inverse = np.where(np.isfinite(limits), 1.0 / limits, 0.0)
        span = np.ptp(problem.waypoints, axis=0)
        first = problem.waypoints[0]
        ranges = np.stack(
            [problem.limits.position_lower - first, problem.limits.position_upper - first]
        )
        unknowns, powers = plan.unknowns, PERM.shape[0]
        size, most = n + 1, 4 * joints * n * powers
        walls = most + 2 * n + 1
        self.arrays = (
            curve.motion_values(problem.waypoints),
            *plan.rows,
            plan.smooth,
            inverse,
            ranges,
            np.where(span > 0, span, 1.0),
            PERM,
            _room(n, joints, unknowns, most),
            _room(n, joints, unknowns, most),
            np.empty((unknowns, 2 * unknowns)),
            np.empty((unknowns, size * joints)),
            np.empty((15, max(powers + 2, unknowns))),
            np.empty((walls, size)),
            np.empty(walls),
            np.empty(walls),
            np.zeros((8, size, size)),
            np.zeros((12, size)),
            np.empty(size, dtype=np.int64),
        )

    def run(self, starts: Array, low: Array, high: Array, steps: int) -> tuple[Array, Array]:
        """Ends of descents from log durations, and how they ended: see `newton_kernel.descents`.

        They are called in parts, so that the clock is looked at, and a kernel that proves worth
        compiling is compiled, between them. What would not end within the time limit has no end.
        """
        ends, found = starts.copy(), np.full((len(starts), 4), np.inf)
        found[:, 0] = kernel.STALLED
        limited = seconds_left() < np.inf
        stop, longest = 0, DESCENT * self.place_seconds if steps > 0 else 0.0
        while stop < len(starts):
            left = seconds_left() if limited else np.inf
            if (stop > 0 and left <= 0.0) or left < longest:
                break
            # Interpreted, a place costs milliseconds, and the clock is looked at after each.
            slow = steps > 0 or limited
            begin, stop = stop, min(stop + (1 if slow else PART), len(starts))
            _descents(starts, begin, stop, steps, low, high, *self.arrays, ends, found)
            if limited and steps > 0:
                longest = max(longest, left - seconds_left())
            elif limited:
                self.place_seconds = (left - seconds_left()) / (stop - begin)
        return ends, found


def _room(n: int, joints: int, unknowns: int, most: int) -> tuple[NDArray[Any], ...]:
    """Room for what is known of one place: the curve, its slopes, and its rows."""
    powers = PERM.shape[0]
    return (
        np.zeros((n, powers, joints)),
        np.zeros((n, n, powers, joints)),
        np.zeros((unknowns, unknowns)),
        np.empty(most),
        np.empty((most, n)),
        np.empty(most),
        np.empty((most, 5), dtype=np.int64),
    )


def _places(
    usual: Array, low: Array, high: Array, count: int, generator: np.random.Generator
) -> Array:
    """Log durations all over the box, most of them near the usual ones."""
    n = usual.size
    z = usual + USUAL * generator.uniform(-1.0, 1.0, (count, n))
    wide = count // 3
    z[:wide] = usual + WIDE * generator.uniform(-1.0, 0.3, (wide, n))
    shrunken = generator.random((wide, n)) < SHRUNKEN
    z[:wide] = np.where(shrunken, low, z[:wide])
    narrow = high - low < 2.0 * USUAL
    if narrow.any():
        spread = generator.uniform(0.0, 1.0, (count, int(narrow.sum())))
        z[:, narrow] = low[narrow] + spread * (high - low)[narrow]
    return z


def _chosen(first: Array, ends: Array, found: Array, count: int) -> Array:
    """The usual durations, then the best places that differ from each other."""
    worth = found[:, 3] + 10.0 * np.maximum(found[:, 1], 0.0)
    order = np.argsort(worth, kind="stable")
    points = np.vstack([first, ends[order[np.isfinite(worth[order])]]])
    near = np.abs(points[:, None] - points).max(axis=2) <= APART
    chosen = [0]
    free = ~near[0]
    while len(chosen) < count and free.any():
        chosen.append(int(np.argmax(free)))
        free &= ~near[chosen[-1]]
    return np.asarray(points[chosen])


def _totals(found: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Totals of the ends that keep the limits, else infinite, and which descents converged."""
    totals = np.where(found[:, 1] <= kernel.KEPT, np.exp(found[:, 3]), np.inf)
    return totals, found[:, 0] == kernel.CONVERGED


def settled_quickly(
    problem: Problem,
    starts: int,
    seed: int,
    share: float,
    lower: float = 0.0,
) -> Solution | None:
    """The answer of a small problem if every sign says that it is one, or None.

    Parameters
    ----------
    problem : Problem
    starts : int
        As in `solve`.
    seed : int
    share : float
        Floor of the durations, relative to the mean of the usual ones.
    lower : float
        A proved lower bound of the total, s.

    Returns
    -------
    Solution or None
        None unless the shortest end of all descents converged, lies above every floor, keeps the
        limits for all t, and meets the optimality conditions.
    """
    if not covered(problem):
        return None
    n = problem.segments
    descents = Descents(problem)
    everywhere = np.full(n, np.inf)
    tight, _ = descents.run(np.zeros((1, n)), -everywhere, everywhere, 0)
    mean = float(np.exp(tight[0]).mean())
    if not 0.0 < mean < np.inf:
        return None
    least = least_durations(problem)
    scale = np.minimum(mean, problem.duration_upper)
    made = np.where(least < share * scale, share * scale, 0.0)
    bottom = np.maximum(np.maximum(least, made), LEAST_SHARE * scale)
    if not (bottom <= problem.duration_upper).all():
        return None
    low = np.log(bottom)
    high = np.minimum(np.log(problem.duration_upper), np.log(mean) + FARTHEST)
    if not (low <= high).all():
        return None
    usual = np.clip(tight[0], low, high)
    hard = problem.limits.limits_position or bool(np.isfinite(problem.duration_upper).any())
    places = _places(
        usual, low, high, MEMBERS * n * (MANY if hard else 1), np.random.default_rng(seed)
    )
    ends, found = descents.run(places, low, high, 0)
    points = _chosen(usual, ends, found, DESCENTS * starts)
    ends, found = descents.run(points[:starts], low, high, kernel.STEPS)
    totals, converged = _totals(found)
    if len(points) > starts and not totals.min() <= lower * (1.0 + PROVEN):
        # The further descents challenge those that were asked for.
        more = descents.run(points[starts:], low, high, kernel.STEPS)
        ends, found = np.vstack([ends, more[0]]), np.vstack([found, more[1]])
        totals, converged = _totals(found)
    if not (np.isfinite(totals) & converged).any():
        return None
    best = int(np.argmin(np.where(converged, totals, np.inf)))
    if totals.min() < totals[best] * (1.0 - BETTER):
        return None
    h = np.clip(np.exp(ends[best]), problem.duration_lower, problem.duration_upper)
    if (h <= AT_FLOOR * made).any():
        return None
    verdict = check(problem, h)
    report = kkt(problem, h)
    if verdict.verdict is not Verdict.PASS or not report.residual <= LIMIT:
        return None
    # Challengers count where one of them won.
    shortest = float(totals[best])
    first = totals[:starts].min() <= shortest * (1 + kernel.SAME)
    totals = totals[:starts] if first else totals
    return Solution(
        problem,
        Status.CONVERGED,
        durations=h,
        check=verdict,
        kkt_residual=report.residual,
        active=report.active,
        starts=len(totals),
        starts_at_best=int((totals <= shortest * (1 + kernel.SAME)).sum()),
        iterations=int(found[np.isfinite(found[:, 2]), 2].sum()),
        totals=tuple(totals.tolist()),
    )
