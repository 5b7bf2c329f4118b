"""Solve the exact NLP from several starts and judge the answer."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Problem, check
from .asked import Ask, asked
from .better import BETTER, better_of, settled
from .clock import TooLong, stopping_after, time_up
from .decided import decided, kept, stretched
from .descent import restored
from .exact_multistart import (
    UNEQUAL,
    anywhere,
    box_above,
    exact_search,
    exact_starts,
    made_up,
    ordinary,
    searchable,
    tolerated_search,
)
from .feasibility import apart
from .fixed_ratios import at_ratios
from .formulation import Form
from .idle import idle_segments, with_least_idle
from .ipopt import compiled, structure_of
from .judgement import judged, stretchable
from .long_solve import long_enough, solve_long
from .matching import jump_equations, matched
from .middle_solve import searched_sparsely
from .newton import settled_quickly
from .short_ways import moving_at_floor, short_ways, shortened
from .smoother import as_answer, carried_over, smoother
from .solution import Solution, Status
from .starts import equal_start, first_nodal, screened_starts
from .tracked_multistart import eliminating, tracked_multistart, tracked_search
from .tracking import Local
from .unsearched import cut_short, unsearched
from .wide_search import Basin

STARTS = 4
"""Equal durations first, then three screened random ones: a second opinion at small cost."""
FLOORS = (1e-3, 1e-4)
"""Smallest durations tried, relative to the mean, where the case sets no lower bound."""
DEEPER = (1e-6, 1e-8, 1e-10)
"""Further floors where way-points nearly coincide: the total may rise again below the others."""
ROUNDED = 2e-9
"""Relative gain of a known motion that counts: twice what the checker's tolerance gives away."""
RESTORABLE = 200
"""Segments up to which the feasibility phase runs: its gradients are dense, (segments)² each."""
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
    form: Form | None = None,
    seconds: float = math.inf,
    lower: float = 0.0,
) -> Solution:
    """Best known total time of a problem with shared durations, from an exact NLP.

    Where the problem fixes the ratios of its durations, it is a formula, without any start.

    Parameters
    ----------
    problem : Problem
        Its coupling is not looked at: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    starts : int
        Number of starts, 1 or more: equal durations first, then screened random ones. Determined
        splines of 9 segments and more begin with durations after the way of each segment; up to 24
        segments so many basins of a wide search follow.
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
    form : Form, optional
        Reduced or lifted; by default the faster one for the size.
    seconds : float
        Time limit, kept to within a step of the search: the best motion so far is the answer, and
        `why` says that the time ran out. What is found then depends on the machine.
    lower : float
        A proved lower bound of the total, s. It saves searches, and is no part of the answer: no
        further descents challenge a total that it leaves no room below.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` or ``known`` has the wrong shape, or there is no formula for fixed ratios.
    """
    ask = asked(problem, starts, seed, initial, known, known_nodal, form, lower)
    if problem.ratios is not None:
        return at_ratios(problem)
    with stopping_after(seconds):
        answer = unsearched(problem)
        if answer is not None:
            return answer
        answer = _solve(problem, ask)
        return cut_short(answer) if time_up() else answer


def _solve(problem: Problem, ask: Ask) -> Solution:
    """`solve` where no elementary argument decides."""
    if long_enough(problem, ask) and (answer := solve_long(problem, ask)) is not None:
        return answer
    smooth = smoother(problem)
    if smooth is not None:
        found = as_answer(problem, _solve_smoother(problem, smooth, ask))
        if found is not None:
            return found
    idle = idle_segments(problem)
    if idle:
        return _with_idle(problem, idle, ask)
    return _solve_moving(problem, ask)


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
        form=ask.form,
    )


def _solve_moving(problem: Problem, ask: Ask) -> Solution:
    """`solve` for a problem without idle segments."""
    began = time.perf_counter()
    if not searchable(problem):
        solution = _tracked(problem, ask)
        if solution.durations is None:
            solution = _after_restoration(problem, ask, solution)
    elif ask.initial is not None:
        mean = ask.initial.mean(axis=1, keepdims=True)
        alike = stretchable(problem) and (ask.initial >= UNEQUAL * mean).all()
        solution = _tracked(problem, ask) if alike else _searched(problem, ask)
    else:
        solution = _shortened(problem, _quickly(problem, ask) or _widely(problem, ask), ask)
    solution = _with_known(problem, solution, ask)
    if solution.durations is None:
        solution = _without_jumps(problem, solution, ask.seed)
    if solution.durations is None:
        solution = _stretched_start(problem, solution)
    return replace(solution, solve_seconds=time.perf_counter() - began - solution.build_seconds)


def _quickly(problem: Problem, ask: Ask) -> Solution | None:
    """The answer of Newton descents, where they settle."""
    if ask.form is not None or time_up():
        return None
    return settled_quickly(problem, ask.starts, ask.seed, FLOORS[-1], ask.lower)


def _widely(problem: Problem, ask: Ask) -> Solution:
    """The answer from the basins of a wide search: of sparse searches, else of the tracked NLP."""
    wide = exact_starts(problem, ask.starts, ask.seed, made_up(problem, FLOORS[-1]))
    found, stands = searched_sparsely(problem, ask, wide)
    if found is not None and stands:
        return found
    if ordinary(problem, wide[0]):
        answer = _challenged(problem, _tracked(problem, ask), wide, ask)
    else:
        answer = _searched(problem, ask)
    return answer if found is None else better_of(answer, found)


def _tracked(problem: Problem, ask: Ask) -> Solution:
    """The tracked NLP from each start; without it, a descent, where building it takes too long."""
    if problem.limits.uneven and problem.curve.piecewise is None:
        return _descended(problem, ask)  # the NLP of other curves knows limits of equal sides
    try:
        search, build_seconds = tracked_search(problem, ask)
    except TooLong:
        return _descended(problem, ask)
    points = ask.initial
    if points is None:
        points = screened_starts(problem, ask.starts, np.random.default_rng(ask.seed))
    mean = float(equal_start(problem).mean())
    solution, coarser = None, None
    for share in FLOORS:
        floor = share * mean
        made = np.where(problem.duration_lower == 0, floor, 0.0)
        found = search(points, floor)
        solution = judged(problem, found, made, len(points))
        if solution.status is Status.FEASIBLE and eliminating(problem, ask.form) and not time_up():
            # Eliminating across very unequal durations loses digits; the lifted form does not.
            lifted = compiled(structure_of(problem, Form.LIFTED))
            found += tracked_multistart(problem, lifted, points, floor)
            solution = judged(problem, found, made, len(points))
        if solution.status is not Status.NOT_ATTAINED:
            break
        if coarser is not None:
            solution = _approached(problem, coarser, solution, *FLOORS)
        coarser = solution
        assert solution.durations is not None
        points = solution.durations[None]
    assert solution is not None
    return replace(solution, build_seconds=build_seconds)


def _descended(problem: Problem, ask: Ask) -> Solution:
    """An exact descent from equal durations, or from the first start that was given."""
    floor = made_up(problem, FLOORS[-1])
    start = equal_start(problem) if ask.initial is None else ask.initial[0]
    if problem.segments > RESTORABLE:
        return judged(problem, [], floor, 0)
    return judged(problem, exact_search(problem, start[None], floor), floor, 1)


def _searched(
    problem: Problem,
    ask: Ask,
    durations: Array | None = None,
    shares: tuple[float, ...] = (*FLOORS, *DEEPER),
) -> Solution:
    """Exact descents from the basins of a wide search, or from the given starts.

    Where an answer ends at a floor, the floor is lowered, with a search of its own; where it still
    does, the total only approaches its infimum.
    """
    carried = np.empty((0, problem.segments)) if durations is None else durations[None]
    coarse: Solution | None = None
    for k, share in enumerate(shares):
        floor = made_up(problem, share)
        if ask.initial is None:
            wide = exact_starts(problem, ask.starts, ask.seed, floor)
            points = np.array([basin.durations for basin in wide])
        else:
            points = ask.initial
        points = np.vstack([points, carried])
        found = exact_search(problem, points, floor)
        solution = judged(problem, found, floor, len(points))
        if solution.durations is None and coarse is not None:
            return coarse  # further down, rounding hides the limits
        if solution.durations is None and ask.initial is None:
            more = anywhere(problem, ANYWHERE, ask.seed, floor)
            found += exact_search(problem, more, floor)
            solution = judged(problem, found, floor, len(found))
            if solution.durations is None:
                found += tolerated_search(problem, ask.starts, ask.seed, DEEPER[0])
                least = judged(problem, found, made_up(problem, DEEPER[0]), len(found))
                none = least.durations is None
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
            assert solution.durations is not None
            near = solution.total_time - solution.best <= APPROACHED * solution.total_time
            if near and not moving_at_floor(problem, solution.durations, floor):
                return solution
        assert solution.durations is not None
        coarse, carried = solution, solution.durations[None]
    assert coarse is not None
    return coarse


def _after_restoration(problem: Problem, ask: Ask, solution: Solution) -> Solution:
    """The tracked NLP once more, from starts that a feasibility phase has brought to the limits."""
    if problem.curve.free:
        usual = equal_start(problem)  # stretched to be tight, with the free derivatives at rest
        nodal = first_nodal(problem)
        if not kept(problem, check(problem, usual, nodal)):
            return solution
        assert nodal is not None
        return _with_known(
            problem, solution, replace(ask, known=usual[None], known_nodal=nodal[None])
        )
    if problem.segments > RESTORABLE:
        return solution
    floor = made_up(problem, FLOORS[-1])
    starts = np.vstack([equal_start(problem), anywhere(problem, ask.starts, ask.seed, floor)])
    box = box_above(problem, floor)
    ends = [restored(problem, start, box).durations for start in starts]
    return _tracked(problem, replace(ask, initial=np.array(ends)))


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


def _challenged(problem: Problem, solution: Solution, wide: list[Basin], ask: Ask) -> Solution:
    """The answer, or a better one from a basin that the tracked NLP did not reach."""
    if solution.status not in (Status.CONVERGED, Status.FEASIBLE) and not time_up():
        return better_of(solution, _searched(problem, ask, solution.durations))
    bar = solution.best * (1 - BETTER) if settled(solution) else np.inf
    points = np.array([basin.durations for basin in wide if basin.total < bar])
    if points.size == 0 or time_up():
        return solution
    floor = made_up(problem, FLOORS[-1])
    found = judged(problem, exact_search(problem, points, floor), floor, solution.starts)
    return better_of(solution, found)


def _shortened(problem: Problem, solution: Solution, ask: Ask) -> Solution:
    """The answer, or a better one in which a segment between close way-points is much shorter."""
    if solution.status is not Status.CONVERGED or apart(problem) or time_up():
        return solution
    if not short_ways(problem):
        return solution
    assert solution.durations is not None
    floor = made_up(problem, DEEPER[-1])
    for point in shortened(problem, solution.durations, floor, ask.seed):
        if time_up():
            break
        # One by one: a start that ends above a floor says nothing of one that ends at it.
        found = _searched(problem, replace(ask, initial=point[None]), shares=DEEPER)
        starts = solution.starts + found.starts
        solution = replace(better_of(solution, found), starts=starts)
    return solution


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
    found = [incumbent]
    if searchable(problem):
        found += exact_search(problem, best[None], floor)
    else:
        try:
            search, _ = tracked_search(problem, ask)
            found += search(best[None], FLOORS[-1] * float(best.mean()))
        except TooLong:
            pass  # the known motion is the answer
    answer = judged(problem, found, floor, solution.starts)
    return answer if answer.best < solution.best else solution


def _with_idle(problem: Problem, idle: list[int], ask: Ask) -> Solution:
    """Solve with idle segments held at an ordinary duration, then give them their least one."""
    held = equal_start(problem)
    low, high = problem.duration_lower.copy(), problem.duration_upper.copy()
    low[idle] = high[idle] = held[idle]
    if len(idle) == problem.segments:
        h, solution = low.copy(), Solution(problem, Status.CONVERGED)
    else:
        core = replace(problem, duration_lower=low, duration_upper=high)
        known = ask.known.copy()
        known[:, idle] = held[idle]
        solution = _solve_moving(core, replace(ask, known=known))
        if solution.durations is None:
            return replace(solution, problem=problem)
        h = solution.durations.copy()
    return with_least_idle(problem, idle, held, replace(solution, durations=h))


def _approached(
    problem: Problem, coarser: Solution, finer: Solution, wide: float, narrow: float
) -> Solution:
    """The infimum by extrapolating the totals at two floors to 0, along one basin."""
    assert finer.durations is not None
    totals = [coarser.total_time]
    if searchable(problem):
        again = exact_search(problem, finer.durations[None], made_up(problem, wide))
        totals += [local.total for local in again if local.feasible]
    ratio = narrow / wide
    slope = max(0.0, min(totals) - finer.total_time) / (1.0 - ratio)
    return replace(finer, infimum=max(0.0, finer.total_time - slope * ratio))
