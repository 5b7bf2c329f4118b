"""Local optimum by the NLP: rounds of IPOPT, with rows at the extrema of the motion before.

The first round has rows at all interior extrema of its start, each later one at those of the motion
before it that come near their limit; an exact search over all pieces says where they are, so that
no sampled place decides.
"""

from __future__ import annotations

import time

import numpy as np

from ...problem import Array, CurveError, Problem, check, evaluate, fit
from ...problem.curves import Trajectory
from .clock import time_up
from .decided import kept
from .limit_rows import Rows
from .optimality import KKT, KKT_TOLERANCE, Local, kkt, sparse_kkt
from .program import Program
from .rounds import (
    EVERY,
    FLAT,
    NEAR,
    SPARSER,
    TOLERANCES,
    AnyProgram,
    RoundState,
    beside,
    carried,
    fresh,
    grid_rows,
    multipliers,
    near_rows,
    solve_round,
    with_loaded,
)
from .spline_program import SplineProgram
from .starts import DENSE, equal_start, slowed, stretching, worst_ratios

ROUNDS = 12
"""Most rounds of one attempt; three to six suffice where any number does."""
LAST = 2
"""Round, counted from 0, from which the answer is judged: its tolerance is that of an answer."""
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

Motion = tuple[Array, Array | None]
"""Durations, s, and free derivatives, where the declaration leaves some."""


def build(problem: Problem) -> AnyProgram:
    """The exact NLP of a problem, not solved: ``print(build(problem))`` says what it consists of.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Program or SplineProgram
        With its `variables`, `equalities`, `bounds` and the rows of `at_places`.

    Raises
    ------
    TrajgapError
        If no NLP is known for the kind of curve.
    """
    return program_of(problem, float(equal_start(problem).mean()), np.zeros(problem.segments))


def program_of(problem: Problem, unit: float, floor: Array) -> AnyProgram:
    """The program of a problem in a time unit, s, with least durations, s."""
    made = SplineProgram if problem.curve.piecewise is None else Program
    return made(problem, unit, floor)


def program_search(
    problem: Problem, start: Array, floor: Array, nodal: Array | None = None
) -> Local | None:
    """A local optimum from a start, or how far the rounds came; None where they came nowhere.

    Parameters
    ----------
    problem : Problem
        With any kind of curve that an NLP is known for.
    start : ndarray, shape (segments,)
        s.
    floor : ndarray, shape (segments,)
        Least durations, s.
    nodal : ndarray, shape (free, joints), optional
        Free derivatives at the start, where the declaration leaves some.

    Returns
    -------
    Local or None
        With its optimality conditions, where the last round kept the limits.
    """
    began = time.perf_counter()
    program = program_of(problem, float(start.mean()), floor)
    trajectory = fit(problem.curve, problem.waypoints, start, nodal)
    state = fresh(program, program.pack(trajectory, start))
    rows = _rows(program, trajectory, EVERY)
    build, iterations = time.perf_counter() - began, 0
    best: tuple[Motion, KKT] | None = None
    rough: Motion | None = None
    turn = failures = done = 0
    flat = FLAT
    while done < ROUNDS:
        if iterations and time_up():
            break
        done += 1
        before = state.x[: problem.segments] * program.unit
        factor = CHANGED ** (0.5**failures)
        box = (before / factor, before * factor)
        duals, success, count, seconds = solve_round(program, rows, state, turn, box)
        iterations, build = iterations + count, build + seconds
        now = program.motion(state.x)
        excess = _excess(problem, now)
        if np.isfinite(excess):
            longer = within(problem, now, excess)
            rough = longer if rough is None or longer[0].sum() < rough[0].sum() else rough
        if not success and turn > LAST:
            break  # rounding allows no more
        if not (success and np.isfinite(excess)):
            failures += 1
            if failures > FAILURES:
                break
            turn = done = 0
            back = rough or (start, nodal)
            trajectory = fit(problem.curve, problem.waypoints, *back)
            state = fresh(program, program.pack(trajectory, back[0]))
            rows = _rows(program, trajectory, EVERY)
            continue
        trajectory = fit(problem.curve, problem.waypoints, *now)
        if turn and excess <= SETTLED:
            report = _report(program, longer, rows, state, duals)
            if best is None or report.residual < best[1].residual:
                best = longer, report
            # A round with an eased tolerance leaves its barrier's gap: 1.6e-7 of a total was seen.
            if turn >= LAST:
                if report.residual <= KKT_TOLERANCE:
                    break
                flat = min(FLATTEST, FLATTER * flat)
        loaded = LOADED * TOLERANCES[min(turn, LAST)]
        extrema = _rows(program, trajectory, NEAR, flat)
        following = with_loaded(program, rows, duals, extrema, loaded)
        state.rows, rows, turn = carried(rows, duals, following), following, turn + 1
    if best is None and rough is None:
        return None
    motion, found = best if best is not None else (rough, None)
    assert motion is not None
    h, values = motion
    passes = kept(problem, check(problem, h, values))
    settled = found is not None and found.residual <= KKT_TOLERANCE
    total = float(h.sum())
    return Local(h, values, total, settled, passes, iterations, None, found, build)


def _rows(program: AnyProgram, trajectory: Trajectory, near: float, flat: float = FLAT) -> Rows:
    """Rows at extrema, and at fixed places where the declaration leaves derivatives free."""
    rows = near_rows(program, trajectory, near, flat)
    if not (isinstance(program, Program) and program.problem.curve.free):
        return rows
    return beside(program, rows, grid_rows(program), SPARSER)


def _report(
    program: AnyProgram, motion: Motion, rows: Rows, state: RoundState, duals: Array
) -> KKT:
    """Optimality conditions: at the multipliers of the round, or dense ones of few segments."""
    problem, (h, nodal) = program.problem, motion
    few = problem.curve.free or problem.segments <= DENSE
    if few or not isinstance(program, Program):
        return kkt(problem, h, nodal)
    violation = check(problem, h).max_violation
    return sparse_kkt(problem, h, multipliers(program, rows, state, duals), violation)


def _excess(problem: Problem, motion: Motion) -> float:
    """Relative excess over the limits of derivatives, as a stretch; inf where there is no curve."""
    h, nodal = motion
    if not (np.isfinite(h).all() and (h > 0).all()):
        return np.inf
    if problem.curve.piecewise is None:
        return float(evaluate(stretching(problem), h[None]).stretch[0]) - 1.0
    try:
        trajectory = fit(problem.curve, problem.waypoints, h, nodal)
    except CurveError:
        return np.inf
    return float(worst_ratios(problem, trajectory).max()) - 1.0


def within(problem: Problem, motion: Motion, excess: float) -> Motion:
    """A motion stretched by what it exceeds its limits, where a stretch repairs that.

    Parameters
    ----------
    problem : Problem
    motion : (durations, free derivatives)
    excess : float
        Relative, as a stretch.

    Returns
    -------
    (durations, free derivatives)
    """
    h, nodal = motion
    if not (problem.curve.homogeneous and excess > 0.0):
        return motion
    factor = 1.0 + excess
    longer = np.clip(h * factor, problem.duration_lower, problem.duration_upper)
    return longer, None if nodal is None else slowed(problem, nodal, factor)
