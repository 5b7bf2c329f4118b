"""Descents from several starts, each end judged by the checker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import Array, Problem, TrajgapError, check
from .basins import usual_basins
from .clock import time_up
from .decided import kept, tolerated
from .descent import Descent, descend
from .local import Local
from .starts import ROUND, LogBox, box_above, made_up

RESUMPTIONS = 8
"""Most descents that go on from the end of the best one: two or three suffice where any does."""
WORTHWHILE = 1e-9
"""Relative gain of a resumed descent from which the next one is tried."""


def as_local(problem: Problem, found: Descent) -> Local | None:
    """The end of a descent, judged by the checker; None where float64 has lost the curve.

    It has where a segment at a virtual break shrinks towards 0: the system is singular to rounding.
    """
    h = np.clip(found.durations, problem.duration_lower, problem.duration_upper)
    try:
        verdict = check(problem, h)
        if found.feasible and 1.0 < verdict.stretch < 1.0 + ROUND and problem.curve.homogeneous:
            h = np.clip(h * verdict.stretch, problem.duration_lower, problem.duration_upper)
            verdict = check(problem, h)
    except TrajgapError:
        return None
    return Local(h, None, float(h.sum()), found.converged, kept(problem, verdict), found.steps)


def exact_search(problem: Problem, points: Array, floor: Array) -> list[Local]:
    """Local optima of all starts, above the floors; starts that end together are kept apart."""
    box = box_above(problem, floor)
    found: list[Local] = []
    for start in points:
        if found and time_up():
            break
        local = as_local(problem, descend(problem, start, box))
        if local is not None:
            found.append(local)
    return _resumed(problem, found, box)


def _resumed(problem: Problem, found: list[Local], box: LogBox) -> list[Local]:
    """The ends of descents, the best one descended from again for as long as that gains.

    A descent may stop short where its Hessian, made along a bent valley, fits no longer; from its
    end a new one, with a new Hessian, goes on.
    """
    for _ in range(RESUMPTIONS):
        best = min(
            (i for i, local in enumerate(found) if local.feasible),
            key=lambda i: found[i].total,
            default=None,
        )
        if best is None or found[best].converged or time_up():
            break
        before = found[best]
        after = as_local(problem, descend(problem, before.durations, box))
        if after is None or not (after.feasible and after.total <= before.total):
            break
        found[best] = replace(after, iterations=before.iterations + after.iterations)
        if after.total > before.total * (1.0 - WORTHWHILE):
            break
    return found


def tolerated_search(problem: Problem, count: int, seed: int, share: float) -> list[Local]:
    """Searches where limits leave no room inside them, only the tolerance of the checker.

    So it is where a position range ends at the way-points, or bounds leave one duration vector. A
    descent needs room to move in: it is given half the tolerance, and `check` judges its end.
    """
    wide, floor = tolerated(problem), made_up(problem, share)
    points = [basin.durations for basin in usual_basins(wide, count, seed, floor)]
    ends = exact_search(wide, np.array(points), floor)
    return [replace(end, feasible=kept(problem, check(problem, end.durations))) for end in ends]
