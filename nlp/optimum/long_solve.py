"""Answers for problems of many segments: a sparse search, judged for all t like any other."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from ...problem import Array, Check, Problem, check
from .asked import Ask
from .clock import time_up
from .decided import decided, kept, stretched
from .exact_multistart import made_up
from .judgement import BLURRED, KKT_TOLERANCE, SAME, still_falling, unmet
from .long_search import LongLocal, long_search
from .long_start import way_start
from .solution import Solution, Status
from .starts import SETTLED_SEGMENTS

LEAST_DURATION = 1e-4
"""Least duration that is searched where no bound is higher, in shares of the mean of equal ones."""
TRIED_ANEW = 100
"""Segments up to which the tracked NLP takes over where this search does not settle: dense
gradients make it take minutes beyond."""
SHORTER = 2e-9
"""Relative gain of a known motion that counts: twice what the checker's tolerance gives away."""


def long_enough(problem: Problem, ask: Ask) -> bool:
    """Whether a problem is searched here alone: one of many segments.

    Below, there are searches that look for more basins.
    """
    return problem.segments > SETTLED_SEGMENTS and covers(problem, ask)


def covers(problem: Problem, ask: Ask) -> bool:
    """Whether this search knows the curve and the limits, and something moves in each segment.

    It knows limits of equal sides.
    """
    curve = problem.curve.piecewise
    if curve is None or curve.free or ask.form is not None:
        return False
    if problem.limits.uneven:
        return False
    limits = problem.limits.derivatives
    moves = np.abs(np.diff(problem.waypoints, axis=0)).max(axis=1) > 0
    return bool(moves.all() and (np.isfinite(limits) & (limits > 0)).any())


def solve_long(problem: Problem, ask: Ask) -> Solution | None:
    """A local optimum of a problem of many segments, or None where none is found here.

    Parameters
    ----------
    problem : Problem
        For which `covers` holds.
    ask : Ask
        Without starts of its own one is taken: durations after the ways of the segments.

    Returns
    -------
    Solution or None
    """
    began = time.perf_counter()
    floor = made_up(problem, LEAST_DURATION)
    starts = way_start(problem)[None] if ask.initial is None else ask.initial
    found = [_searched(problem, start, floor, ask, k) for k, start in enumerate(starts)]
    best = _best(found)
    known = _shortest_known(problem, ask, best)
    if known is not None:
        found.append(_searched(problem, known, floor, ask, 0))
        better = _best(found)
        if better is None or better.total_time > known.sum() * (1 + SHORTER):
            why = "a known motion, shorter than what the search found"
            verdict = check(problem, known)
            better = Solution(problem, Status.FEASIBLE, why, durations=known, check=verdict)
        best = better
    if best is None:
        return None
    totals = tuple(np.inf if one is None else one.total_time for one in found)
    build = sum(one.build_seconds for one in found if one is not None)
    return replace(
        best,
        starts=len(found),
        starts_at_best=sum(total <= best.total_time * (1 + SAME) for total in totals),
        iterations=sum(one.iterations for one in found if one is not None),
        build_seconds=build,
        solve_seconds=time.perf_counter() - began - build,
        totals=totals,
    )


def _best(found: list[Solution | None]) -> Solution | None:
    return min((one for one in found if one is not None), key=lambda s: s.total_time, default=None)


def _shortest_known(problem: Problem, ask: Ask, best: Solution | None) -> Array | None:
    """The shortest known motion that passes, if it is shorter than the answer."""
    bar = np.inf if best is None else best.total_time * (1 - SHORTER)
    shorter = sorted((h for h in ask.known if h.sum() < bar), key=lambda h: float(h.sum()))
    repaired = (stretched(problem, h, None) for h in shorter)
    return next((one[0] for one in repaired if one is not None and one[0].sum() < bar), None)


def _searched(
    problem: Problem, start: Array, floor: Array, ask: Ask, number: int
) -> Solution | None:
    """The judged end of one search; later ones are not begun once the time is up."""
    if number and time_up():
        return None
    local = long_search(problem, start, floor)
    if local is None:
        return None
    stopped = time_up()
    if local.kkt is None and not stopped and problem.segments <= TRIED_ANEW:
        return None
    return _judged(problem, local, floor)


def _judged(problem: Problem, local: LongLocal, floor: Array) -> Solution | None:
    """An end that the checker passes, with its status; None if it cannot be made to pass."""
    h, verdict = local.durations, check(problem, local.durations)
    beyond = 0.0
    if not kept(problem, verdict):
        moved = _inside(problem, h, verdict)
        if moved is None:
            return None
        beyond = float(moved.sum() / h.sum()) - 1.0
        h, verdict = moved, check(problem, moved)
    residual = np.inf if local.kkt is None else local.kkt.residual
    status, why = Status.CONVERGED, None
    if residual > KKT_TOLERANCE:
        stopped = "the search ended before it met the conditions of an optimum"
        why = stopped if local.kkt is None else unmet(residual)
        status = Status.FEASIBLE
    elif beyond > KKT_TOLERANCE:
        why = f"longer by {beyond:.1e} (relative) than a tight motion, which rounding errors blur"
        status = Status.FEASIBLE if beyond > BLURRED else status
    falling = still_falling(h, floor)
    if falling is not None:
        status, why = Status.NOT_ATTAINED, falling
    return Solution(
        problem,
        status,
        why,
        durations=h,
        check=verdict,
        kkt_residual=None if local.kkt is None else residual,
        active=() if local.kkt is None else local.kkt.active,
        iterations=local.iterations,
        build_seconds=local.build_seconds,
    )


def _inside(problem: Problem, h: Array, verdict: Check) -> Array | None:
    """The motion stretched until it passes, where the duration bounds leave room for that."""
    room = verdict.feasible_time is not None
    if not room and problem.segments > TRIED_ANEW:
        return None
    found = decided(problem, h)
    return None if found is None else found.durations
