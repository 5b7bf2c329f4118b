"""Curves that may jump where the limits forbid it: the smoother curve, or ratios without a jump.

A motion that passes is smooth in velocity, and in acceleration where jerk is limited. Among the
curves of a declaration with less continuity, and derivatives that are free, those that pass are
therefore curves of the declaration with more of it. Where too little is free for that, the jumps
are equations for the ratios of the durations. A uniform stretch keeps them: what is found is
stretched until it is tight. Where fewer equations than ratios are left, the shortest of a whole set
of motions is looked for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...problem import Array, CurveError, Problem, TrajgapError, check, fit
from .clock import time_up
from .decided import Motion, decided, kept
from .feasibility import apart
from .optimality import Local
from .program import free_values
from .solution import Solution, Status
from .starts import slowed


def smoother(problem: Problem) -> Problem | None:
    """The problem on the declaration with the continuity that the limits ask for of some joint.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Problem or None
        None where nothing is to be raised, or no curve is left or its freedom is not nodal.
    """
    curve = problem.curve.piecewise
    if curve is None or not curve.free:
        return None
    order = 2 if _jerk_limited(problem).any() else 1
    raised = tuple(max(c, order) for c in curve.continuity)
    if raised == curve.continuity:
        return None
    try:
        declared = replace(curve, continuity=raised)
        if declared.free:
            declared.completed()
    except TrajgapError:
        return None
    return replace(problem, curve=declared)


def _jerk_limited(problem: Problem) -> Array:
    """Joints that move and whose jerk is limited."""
    moving = np.ptp(problem.waypoints, axis=0) > 0
    return np.asarray(problem.limits.limited[:, 2] & moving)


def same_motions(problem: Problem) -> bool:
    """Whether every motion that passes is one of the smoother problem's.

    A joint without a limit of its jerk may jump in acceleration, and be faster for it.
    """
    limited = _jerk_limited(problem)
    still = np.ptp(problem.waypoints, axis=0) == 0
    return bool((limited | still).all()) or not limited.any()


def carried_over(problem: Problem, values: Array, durations: Array, to: Problem) -> Array | None:
    """Free derivatives of the same motions in another declaration, shape (motions, free, joints).

    Parameters
    ----------
    problem : Problem
        The motions are its.
    values : ndarray, shape (motions, free, joints)
    durations : ndarray, shape (motions, segments)
        s.
    to : Problem

    Returns
    -------
    ndarray or None
        None where the other declaration leaves nothing free.
    """
    if not to.curve.free:
        return None
    found = [
        free_values(to.piecewise, fit(problem.curve, problem.waypoints, h, v))
        for h, v in zip(durations, values, strict=True)
    ]
    return np.array(found).reshape(len(durations), to.curve.free, len(problem.joints))


def as_answer(problem: Problem, found: Solution) -> Solution | None:
    """The answer of the smoother problem as one of the problem; None where it is none.

    Parameters
    ----------
    problem : Problem
    found : Solution
        Of `smoother`.

    Returns
    -------
    Solution or None
    """
    if not found.found:
        proved = found.status is Status.INFEASIBLE
        return replace(found, problem=problem) if proved and same_motions(problem) else None
    none = np.zeros((0, len(problem.joints)))
    own = none if found.nodal is None else found.nodal
    values = carried_over(found.problem, own[None], found.durations[None], problem)
    assert values is not None
    verdict = check(problem, found.durations, values[0])
    if not kept(problem, verdict):
        return None
    answer = replace(found, problem=problem, nodal=values[0], check=verdict)
    if same_motions(problem):
        return answer
    note = "the joints without a limit of their jerk are held as smooth as the others"
    why = note if found.why is None else f"{found.why}; {note}"
    return replace(answer, status=Status.FEASIBLE, why=why)


@dataclass(frozen=True)
class Matching:
    """Settings of the search for ratios without a jump; lengths are in log ratios."""

    tries: int = 24
    """Random ratios from which the equations are solved: a problem with an answer has one or two,
    and about every third start ends at one."""
    steps: int = 40
    """Of one try: those that end at an answer need fewer, the others run into the bounds."""
    spread: float = 2.0
    """Of the starts: a factor of 7."""
    widest: float = 6.0
    """Of all that is looked at: a factor of 400."""
    matched: float = 1e-10
    """Jump, relative to its terms, that counts as none: a tenth of what the checker grants."""
    apart: float = 1e-6
    """Ratios that lie further apart are other solutions."""
    sets: int = 4
    """Ends from which steps along a whole set of solutions are taken: two to see that they agree,
    and two more, since a set may have several parts."""
    move: float = 0.3
    """First step along a set of solutions."""
    smallest_move: float = 1e-7
    """Last one: the total is settled to less than what the checker's tolerance gives away."""
    flat: float = 1e-5
    """Share of the largest singular value below which a direction changes no jump."""


MATCHING = Matching()
"""What ratios without a jump are looked for with."""
Places = list[tuple[int, int, int]]
"""Break, joint and order of each jump that the declaration allows and the limits forbid."""


def matched(problem: Problem, seed: int) -> list[Local]:
    """Motions that pass although their declaration lets them jump, shortest first.

    Parameters
    ----------
    problem : Problem
    seed : int

    Returns
    -------
    list of Local
        None found proves nothing.
    """
    curve, places, by = problem.curve.piecewise, _places(problem), MATCHING
    if curve is None or apart(problem) or not curve.homogeneous or not places:
        return []
    if curve.free and smoother(problem) is not None:
        return []  # the same motions are those of a declaration that cannot jump
    generator = np.random.default_rng(seed)
    ratios: list[Array] = []
    found: list[Local] = []
    walks = 0
    for _ in range(by.tries):
        if time_up() or walks == by.sets:
            break
        start = generator.uniform(-by.spread, by.spread, problem.segments - 1)
        end = _onto(problem, places, start)
        if end is None or any(np.abs(end.x - other).max() <= by.apart for other in ratios):
            continue
        if len(_flat(end)):
            walks += 1
            end = _shortened(problem, places, end)
        if all(np.abs(end.x - other).max() > by.apart for other in ratios):
            ratios.append(end.x)
            local = decided(problem, *_tight(problem, places, end.x))
            if local is not None:
                found.append(local)
    return sorted(found, key=lambda one: one.total)


def jump_equations(problem: Problem) -> tuple[int, int]:
    """How many equations ratios of durations must meet for no jump, and how many ratios there are.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    equations, ratios : int
        No equations where nothing that is allowed is forbidden.
    """
    places = _places(problem)
    joints = {j for _, j, _ in places}
    return max(0, len(places) - problem.curve.free * len(joints)), problem.segments - 1


def _onto(problem: Problem, places: Places, start: Array) -> Any:
    """The nearest ratios without a jump, as SciPy's result, if a search ends at some; else None."""
    from scipy.optimize import least_squares  # a quarter of a second, and few need it

    def jumps(ratios: Array) -> Array:
        try:
            return _least_jumps(problem, places, np.exp(np.append(0.0, ratios)))[1]
        except CurveError:
            return np.ones(len(places))

    bits, by = 1e-15, MATCHING  # tolerances that leave rounding alone
    end = least_squares(
        jumps, start, bounds=(-by.widest, by.widest), max_nfev=by.steps,
        xtol=bits, ftol=bits, gtol=bits, jac="3-point",
    )  # fmt: skip
    return end if np.abs(end.fun).max() <= by.matched else None


def _flat(end: Any) -> Array:
    """Orthogonal directions in which no jump arises, shape (directions, ratios)."""
    _, sizes, turned = np.linalg.svd(end.jac)
    rank = int((sizes > MATCHING.flat * max(float(sizes.max(initial=0.0)), 1.0)).sum())
    return np.asarray(turned[rank:])


def _least_jumps(problem: Problem, places: Places, h: Array) -> tuple[Array | None, Array]:
    """The free derivatives with the least jumps at these durations, and those jumps, relative.

    A jump is linear in the free derivatives of its own joint.
    """
    free, joints = problem.curve.free, len(problem.joints)

    def sides(nodal: Array | None) -> Array:
        moved = fit(problem.curve, problem.waypoints, h, nodal)
        return np.array([moved.sides(b, j, order) for b, j, order in places]).T

    nodal = np.zeros((free, joints)) if free else None
    left, right, scale = sides(nodal)
    if nodal is not None:
        each = np.eye(free)[:, :, None] * np.ones(joints)
        effects = np.array([side[1] - side[0] for side in map(sides, each)]) - (right - left)
        of = np.array([j for _, j, _ in places])
        for j in np.unique(of):
            own = of == j
            wanted = (left - right)[own]
            nodal[:, j] = np.linalg.lstsq(effects[:, own].T, wanted, rcond=None)[0]
        left, right, scale = sides(nodal)
    return nodal, np.asarray((right - left) / np.where(scale > 0, scale, 1.0))


def _shortened(problem: Problem, places: Places, end: Any) -> Any:
    """The end of steps along a set of solutions to the ratios of its shortest motion."""
    size, total = MATCHING.move, _total(problem, places, end.x)
    while size > MATCHING.smallest_move and np.isfinite(total) and not time_up():
        for step in (way * size * one for one in _flat(end) for way in (1.0, -1.0)):
            inside = np.clip(end.x + step, -MATCHING.widest, MATCHING.widest)
            trial = _onto(problem, places, inside)
            if trial is not None and _total(problem, places, trial.x) < total:
                end, total = trial, _total(problem, places, trial.x)
                break
        else:
            size *= 0.5
    return end


def _tight(problem: Problem, places: Places, ratios: Array) -> Motion:
    """The motion with these ratios, stretched to its limits and lower bounds."""
    h = np.exp(np.append(0.0, ratios))
    nodal, _ = _least_jumps(problem, places, h)
    stretch = float(check(problem, h, nodal).stretch)
    factor = float(np.max(problem.duration_lower / h, initial=stretch))
    return h * factor, None if nodal is None else slowed(problem, nodal, factor)


def _total(problem: Problem, places: Places, ratios: Array) -> float:
    """Total of the tight motion, s; inf beyond an upper bound."""
    h, _ = _tight(problem, places, ratios)
    inside = np.isfinite(h).all() and (h <= problem.duration_upper).all()
    return float(h.sum()) if inside else float("inf")


def _places(problem: Problem) -> Places:
    """Jumps that the declaration allows and the limits forbid."""
    curve = problem.curve.piecewise
    if curve is None:
        return []
    return [
        (b, j, order)
        for b in range(1, curve.segments)
        for j in range(len(problem.joints))
        for order in (1, 2)
        if order > curve.continuity[b - 1]
        and (order == 1 or problem.limits.limited[j, 2])
        and np.ptp(problem.waypoints[:, j]) > 0
    ]
