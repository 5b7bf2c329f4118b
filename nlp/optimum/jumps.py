"""Curves that may jump where the limits forbid it: the smoother curve, or ratios without a jump.

A motion that passes is smooth up to the order of `Limits.smooth_orders`. Among the
curves of a declaration with less continuity, and derivatives that are free, those that pass are
therefore curves of the declaration with more of it. Where too little is free for that, the jumps
are equations for the ratios of the durations, which the NLP states.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...problem import QUANTITIES, Array, Problem, TrajgapError, as_piecewise, check, fit
from .decided import kept
from .program import free_values
from .solution import Solution, Status


def smoother(problem: Problem) -> Problem | None:
    """The problem on the declaration with the continuity that the limits ask for of some joint.

    None if nothing is to be raised, or no curve is left or its freedom is not nodal.
    """
    curve = as_piecewise(problem.curve)
    if curve is None or not curve.free:
        return None
    order = int(_orders(problem).max(initial=1))
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


def _orders(problem: Problem) -> NDArray[np.int64]:
    """Orders up to which joints that move must not jump."""
    moving = np.ptp(problem.waypoints, axis=0) > 0
    return np.asarray(problem.limits.smooth_orders[moving])


def same_motions(problem: Problem) -> bool:
    """Whether every motion that passes is one of the smoother problem's.

    A joint with fewer limits may jump in a derivative, and be faster for it.
    """
    return len(set(_orders(problem).tolist())) <= 1


def carried_over(problem: Problem, values: Array, durations: Array, to: Problem) -> Array | None:
    """Free derivatives of the same motions in another declaration, shape (motions, free, joints).

    None if the other declaration leaves nothing free. Durations are in s.
    """
    if not to.curve.free:
        return None
    found = [
        free_values(to.piecewise, fit(problem.curve, problem.waypoints, h, v))
        for h, v in zip(durations, values, strict=True)
    ]
    return np.array(found).reshape(len(durations), to.curve.free, len(problem.joints))


def as_answer(problem: Problem, found: Solution) -> Solution | None:
    """The answer of the smoother problem as one of the problem; None if it is none."""
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
    highest = QUANTITIES[int(_orders(problem).max())]
    note = f"joints without a {highest} limit are kept as smooth as the others"
    why = note if found.why is None else f"{found.why}; {note}"
    return replace(answer, status=Status.FEASIBLE, why=why)
