"""Solve the exact NLP from several starts and judge the answer."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Interpolant, Problem, TrajgapError, Verdict, check, fit
from ...problem.curves import coefficient_gradient, segment_peaks
from .curve_formulation import compiled_curve, curve_structure
from .curve_symbols import shape_key
from .curve_tracking import curve_multistart
from .feasibility import impossible
from .formulation import Form
from .optimality import kkt
from .polish import polish
from .solution import Solution, Status
from .starts import equal_start, first_nodal, screened_starts, settled
from .tracking import (
    Compiled,
    Local,
    compiled,
    merit,
    pack,
    solve_coarse,
    structure_of,
    track,
    unpack,
)

STARTS = 4
SAME = 1e-6
"""Relative difference below which two totals count as the same."""
FLOORS = (1e-3, 1e-4)
"""Smallest durations tried, relative to the mean, where the case sets no lower bound."""
KKT_TOLERANCE = 1e-8
POLISHED = 1e-11
"""KKT residual above which an answer is sharpened by Newton steps on its active set."""


def solve(
    problem: Problem,
    *,
    starts: int = STARTS,
    seed: int = 0,
    initial: ArrayLike | None = None,
    form: Form | None = None,
) -> Solution:
    """Best known total time of a problem with shared durations, from an exact NLP.

    Parameters
    ----------
    problem : Problem
        Its coupling is not looked at: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    starts : int
        Number of starts: equal durations first, then screened random ones.
    seed : int
        Seed of the random starts.
    initial : array_like, shape (starts, segments), optional
        Starts to use instead, s.
    form : Form, optional
        Reduced or lifted; by default the faster one for the size.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` has the wrong shape.
    """
    reason = impossible(problem)
    if reason is not None:
        return Solution(problem, Status.INFEASIBLE, reason)
    idle = idle_segments(problem)
    if idle:
        return _with_idle(problem, idle, starts, seed, initial, form)
    return _solve_moving(problem, starts, seed, initial, form)


def _solve_moving(
    problem: Problem, starts: int, seed: int, initial: ArrayLike | None, form: Form | None
) -> Solution:
    """`solve` for a problem without idle segments."""
    search, build_seconds = _search(problem, form)
    began = time.perf_counter()
    if initial is None:
        points = screened_starts(problem, starts, np.random.default_rng(seed))
    else:
        points = np.atleast_2d(np.asarray(initial, dtype=np.float64))
        if (
            points.shape[1:] != (problem.segments,)
            or not (np.isfinite(points) & (points > 0)).all()
        ):
            raise TrajgapError(
                f"initial: expected shape (starts, {problem.segments}) of positive durations, "
                f"got {np.asarray(initial).shape}"
            )
    mean = float(equal_start(problem).mean())
    solution, coarser = None, None
    for share in FLOORS:
        floor = share * mean
        found = search(points, floor)
        solution = _judged(problem, found, floor, len(points))
        if solution.status is Status.FEASIBLE and _reduced(problem, form):
            # Eliminating across very unequal durations loses digits; the lifted form does not.
            lifted = compiled(structure_of(problem, Form.LIFTED))
            found += _multistart(problem, lifted, points, floor)
            solution = _judged(problem, found, floor, len(points))
        if solution.status is not Status.NOT_ATTAINED:
            break
        if coarser is not None:
            solution = _approached(coarser, solution)
        coarser = solution
        assert solution.durations is not None
        points = solution.durations[None]
    assert solution is not None
    return replace(
        solution,
        build_seconds=build_seconds,
        solve_seconds=time.perf_counter() - began,
    )


def _search(
    problem: Problem, form: Form | None
) -> tuple[Callable[[Array, float], list[Local]], float]:
    """Local search from starts above a floor, and the time its build took, s."""
    if isinstance(problem.curve, Interpolant):
        build_ = compiled(structure_of(problem, form))
        return partial(_multistart, problem, build_), build_.build_seconds
    built = compiled_curve(curve_structure(problem))
    return partial(curve_multistart, problem, built), built.build_seconds


def _reduced(problem: Problem, form: Form | None) -> bool:
    declared = isinstance(problem.curve, Interpolant)
    return declared and structure_of(problem, form).form is Form.REDUCED


def _multistart(problem: Problem, build_: Compiled, points: Array, floor: float) -> list[Local]:
    """Local optima of all starts; the same coarse solution is tracked only once."""
    tracked: list[tuple[Array, Local]] = []
    found: list[Local] = []
    for start in points:
        near = settled(problem, start)
        x, scaled, success, iterations = solve_coarse(problem, build_, near, floor)
        coarse, _ = unpack(problem, build_.formulation, scaled, x)
        known = [
            local
            for h, local in tracked
            if np.abs(h - coarse).max() <= 1e-6 * coarse.sum() and local.feasible
        ]
        local = known[0] if known else track(problem, build_, x, scaled, floor)
        if success and not known:
            tracked.append((coarse, local))
        bar, _, _ = merit(problem, start, first_nodal(problem))
        if bar < local.total:
            # The coarse solve left the start's basin for a worse one: descend from the start.
            first = pack(problem, build_.formulation, scaled, start, first_nodal(problem))
            direct = track(problem, build_, first, scaled, floor)
            local = min(local, direct, key=lambda one: one.total)
        found.append(replace(local, iterations=local.iterations + iterations))
    return found


def _judged(problem: Problem, found: list[Local], floor: float, starts: int) -> Solution:
    """The best answer that the checker passes, with its optimality conditions."""
    iterations = sum(local.iterations for local in found)
    feasible = [local for local in found if local.feasible]
    if not feasible:
        return Solution(
            problem,
            *_nothing_found(problem, found),
            starts=starts,
            iterations=iterations,
        )
    best = min(feasible, key=lambda local: local.total)
    durations, report = best.durations, kkt(problem, best.durations, best.nodal)
    if report.residual > POLISHED:
        durations, report = polish(problem, durations, report)
    status = Status.OPTIMAL if report.residual <= KKT_TOLERANCE else Status.FEASIBLE
    why = None if status is Status.OPTIMAL else f"KKT residual {report.residual:.1e}"
    verdict = check(problem, durations, best.nodal)
    if verdict.verdict is Verdict.DISCONTINUOUS:
        jumps = sum(jump.order < 2 for jump in verdict.jumps)
        note = f"limits kept inside the segments; {jumps} jumps of velocity between them"
        why = note if why is None else f"{why}; {note}"
    shrinking = _at_floor(problem, durations, floor)
    if shrinking:
        status = Status.NOT_ATTAINED
        names = ", ".join(str(k + 1) for k in shrinking)
        why = f"the total falls as the duration of segment {names} goes to 0"
    return Solution(
        problem,
        status,
        why,
        durations=durations,
        nodal=best.nodal,
        check=verdict,
        kkt_residual=report.residual,
        active=report.active,
        starts=starts,
        starts_at_best=sum(local.total <= best.total * (1 + SAME) for local in feasible),
        iterations=iterations,
        totals=tuple(local.total if local.feasible else float("inf") for local in found),
    )


def _at_floor(problem: Problem, durations: Array, floor: float) -> list[int]:
    return np.flatnonzero((problem.duration_lower == 0) & (durations <= 1.01 * floor)).tolist()


def idle_segments(problem: Problem) -> list[int]:
    """Segments in which nothing moves and whose duration nothing else depends on."""
    if problem.curve.free:
        return []
    if not isinstance(problem.curve, Interpolant):
        if not shape_key(problem):
            return []
        still = segment_peaks(problem.curve, problem.waypoints).max(axis=(1, 2)) == 0.0
        return np.flatnonzero(still).tolist()
    h = equal_start(problem)
    trajectory = fit(problem.curve, problem.waypoints, h)
    gradient = coefficient_gradient(problem.piecewise, problem.waypoints, h).durations
    size = 1e-12 * max(1.0, float(np.abs(trajectory.scaled).max()))
    still = np.abs(trajectory.scaled[:, 1:]).max(axis=(1, 2)) <= size
    apart = np.abs(gradient * h[:, None, None, None]).max(axis=(1, 2, 3)) <= size
    return np.flatnonzero(still & apart).tolist()


def _with_idle(
    problem: Problem,
    idle: list[int],
    starts: int,
    seed: int,
    initial: ArrayLike | None,
    form: Form | None,
) -> Solution:
    """Solve with idle segments held at an ordinary duration, then give them their least one."""
    held = equal_start(problem)
    low, high = problem.duration_lower.copy(), problem.duration_upper.copy()
    low[idle] = high[idle] = held[idle]
    if len(idle) == problem.segments:
        h, solution = low.copy(), Solution(problem, Status.OPTIMAL)
    else:
        core = replace(problem, duration_lower=low, duration_upper=high)
        solution = _solve_moving(core, starts, seed, initial, form)
        if solution.durations is None:
            return replace(solution, problem=problem)
        h = solution.durations.copy()
    h[idle] = problem.duration_lower[idle]
    vanishing = [k for k in idle if h[k] == 0]
    infimum = float(h.sum()) if vanishing else None
    h[vanishing] = FLOORS[-1] * held.mean()
    report = kkt(problem, h)
    answer = replace(
        solution,
        problem=problem,
        durations=h,
        check=check(problem, h),
        kkt_residual=report.residual,
        active=report.active,
    )
    if not vanishing:
        return answer
    names = ", ".join(str(k + 1) for k in vanishing)
    return replace(
        answer,
        status=Status.NOT_ATTAINED,
        why=f"nothing moves in segment {names}: the total falls as its duration goes to 0",
        infimum=infimum,
        kkt_residual=solution.kkt_residual,
        active=solution.active,
    )


def _nothing_found(problem: Problem, found: list[Local]) -> tuple[Status, str]:
    worst = min(
        (check(problem, local.durations, local.nodal).max_violation for local in found),
        default=float("inf"),
    )
    limits = problem.limits
    stretchable = (
        np.isinf(problem.duration_upper).all()
        and problem.curve.homogeneous
        and not limits.limits_position
        and (limits.derivatives > 0).all()
    )
    if stretchable:
        return Status.FAILED, "the solver reached no feasible point, though stretching gives one"
    return (
        Status.INFEASIBLE,
        f"no feasible durations found from {len(found)} starts; the least excess over a limit was "
        f"{worst:.3g} (relative). This is local evidence, not a proof",
    )


def _approached(coarser: Solution, finer: Solution) -> Solution:
    """The infimum by extrapolating the totals at two floors to 0."""
    ratio = FLOORS[1] / FLOORS[0]
    slope = (coarser.total_time - finer.total_time) / (1.0 - ratio)
    infimum = max(0.0, finer.total_time - slope * ratio)
    return replace(finer, infimum=infimum)
