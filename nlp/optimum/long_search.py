"""Local optimum of a problem of many segments: limits where they matter, found again until none is.

Rounds of IPOPT on `LongProgram`, begun where windows of some dozen segments end if there are very
many. The first round of all segments has rows at the interior extrema of its start, each later one
at those of the motion before it that come near their limit; an exact search over all pieces says
where they are, so that no sampled place decides.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from ...problem import Array, Problem, check, fit
from .clock import time_up
from .judgement import KKT_TOLERANCE
from .long_formulation import LongProgram
from .long_optimality import LongKKT, long_kkt
from .long_round import TOLERANCES, fresh, multipliers, solve_round
from .long_rows import EVERY, FLAT, NEAR, carried, near_rows, with_loaded
from .long_start import excess_of
from .long_windows import FEWEST, joined_windows

ROUNDS = 12
"""Most rounds of one attempt; three to six suffice where any number does."""
JOINED = 2
"""Round, counted from 0, that joined windows take the place of those before: the first whose
tolerance and barrier are the last ones."""
FAILURES = 3
"""Rounds without success after which a search is given up; each begins again from the best motion
with rows at all its extrema."""
CHANGED = 3.0
"""Factor by which a round changes a duration at most: the extrema of a motion far away are others,
and without a bound some quintics leave for motions of which the rows say nothing. Its square root
after each failure."""
FLATTER, FLATTEST = 10.0, 1e-2
"""Factor and end of the second derivative below which rows stay, where limits are kept and the
conditions of an optimum are not met: multipliers of rows that follow a vague extremum are vague."""
LOADED = 10.0
"""Multiplier, in tolerances of its round, from which a row was active: the barrier leaves about the
tolerance on the others."""
SETTLED = 2e-9
"""Excess over a limit at which the rounds end: a stretch, which costs as much, repairs it."""


@dataclass(frozen=True, eq=False)
class LongLocal:
    """The end of a search, with its optimality conditions.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    kkt : LongKKT or None
        None where the rounds ended before the limits were kept; the durations, stretched, keep
        them.
    iterations : int
    build_seconds : float
    """

    durations: Array
    kkt: LongKKT | None
    iterations: int
    build_seconds: float


def long_search(problem: Problem, start: Array, floor: Array) -> LongLocal | None:
    """A local optimum from a start, or how far the rounds came; None where they came nowhere.

    Parameters
    ----------
    problem : Problem
        With a determined piecewise polynomial.
    start : ndarray, shape (segments,)
        s.
    floor : ndarray, shape (segments,)
        Least durations, s.

    Returns
    -------
    LongLocal or None
    """
    began = time.perf_counter()
    program = LongProgram(problem, float(start.mean()), floor)
    trajectory = fit(problem.curve, problem.waypoints, start)
    state = fresh(program, start, trajectory)
    rows = near_rows(program, trajectory, EVERY)
    build, iterations = time.perf_counter() - began, 0
    local: LongLocal | None = None
    rough: Array | None = None
    turn = failures = done = 0
    flat = FLAT
    if problem.segments >= FEWEST:
        joined = joined_windows(program, trajectory, floor)
        if joined is not None:
            state, turn = joined.state, JOINED
            h = state.x[: problem.segments] * program.unit
            rough = _within(problem, h, excess_of(problem, h))
            rows = near_rows(program, fit(problem.curve, problem.waypoints, h), NEAR)
            state.rows = carried(joined.rows, joined.duals, rows)
            iterations, build = joined.iterations, build + joined.build_seconds
    while done < ROUNDS:
        if iterations and time_up():
            break
        done += 1
        before = state.x[: problem.segments] * program.unit
        factor = CHANGED ** (0.5**failures)
        box = (before / factor, before * factor)
        duals, success, count, seconds = solve_round(program, rows, state, turn, box)
        iterations, build = iterations + count, build + seconds
        h = state.x[: problem.segments] * program.unit
        whole = bool(np.isfinite(h).all() and (h > 0).all())
        excess = excess_of(problem, h) if whole else np.inf
        if np.isfinite(excess):
            longer = _within(problem, h, excess)
            rough = longer if rough is None or longer.sum() < rough.sum() else rough
        if not (success and np.isfinite(excess)):
            failures += 1
            if failures > FAILURES:
                break
            turn = done = 0
            back = start if rough is None else rough
            trajectory = fit(problem.curve, problem.waypoints, back)
            state = fresh(program, back, trajectory)
            rows = near_rows(program, trajectory, EVERY)
            continue
        trajectory = fit(problem.curve, problem.waypoints, h)
        if turn and excess <= SETTLED:
            violation = check(problem, longer).max_violation
            kkt = long_kkt(problem, longer, multipliers(program, rows, state, duals), violation)
            if local is None or local.kkt is None or kkt.residual < local.kkt.residual:
                local = LongLocal(longer, kkt, iterations, build)
            # A round with an eased tolerance leaves its barrier's gap: 1.6e-7 of a total was seen.
            if turn >= len(TOLERANCES) - 1:
                if kkt.residual <= KKT_TOLERANCE:
                    break
                flat = min(FLATTEST, FLATTER * flat)
        loaded = LOADED * TOLERANCES[min(turn, len(TOLERANCES) - 1)]
        extrema = near_rows(program, trajectory, NEAR, flat)
        now = with_loaded(program, rows, duals, extrema, loaded)
        state.rows, rows, turn = carried(rows, duals, now), now, turn + 1
    if local is None and rough is not None:
        local = LongLocal(rough, None, iterations, build)
    return local


def _within(problem: Problem, h: Array, excess: float) -> Array:
    """Durations stretched by what they exceed their limits, where a stretch repairs that."""
    if not (problem.curve.homogeneous and excess > 0.0):
        return h
    return np.asarray(np.clip(h * (1 + excess), problem.duration_lower, problem.duration_upper))
