"""Solve a problem from several starts and judge the answer."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Problem, check
from .basins import (
    basins,
    exact_search,
    moving_at_floor,
    short_ways,
    shortened,
    tolerated_search,
)
from .clock import stopping_after, time_up
from .closed_forms import cut_short, unsearched
from .decided import decided, kept, stretched
from .feasibility import apart
from .fixed_ratios import at_ratios
from .judgement import BETTER, ROUNDED, better_of, judged
from .jumps import as_answer, carried_over, jump_equations, matched, smoother
from .optimality import Local
from .rounds import program_search
from .solution import Route, Solution, Status
from .starts import (
    DENSE,
    Ask,
    anywhere,
    asked,
    equal_start,
    first_nodal,
    made_up,
    random_starts,
    way_start,
)

STARTS = 4
"""Basins of the wide search from which descents start."""
FLOORS = (1e-3, 1e-4)
"""Smallest durations tried, relative to the mean, where the case sets no lower bound."""
DEEPER = (1e-6, 1e-8, 1e-10)
"""Further floors where way-points nearly coincide: the total may rise again below the others."""
PROVEN = 1e-6
"""Relative distance from a proved lower bound at which nothing shorter is looked for."""
SPARSE = 14
"""Segments from which rounds of the NLP come first: there they end at the same totals in half the
time of a wide search and dense descents, at 10 segments in twice it."""
ONLY_TOLERANCE = "the limits leave no room: they are kept within the tolerance of the check alone"
"""Beside an answer that exact limits would not let pass."""
APPROACHED = 1e-6
"""Share of a total that is still to fall at which the value that it approaches is near enough: an
extrapolation over more than this may be off by more than totals that count as the same."""
ANYWHERE = 8
"""Further starts all over the box before nothing is said to be found."""


def solve(
    problem: Problem,
    *,
    starts: int = STARTS,
    seed: int = 0,
    initial: ArrayLike | None = None,
    known: ArrayLike | None = None,
    known_nodal: ArrayLike | None = None,
    seconds: float = math.inf,
    lower: float = 0.0,
) -> Solution:
    """Best known total time of a problem with shared durations.

    Up to 24 segments a wide search on exact totals finds basins, and a descent on the exact extrema
    goes down in each. Beyond, and where the curve leaves derivatives free, rounds of the exact NLP
    (`build`) answer. Where the problem fixes the ratios of its durations, the total is a formula.

    Parameters
    ----------
    problem : Problem
        Its coupling is not looked at: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    starts : int
        Number of starts, 1 or more.
    seed : int
        Seed of the random starts.
    initial : array_like, shape (starts, segments), optional
        Starts to use instead, s.
    known : array_like, shape (motions, segments), optional
        Durations, s, that somebody already has: printed ones, replays, a certificate's. Each that
        `check` passes, as it is or stretched uniformly, is an incumbent: the answer is never worse.
        The others do no harm.
    known_nodal : array_like, shape (motions, free, joints), optional
        Their free derivatives, where the curve leaves some open; without them those motions are
        not determined, and not used.
    seconds : float
        Time limit, kept to within a step of the search: the best motion so far is the answer, and
        `why` says that the time ran out. What is found then depends on the machine.
    lower : float
        A proved lower bound of the total, s. It saves searches, and is no part of the answer: where
        a known motion is within a millionth of it, no other basin is looked for.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` or ``known`` has the wrong shape, or there is no formula for fixed ratios.
    """
    ask = asked(problem, starts, seed, initial, known, known_nodal, lower)
    if problem.ratios is not None:
        return at_ratios(problem)
    began = time.perf_counter()
    with stopping_after(seconds):
        answer = unsearched(problem)
        if answer is None:
            answer = _solve(problem, ask)
            answer = cut_short(answer) if time_up() else answer
    return replace(answer, solve_seconds=time.perf_counter() - began - answer.build_seconds)


def _solve(problem: Problem, ask: Ask) -> Solution:
    """`solve` where no elementary argument decides."""
    smooth = smoother(problem)
    if smooth is not None:
        found = as_answer(problem, _solve_smoother(problem, smooth, ask))
        if found is not None:
            return found
    return _solve_itself(problem, ask)


def _sparse(problem: Problem) -> bool:
    """Whether rounds of the NLP apply: each segment moves, and something is limited."""
    curve, sides = problem.curve.piecewise, problem.limits.sides
    moves = np.abs(np.diff(problem.waypoints, axis=0)).max(axis=1) > 0
    limited = (np.isfinite(sides) & (sides > 0)).any()
    return curve is not None and not curve.free and bool(moves.all() and limited)


def _solve_smoother(problem: Problem, smooth: Problem, ask: Ask) -> Solution:
    """`solve` on the smoother declaration, with the same starts and known motions."""
    known, values = ask.known, None
    if ask.known_nodal is None:
        known = known[:0]  # without their free derivatives they are not determined
    else:
        values = carried_over(problem, ask.known_nodal, known, smooth)
    return solve(
        smooth,
        starts=ask.starts,
        seed=ask.seed,
        initial=ask.initial,
        known=known,
        known_nodal=values,
    )


def _solve_itself(problem: Problem, ask: Ask) -> Solution:
    """`solve` where no smoother declaration has the same motions."""
    if problem.curve.free or problem.segments > DENSE:
        solution = _programmed(problem, ask)
    elif (near := _proved(problem, ask)) is not None:
        solution = _searched(problem, replace(ask, initial=near[None]))
    elif ask.initial is not None:
        solution = _searched(problem, ask)
    else:
        solution = _shortened(problem, _widely(problem, ask), ask)
    solution = _finished(problem, _with_known(problem, solution, ask))
    if not solution.found:
        solution = _without_jumps(problem, solution, ask.seed)
    if not solution.found:
        solution = _stretched_start(problem, solution)
    return solution


def _finished(problem: Problem, solution: Solution) -> Solution:
    """The answer, finished by the NLP where descents stopped short of an optimum."""
    short = solution.status is Status.FEASIBLE and solution.route is Route.DESCENT
    if not (short and _sparse(problem)) or time_up():
        return solution
    floor = np.minimum(made_up(problem, FLOORS[-1]), 0.5 * solution.durations)
    found = _rounds(problem, solution.durations[None], floor, None)
    return better_of(solution, judged(problem, found, floor, solution.starts, Route.NLP))


def _proved(problem: Problem, ask: Ask) -> Array | None:
    """A known motion that passes, and below which a proof leaves no room; None without one."""
    for h in ask.known:
        if h.sum() <= ask.lower * (1.0 + PROVEN) and kept(problem, check(problem, h)):
            return np.asarray(h)
    return None


def _programmed(problem: Problem, ask: Ask) -> Solution:
    """Rounds of the NLP from each start."""
    floor = made_up(problem, FLOORS[-1])
    nodal = first_nodal(problem)
    if ask.initial is not None:
        starts = ask.initial
    elif problem.curve.free:
        generator = np.random.default_rng(ask.seed)
        more = random_starts(problem, ask.starts - 1, generator)
        starts = np.vstack([equal_start(problem), more])
    elif problem.curve.piecewise is None:
        starts = equal_start(problem)[None]
    else:
        starts = way_start(problem)[None]
    found = _rounds(problem, starts, floor, nodal)
    if not any(local.feasible for local in found) and nodal is not None:
        usual = equal_start(problem)  # stretched to be tight, with the free derivatives at rest
        passes = kept(problem, check(problem, usual, nodal))
        found.append(Local(usual, nodal, float(usual.sum()), False, passes, 0))
    return judged(problem, found, floor, len(starts), Route.NLP)


def _rounds(problem: Problem, starts: Array, floor: Array, nodal: Array | None) -> list[Local]:
    """Ends of the NLP's rounds from each start; later ones are not begun once the time is up."""
    found: list[Local] = []
    for start in starts:
        if found and time_up():
            break
        local = program_search(problem, start, floor, nodal)
        if local is not None:
            found.append(local)
    return found


def _widely(problem: Problem, ask: Ask) -> Solution:
    """The answer by rounds of the NLP where these are quick, or else from a wide search."""
    if problem.segments < SPARSE or not _sparse(problem):
        return _searched(problem, ask)
    found = _programmed(problem, ask)
    if found.status is Status.CONVERGED:
        return found
    return better_of(_searched(problem, ask), found)


def _searched(
    problem: Problem, ask: Ask, shares: tuple[float, ...] = (*FLOORS, *DEEPER)
) -> Solution:
    """Exact descents from the basins of a wide search, or from the given starts.

    Where an answer ends at a floor, the floor is lowered, with a search of its own; where it still
    does, the total only approaches its infimum.
    """
    carried = np.empty((0, problem.segments))
    coarse: Solution | None = None
    for k, share in enumerate(shares):
        floor = made_up(problem, share)
        if ask.initial is None:
            points = basins(problem, ask.starts, ask.seed, floor)
        else:
            points = ask.initial
        points = np.vstack([points, carried])
        found = exact_search(problem, points, floor)
        solution = judged(problem, found, floor, len(points))
        if not solution.found and coarse is not None:
            return coarse  # further down, rounding hides the limits
        if not solution.found and ask.initial is None:
            more = anywhere(problem, ANYWHERE, ask.seed, floor)
            found += exact_search(problem, more, floor)
            solution = judged(problem, found, floor, len(found))
            if not solution.found:
                found += tolerated_search(problem, ask.starts, ask.seed, DEEPER[0])
                least = judged(problem, found, made_up(problem, DEEPER[0]), len(found))
                none = not least.found
                why = ONLY_TOLERANCE
                return solution if none else replace(least, status=Status.FEASIBLE, why=why)
        if coarse is not None and solution.total_time > coarse.total_time * (1 + BETTER):
            return coarse  # rounding costs more than the lower floor gains
        if solution.status is not Status.NOT_ATTAINED:
            h, stopped = solution.durations, solution.status is Status.FEASIBLE
            if coarse is None or h is None or not stopped:
                return solution
            if solution.total_time < coarse.best * (1 - BETTER):
                return solution  # what was approached above is undercut: it is no infimum
            # Unconverged below the floor that an answer lay on, it shows no less that totals fall.
            return coarse if (h < made_up(problem, shares[k - 1])).any() else solution
        if coarse is not None:
            solution = _approached(problem, coarse, solution, shares[k - 1], share)
            near = solution.total_time - solution.best <= APPROACHED * solution.total_time
            if near and not moving_at_floor(problem, solution.durations, floor):
                return solution
        coarse, carried = solution, solution.durations[None]
    assert coarse is not None
    return coarse


def _without_jumps(problem: Problem, solution: Solution, seed: int) -> Solution:
    """Ratios of durations at which a curve that may jump happens not to."""
    found = [Local(h, v, float(h.sum()), True, True, 0) for h, v in matched(problem, seed)]
    if not found:
        equations, ratios = jump_equations(problem)
        if not equations > ratios:
            return solution
        why = f"it would take {ratios} ratios of durations that meet {equations} equations"
        return replace(solution, why=f"{solution.why}; {why}")
    answer = judged(problem, found, np.zeros(problem.segments), len(found))
    why = f"shortest of {len(found)} ratios of durations at which the motion does not jump"
    return replace(answer, status=Status.FEASIBLE, why=why, iterations=solution.iterations)


def _stretched_start(problem: Problem, solution: Solution) -> Solution:
    """Equal durations, stretched until they pass, where no search found anything."""
    found = decided(problem, equal_start(problem), first_nodal(problem))
    if found is None:
        return solution
    answer = judged(problem, [found], made_up(problem, FLOORS[-1]), solution.starts)
    return replace(answer, iterations=solution.iterations, build_seconds=solution.build_seconds)


def _shortened(problem: Problem, solution: Solution, ask: Ask) -> Solution:
    """The answer, or a better one in which a segment between close way-points is much shorter."""
    if solution.status is not Status.CONVERGED or apart(problem) or time_up():
        return solution
    if not short_ways(problem):
        return solution
    floor = made_up(problem, DEEPER[-1])
    ends = exact_search(problem, shortened(problem, solution.durations, floor), floor)
    found = judged(problem, ends, floor, len(ends))
    if found.status is Status.NOT_ATTAINED:
        found = _searched(problem, replace(ask, initial=found.durations[None]), shares=DEEPER)
    return replace(better_of(solution, found), starts=solution.starts + len(ends))


def _with_known(problem: Problem, solution: Solution, ask: Ask) -> Solution:
    """The answer, or the shortest known motion that `check` passes, made shorter if possible."""
    nodal: list[Array | None] = [None] * len(ask.known)
    if problem.curve.free:
        if ask.known_nodal is None:
            return solution
        nodal = list(ask.known_nodal)
    bar = solution.best * (1 - ROUNDED)
    shorter = sorted(
        ((h, v) for h, v in zip(ask.known, nodal, strict=True) if h.sum() < bar),
        key=lambda motion: float(motion[0].sum()),
    )
    repaired = (stretched(problem, h, v) for h, v in shorter)
    passed = next((one for one in repaired if one is not None and one[0].sum() < bar), None)
    if passed is None:
        return solution
    best, values = passed
    incumbent = Local(best, values, float(best.sum()), False, True, 0)
    floor = np.minimum(made_up(problem, FLOORS[-1]), best / 2.0)
    found, dense = [incumbent], not problem.curve.free and problem.segments <= DENSE
    if dense:
        found += exact_search(problem, best[None], floor)
    elif problem.curve.piecewise is not None:
        found += _rounds(problem, best[None], floor, values)
    route = Route.DESCENT if dense else Route.NLP
    answer = judged(problem, found, floor, solution.starts, route)
    return answer if answer.best < solution.best else solution


def _approached(
    problem: Problem, coarser: Solution, finer: Solution, wide: float, narrow: float
) -> Solution:
    """The infimum by extrapolating the totals at two floors to 0, along one basin."""
    totals = [coarser.total_time]
    if problem.segments <= DENSE:
        again = exact_search(problem, finer.durations[None], made_up(problem, wide))
        totals += [local.total for local in again if local.feasible]
    ratio = narrow / wide
    slope = max(0.0, min(totals) - finer.total_time) / (1.0 - ratio)
    return replace(finer, infimum=max(0.0, finer.total_time - slope * ratio))
