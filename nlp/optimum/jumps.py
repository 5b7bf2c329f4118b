"""Curves that may jump where the limits forbid it: the smoother curve, or ratios without a jump.

A motion that passes is smooth in velocity, and in acceleration where jerk is limited. Among the
curves of a declaration with less continuity, and derivatives that are free, those that pass are
therefore curves of the declaration with more of it. Where too little is free for that, the jumps
are equations for the ratios of the durations. A uniform stretch keeps them: what is found is
stretched until it is tight. Where fewer equations than ratios are left, the shortest of a whole set
of motions is looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...problem import Array, CurveError, Problem, TrajgapError, check, fit
from .clock import time_up
from .decided import decided, kept
from .feasibility import apart
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


TRIES = 24
"""Random ratios from which the equations are solved: a problem with an answer has one or two, and
about every third start ends at one."""
STEPS = 40
"""Steps of one try: those that end at an answer need fewer, the others run into the bounds."""
LAST_BITS = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
"""Tolerances that leave rounding alone."""
SPREAD, WIDEST = 2.0, 6.0
"""Log ratios of the starts, and at most: a factor of 7, and of 400."""
MATCHED = 1e-10
"""Jump, relative to its terms, that counts as none: a tenth of what the checker grants."""
APART = 1e-6
"""Log ratios that lie further apart are other solutions."""
SETS = 4
"""Ends from which steps along a whole set of solutions are taken: two to see that they agree, and
two more, since a set may have several parts."""
MOVE, SMALLEST_MOVE = 0.3, 1e-7
"""First and last step along a set of solutions, in log ratios: the total is then settled to less
than what the checker's tolerance gives away."""
DIFFERENCE = 1e-6
"""Step of the differences that give the directions of that set, in log ratios."""
FLAT = 1e-5
"""Share of the largest singular value below which a direction changes no jump."""

Motion = tuple[Array, Array | None]
"""Durations, s, and free derivatives, where the declaration leaves some."""


def matched(problem: Problem, seed: int) -> list[Motion]:
    """Motions that pass although their declaration lets them jump, shortest first.

    Parameters
    ----------
    problem : Problem
    seed : int

    Returns
    -------
    list of (durations, free derivatives)
        s. None found proves nothing.
    """
    curve, n = problem.curve.piecewise, problem.segments
    places = _places(problem)
    if curve is None or apart(problem) or not curve.homogeneous or not places:
        return []
    if curve.free and smoother(problem) is not None:
        return []  # the same motions are those of a declaration that cannot jump

    def jumps(ratios: Array) -> Array:
        found = _least_jumps(problem, places, np.exp(np.append(0.0, ratios)))
        return np.ones(len(places)) if found is None else found[1]

    generator = np.random.default_rng(seed)
    ratios: list[Array] = []
    found: list[Motion] = []
    walks = 0
    for _ in range(TRIES):
        if time_up() or walks == SETS:
            break
        start = generator.uniform(-SPREAD, SPREAD, n - 1)
        end = _onto(jumps, start)
        if end is None or any(np.abs(end - other).max() <= APART for other in ratios):
            continue
        if len(_directions(jumps, end)):
            walks += 1
            end = _shortened(problem, places, jumps, end)
        if all(np.abs(end - other).max() > APART for other in ratios):
            ratios.append(end)
            motion = _tight(problem, places, end)
            if motion is not None:
                found.append(motion)
    return sorted(found, key=lambda one: float(one[0].sum()))


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


def _onto(jumps: Callable[[Array], Array], start: Array) -> Array | None:
    """The nearest ratios without a jump, if a search from the start ends at some."""
    from scipy.optimize import least_squares  # a quarter of a second, and few need it

    end = least_squares(jumps, start, bounds=(-WIDEST, WIDEST), max_nfev=STEPS, **LAST_BITS)
    return end.x if np.abs(end.fun).max() <= MATCHED else None


def _least_jumps(
    problem: Problem, places: list[tuple[int, int, int]], h: Array
) -> tuple[Array | None, Array] | None:
    """The free derivatives with the least jumps at these durations, and those jumps, relative.

    A jump is linear in the free derivatives of its own joint; None where there is no curve.
    """
    try:
        moved = fit(problem.curve, problem.waypoints, h, _nodal(problem, {}))
    except CurveError:
        return None
    sides = np.array([moved.sides(b, j, order)[:2] for b, j, order in places])
    base = sides[:, 1] - sides[:, 0]
    values: dict[tuple[int, int], float] = {}
    for i in range(problem.curve.free):
        every = {(i, j): 1.0 for j in range(len(problem.joints))}
        one = fit(problem.curve, problem.waypoints, h, _nodal(problem, every))
        sides = np.array([one.sides(b, j, order)[:2] for b, j, order in places])
        for at in range(len(places)):
            values[i, at] = float(sides[at, 1] - sides[at, 0] - base[at])
    nodal: dict[tuple[int, int], float] = {}
    for j in sorted({j for _, j, _ in places}) if problem.curve.free else []:
        own = [at for at, place in enumerate(places) if place[1] == j]
        matrix = np.array([[values[i, at] for i in range(problem.curve.free)] for at in own])
        solved = np.linalg.lstsq(matrix, -base[own], rcond=None)[0]
        nodal |= {(i, j): float(x) for i, x in enumerate(solved)}
    found = _nodal(problem, nodal)
    moved = fit(problem.curve, problem.waypoints, h, found)
    left, right, scale = np.array([moved.sides(b, j, order) for b, j, order in places]).T
    return found, np.asarray((right - left) / np.where(scale > 0, scale, 1.0))


def _nodal(problem: Problem, values: dict[tuple[int, int], float]) -> Array | None:
    """Free derivatives, shape (free, joints), 0 where nothing else is said; None without any."""
    if not problem.curve.free:
        return None
    nodal = np.zeros((problem.curve.free, len(problem.joints)))
    for place, value in values.items():
        nodal[place] = value
    return nodal


def _shortened(
    problem: Problem,
    places: list[tuple[int, int, int]],
    jumps: Callable[[Array], Array],
    ratios: Array,
) -> Array:
    """The ratios of the shortest motion that steps along the solutions lead to."""
    size = MOVE
    total = _total(problem, places, ratios)
    while size > SMALLEST_MOVE and np.isfinite(total) and not time_up():
        better = False
        for direction in _directions(jumps, ratios):
            for sign in (1.0, -1.0):
                trial = np.clip(ratios + sign * size * direction, -WIDEST, WIDEST)
                end = _onto(jumps, trial)
                if end is None or not _total(problem, places, end) < total:
                    continue
                ratios, total, better = end, _total(problem, places, end), True
                break
        size = size if better else 0.5 * size
    return ratios


def _directions(jumps: Callable[[Array], Array], ratios: Array) -> Array:
    """Orthogonal directions in which no jump arises, shape (directions, ratios)."""
    steps = DIFFERENCE * np.eye(ratios.size)
    columns = [(jumps(ratios + s) - jumps(ratios - s)) / (2 * DIFFERENCE) for s in steps]
    _, sizes, turned = np.linalg.svd(np.array(columns).T)
    rank = int((sizes > FLAT * max(float(sizes.max(initial=0.0)), 1.0)).sum())
    return np.asarray(turned[rank:])


def _stretched(problem: Problem, places: list[tuple[int, int, int]], ratios: Array) -> Motion:
    """The motion with these ratios, stretched to its limits and lower bounds."""
    h = np.exp(np.append(0.0, ratios))
    found = _least_jumps(problem, places, h)
    nodal = None if found is None else found[0]
    stretch = float(check(problem, h, nodal).stretch)
    factor = float(np.max(problem.duration_lower / h, initial=stretch))
    return h * factor, None if nodal is None else slowed(problem, nodal, factor)


def _total(problem: Problem, places: list[tuple[int, int, int]], ratios: Array) -> float:
    """Total of the stretched motion, s; inf beyond an upper bound."""
    h, _ = _stretched(problem, places, ratios)
    inside = np.isfinite(h).all() and (h <= problem.duration_upper).all()
    return float(h.sum()) if inside else float("inf")


def _tight(problem: Problem, places: list[tuple[int, int, int]], ratios: Array) -> Motion | None:
    """The stretched motion, moved inside its limits until the checker passes it."""
    h, nodal = _stretched(problem, places, ratios)
    local = decided(problem, h, nodal)
    if local is None or not kept(problem, check(problem, local.durations, local.nodal)):
        return None
    return local.durations, local.nodal


def _places(problem: Problem) -> list[tuple[int, int, int]]:
    """Break, joint and order of each jump that the declaration allows and the limits forbid."""
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
