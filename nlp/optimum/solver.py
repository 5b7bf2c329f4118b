"""Solve a problem from several starts and judge the answer."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ...problem import TOLERANCE, Array, Problem, TrajgapError, as_piecewise, check
from ..clock import stopping_after, time_up
from .basins import basins, exact_search, shortened
from .closed_forms import FORMULA, cut_short, refused_at_ratios, tight_at_ratios, unsearched
from .decided import AIM, Local, decided, incumbent, kept, widened
from .feasibility import apart, forbidden_jumps
from .judgement import BETTER, SAME_TOTAL, better_of, judged, on_floor
from .jumps import as_answer, carried_over, smoother
from .rounds import program_search
from .solution import Route, Solution, Status
from .starts import DENSE, equal_start, first_nodal, made_up, random_starts, vectors, way_start

STARTS = 4
"""Basins of the wide search from which descents start."""
FLOORS = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
"""Smallest durations tried, relative to the mean, where the case sets no lower bound: each if an
answer lies on the one before, because the total may rise again if way-points nearly coincide."""
DEEP = FLOORS[2:]
"""Those tried where a short way makes a second optimum likely that is decades away."""
SPARSE = 14
"""Segments from which rounds of the NLP come first: there they end at the same totals in half the
time of a wide search and dense descents, at 10 segments in twice it."""
RATIOS = 12
"""Random ratios from which rounds look for a motion without a jump: every second of them finds
one, if there is any."""
ONLY_TOLERANCE = "the limits leave no room: they are kept only within the tolerance of the check"
"""Beside an answer that exact limits would not let pass."""


@dataclass(frozen=True, eq=False)
class _Ask:
    """The arguments of `solve`."""

    starts: int
    seed: int
    initial: Array | None
    known: Local | None
    """The shortest motion that somebody has and that passes."""
    proved: bool
    """Whether a proved lower bound leaves no room below it."""


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
    runs in each. For more segments, or if the curve leaves derivatives free, rounds of the exact
    NLP (`build`) find the answer. If the problem fixes the ratios of its durations, the total is
    given by a formula.

    Parameters
    ----------
    problem : Problem
        Its coupling is ignored: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    starts : int
        Number of starts, 1 or more.
    seed : int
        Seed of the random starts.
    initial : array_like, shape (starts, segments), optional
        Starts to use instead, s.
    known : array_like, shape (motions, segments), optional
        Durations, s, that are already known: printed ones, replays, those of a certificate. Each
        that `check` passes, as it is or stretched uniformly, is an incumbent: the answer is never
        worse. The others do no harm.
    known_nodal : array_like, shape (motions, free, joints), optional
        Their free derivatives, if the curve leaves some open; without them, those motions are not
        determined and not used.
    seconds : float
        Time limit, kept to within a step of the search: the best motion so far is the answer, and
        `why` says that the time ran out. The result then depends on the machine.
    lower : float
        A proved lower bound of the total, s. It saves searches, and is not part of the answer:
        if a known motion is within a millionth of it, no other basin is searched.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` or ``known`` has the wrong shape, or there is no formula for fixed ratios.
    """
    if starts < 1:
        raise TrajgapError(f"starts: must be 1 or more, got {starts}")
    if not seconds >= 0.0:
        raise TrajgapError(f"seconds: must not be below 0, got {seconds}")
    points = np.empty((0, problem.segments)) if known is None else vectors(problem, "known", known)
    nodal = None if known_nodal is None else np.asarray(known_nodal, dtype=np.float64)
    wanted = (len(points), problem.curve.free, len(problem.joints))
    if nodal is not None and nodal.shape != wanted:
        raise TrajgapError(f"known_nodal: expected shape {wanted}, got {nodal.shape}")
    first = None if initial is None else vectors(problem, "initial", initial)
    began = time.perf_counter()
    with stopping_after(seconds):
        answer = unsearched(problem) if problem.ratios is None else _at_ratios(problem)
        if answer is None:
            best = incumbent(problem, points, nodal)
            proved = best is not None and best.total <= lower * (1.0 + SAME_TOTAL)
            answer = _solve(problem, _Ask(starts, seed, first, best, proved))
            answer = cut_short(answer) if time_up() else answer
    return replace(answer, solve_seconds=time.perf_counter() - began - answer.build_seconds)


def _at_ratios(problem: Problem) -> Solution:
    """The shortest motion whose durations have the ratios of the problem."""
    h = tight_at_ratios(problem)
    if isinstance(h, Solution):
        return h
    tight = Local.of(problem, h, converged=True)
    answer = judged(problem, [tight], np.zeros(problem.segments), 0, Route.CLOSED_FORM)
    if not answer.found:
        return refused_at_ratios(problem, h)
    if check(problem, h).stretch == 0.0 and not problem.duration_lower.any():
        why = "nothing that moves is limited, so the total falls to 0"
        found = replace(answer, status=Status.NOT_ATTAINED, why=why, infimum=0.0)
        return replace(found, kkt_residual=None, active=())
    if answer.status is not Status.CONVERGED:
        return answer
    return replace(answer, why=FORMULA if answer.why is None else f"{FORMULA}; {answer.why}")


def _solve(problem: Problem, ask: _Ask) -> Solution:
    """`solve` where no elementary argument decides."""
    curve = problem.curve.polynomial_form()
    if curve is not problem.curve:
        answer = _solve(replace(problem, curve=curve), ask)
        verdict = check(problem, answer.durations) if answer.found else None
        if verdict is None or kept(problem, verdict):
            return replace(answer, problem=problem, check=verdict)
    many = problem.curve.free or problem.segments > DENSE
    if problem.limits.braking.any() and (many or (forbidden_jumps(problem) and not apart(problem))):
        return _in_narrow_limits(problem, ask)
    smooth = smoother(problem)
    if smooth is not None:
        found = as_answer(problem, _solve_smoother(problem, smooth, ask))
        if found is not None:
            return found
    return _solve_itself(problem, ask)


NARROW = "acceleration and deceleration were both kept within the smaller of their limits"
"""Beside an answer of the NLP, whose rows do not depend on the sign of the speed."""


def _in_narrow_limits(problem: Problem, ask: _Ask) -> Solution:
    """The answer within `Limits.narrow`, which keeps all limits."""
    found = _solve(replace(problem, limits=problem.limits.narrow), replace(ask, proved=False))
    why = NARROW if found.why is None else f"{found.why}; {NARROW}"
    status = found.status if found.status is Status.FAILED else Status.NONE_FOUND
    if not found.found:
        return replace(found, problem=problem, status=status, why=why)
    verdict = check(problem, found.durations, found.nodal)
    return replace(found, problem=problem, status=Status.FEASIBLE, why=why, check=verdict)


def _solve_smoother(problem: Problem, smooth: Problem, ask: _Ask) -> Solution:
    """`solve` on the smoother declaration, with the same starts and the known motion."""
    known = values = None
    if ask.known is not None:
        known = ask.known.durations[None]
        values = carried_over(problem, np.array([ask.known.nodal]), known, smooth)
    return solve(
        smooth,
        starts=ask.starts,
        seed=ask.seed,
        initial=ask.initial,
        known=known,
        known_nodal=values,
    )


def _solve_itself(problem: Problem, ask: _Ask) -> Solution:
    """`solve` where no smoother declaration has the same motions."""
    jumping = bool(forbidden_jumps(problem)) and not apart(problem)
    dense = not (problem.curve.free or jumping) and problem.segments <= DENSE
    known = ask.known
    if jumping:
        solution = _programmed(problem, replace(ask, initial=None), RATIOS)
        solution = _without_jumps(problem, solution)
    elif not dense:
        solution = _programmed(problem, ask, ask.starts if problem.curve.free else 1)
    elif known is not None and ask.proved:
        solution = _continued(problem, known, Route.DESCENT)
    else:
        solution = _widely(problem, ask)
    if known is not None and known.total < solution.best * (1 - TOLERANCE):
        again = _continued(problem, known, Route.DESCENT if dense else Route.NLP)
        solution = again if again.best < solution.best else solution
    short = solution.status is Status.FEASIBLE and solution.route is Route.DESCENT
    if short and _moves_throughout(problem) and not time_up():
        end = Local.of(problem, solution.durations)
        solution = better_of(solution, _continued(problem, end, Route.NLP))
    if solution.found:
        return solution
    # Where no search found anything: equal durations, stretched until they pass.
    stretched = decided(problem, equal_start(problem), first_nodal(problem))
    if stretched is None:
        return solution
    answer = judged(problem, [stretched], made_up(problem, FLOORS[1]), solution.starts)
    return replace(answer, iterations=solution.iterations, build_seconds=solution.build_seconds)


def _continued(problem: Problem, motion: Local, route: Route) -> Solution:
    """What a search by a route makes of a motion that passes: no worse an answer."""
    h = motion.durations
    floor, found = np.minimum(made_up(problem, FLOORS[1]), 0.5 * h), [motion]
    if route is Route.DESCENT:
        found += exact_search(problem, h[None], floor)
    elif as_piecewise(problem.curve) is not None:
        found += _rounds(problem, h[None], floor, motion.nodal)
    return judged(problem, found, floor, 1, route)


def _moves_throughout(problem: Problem) -> bool:
    """Whether rounds of the NLP apply: segments move, something is limited, none by braking."""
    curve, sides = as_piecewise(problem.curve), problem.limits.sides
    moves = np.abs(np.diff(problem.waypoints, axis=0)).max(axis=1) > 0
    limited = (np.isfinite(sides) & (sides > 0)).any()
    limited &= not problem.limits.braking.any()
    return curve is not None and not curve.free and bool(moves.all() and limited)


def _programmed(problem: Problem, ask: _Ask, many: int = 1) -> Solution:
    """Rounds of the NLP from the usual start and random ones, or from those that are given."""
    starts = ask.initial
    if starts is None:
        plain = as_piecewise(problem.curve) is not None and not problem.curve.free
        usual = way_start(problem) if plain else equal_start(problem)
        more = random_starts(problem, many - 1, np.random.default_rng(ask.seed))
        starts = np.vstack([usual, more])
    floor = made_up(problem, FLOORS[1])
    found = _rounds(problem, starts, floor, first_nodal(problem))
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


def _widely(problem: Problem, ask: _Ask) -> Solution:
    """The answer by rounds of the NLP where these are quick, or else from a wide search."""
    given = ask.initial
    if given is not None:
        return _above_floors(problem, lambda _: given, FLOORS)
    quick = problem.segments >= SPARSE and _moves_throughout(problem)
    found = _programmed(problem, ask) if quick else None
    if found is None or found.status is not Status.CONVERGED:
        search = partial(basins, problem, ask.starts, ask.seed)
        searched = _above_floors(problem, search, FLOORS)
        if not searched.found:
            searched = _within_tolerance(problem, ask)
        found = searched if found is None else better_of(searched, found)
    return _shortened(problem, found)


def _above_floors(
    problem: Problem, points: Callable[[Array], Array], shares: tuple[float, ...]
) -> Solution:
    """Exact descents from points above a floor, and above a lower one while they end at it.

    Where they do to the last, the total only approaches its infimum: the totals at two floors,
    extrapolated to 0.
    """
    floor = made_up(problem, shares[0])
    answer = _descended(problem, points(floor), floor)
    for wide, share in pairwise(shares):
        if answer.status is not Status.NOT_ATTAINED:
            return answer
        floor = made_up(problem, share)
        lower = _descended(problem, np.vstack([points(floor), answer.durations]), floor)
        undercut = lower.total_time < answer.best * (1 - BETTER)
        if lower.total_time > answer.total_time * (1 + BETTER):
            return answer  # rounding costs more than the lower floor gains
        if lower.status is Status.FEASIBLE and not undercut:
            return answer  # unconverged, it shows no less that totals fall
        if lower.status is Status.NOT_ATTAINED:
            ratio, total = share / wide, lower.total_time
            slope = max(0.0, answer.total_time - total) / (1.0 - ratio)
            lower = replace(lower, infimum=max(0.0, total - slope * ratio))
            near = total - lower.best <= SAME_TOTAL * total  # else the estimate may be off by more
            if near and not _rises_below(problem, lower.durations, floor):
                return lower
        answer = lower
    return answer


def _descended(problem: Problem, points: Array, floor: Array) -> Solution:
    return judged(problem, exact_search(problem, points, floor), floor, len(points))


def _rises_below(problem: Problem, durations: Array, floor: Array) -> bool:
    """Whether a segment at its floor has something below it, where the total rises again.

    A way, which a joint covers in no time at all only if nothing limits it, or a bound.
    """
    at = on_floor(durations, floor)
    moves = (np.diff(problem.waypoints, axis=0) != 0).any(axis=1)
    first = list(problem.curve.waypoint_breaks[:-1])
    return bool((at & (problem.duration_lower > 0)).any() or (at[first] & moves).any())


def _within_tolerance(problem: Problem, ask: _Ask) -> Solution:
    """A search where limits leave no room inside them, or less than a wide search finds.

    So it is where a position range ends at the way-points, or bounds leave one duration vector. A
    descent needs room to move in: it is given half the checker's tolerance, and continues from its
    end within the limits themselves. Where nothing is there, the first end may pass all the same.
    """
    wide, floor = widened(problem, AIM), made_up(problem, DEEP[0])
    ends = exact_search(wide, basins(wide, ask.starts, ask.seed, floor), floor)
    if ends:
        # From the best basin: what way-points at the ends of a range leave may lie decades away.
        ends += exact_search(wide, shortened(problem, ends[0].durations, floor), floor)
    points = np.array([end.durations for end in ends]).reshape(-1, problem.segments)
    within = exact_search(problem, points, floor)
    answer = judged(problem, within, floor, len(within))
    if answer.found:
        return answer
    ends = [Local.of(problem, end.durations, converged=end.converged) for end in ends]
    answer = judged(problem, within + ends, floor, len(within) + len(ends))
    if not answer.found:
        return answer
    return replace(answer, status=Status.FEASIBLE, why=ONLY_TOLERANCE)


def _without_jumps(problem: Problem, solution: Solution) -> Solution:
    """The answer of the NLP where a curve that may jump must happen not to, in words of its own."""
    if solution.found:
        ended = [total for total in solution.totals if total < math.inf]
        why = f"shortest of {len(ended)} motions found at ratios at which the motion does not jump"
        return replace(solution, status=Status.FEASIBLE, why=why)
    places, ratios = forbidden_jumps(problem), problem.segments - 1
    equations = len(places) - problem.curve.free * len({j for *_, j in places})
    if equations <= ratios:
        return solution
    why = f"{ratios} ratios of durations would have to satisfy {equations} equations"
    return replace(solution, why=f"{solution.why}; {why}")


def _shortened(problem: Problem, solution: Solution) -> Solution:
    """The answer, or a better one in which a segment between close way-points is much shorter."""
    if solution.status is not Status.CONVERGED or apart(problem) or time_up():
        return solution
    starts = shortened(problem, solution.durations, made_up(problem, DEEP[-1]))
    if not len(starts):
        return solution
    found = _above_floors(problem, lambda _: starts, DEEP[-1:])
    if found.status is Status.NOT_ATTAINED:
        end = found.durations[None]
        found = _above_floors(problem, lambda _: end, DEEP)
    return replace(better_of(solution, found), starts=solution.starts + len(starts))
