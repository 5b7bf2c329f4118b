"""Local optima of several starts by the tracked NLP, whatever the kind of curve."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ...problem import Array, Problem
from .asked import Ask
from .clock import time_up
from .curve_formulation import compiled_curve, curve_structure
from .curve_tracking import curve_multistart
from .formulation import Form
from .ipopt import Compiled, compiled, structure_of
from .starts import first_nodal, settled
from .tracking import Local, merit, pack, solve_coarse, track, unpack


def tracked_search(
    problem: Problem, ask: Ask
) -> tuple[Callable[[Array, float], list[Local]], float]:
    """Local search from starts above a floor, and how long this call waited for its build, s.

    What an earlier call has built is kept, and costs nothing again.
    """
    began = time.perf_counter()
    if problem.curve.piecewise is not None:
        build_ = compiled(structure_of(problem, ask.form))
        search = partial(tracked_multistart, problem, build_)
        return search, time.perf_counter() - began
    built = compiled_curve(curve_structure(problem))
    return partial(curve_multistart, problem, built), time.perf_counter() - began


def eliminating(problem: Problem, form: Form | None) -> bool:
    """Whether the form eliminates the coefficients: the reduced one of piecewise polynomials."""
    if problem.curve.piecewise is None:
        return False
    return structure_of(problem, form).form is Form.REDUCED


def tracked_multistart(
    problem: Problem, build_: Compiled, points: Array, floor: float
) -> list[Local]:
    """Local optima of all starts; the same coarse solution is tracked only once."""
    tracked: list[tuple[Array, Local]] = []
    found: list[Local] = []
    for start in points:
        if found and time_up():
            break
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
