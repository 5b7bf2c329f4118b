"""Local optima of other curves: solve on a grid of places, then follow the true extrema."""

from __future__ import annotations

import numpy as np

from ...problem import Array, Problem, Verdict, check, evaluate
from .clock import TooLong, time_up
from .curve_formulation import CompiledCurve, ScaledCurve, follow, packed, scaled_curve
from .tracking import Local, run

_PASSES = 40
"""Solves from one start: a bound against endless shrinking of the trust region."""


def curve_merit(problem: Problem, h: Array) -> tuple[float, Array]:
    """Exact total after repair by stretching, or a penalty where stretching does not repair.

    Jumps between segments do not count: they are a verdict of their own.
    """
    total, stretch, outside = float(h.sum()), float(evaluate(problem, h[None]).stretch[0]), 0.0
    if not np.isfinite(stretch):
        return np.inf, h
    if problem.limits.limits_position:
        peaks = check(problem, h).peaks
        outside = max(p.ratio - 1.0 for p in peaks if p.quantity in ("position", "curve"))
    short = float((problem.duration_lower / h).max()) - 1.0
    repaired = h * max(1.0, stretch)
    over = float((repaired / problem.duration_upper).max()) - 1.0
    if max(outside, short, over) <= 1e-12:
        return float(repaired.sum()), repaired
    return total * (1.0 + 10.0 * max(outside, short, over, stretch - 1.0)), h


def _bounds(problem: Problem, unit: float, floor: float) -> tuple[Array, Array]:
    low = np.maximum(problem.duration_lower, floor) / unit
    return low, np.maximum(problem.duration_upper / unit, low)


def curve_coarse(
    problem: Problem, built: CompiledCurve, start: Array, floor: float
) -> tuple[Array, ScaledCurve, bool, int]:
    """Solve on the grid of places from one start; returns durations in s."""
    unit = float(start.mean())
    scaled = scaled_curve(problem, unit)
    bounds = _bounds(problem, unit, floor)
    p = packed(scaled, *follow(built, scaled, None))
    if time_up():
        return start, scaled, False, 0
    try:
        solver = built.cold
    except TooLong:
        return start, scaled, False, 0
    x, _, success, iterations = run(solver, built.formulation, start / unit, p, bounds)
    return x * unit, scaled, success, iterations


def curve_track(
    problem: Problem, built: CompiledCurve, h: Array, scaled: ScaledCurve, floor: float
) -> Local:
    """Put the slots on the true extrema and solve again, inside a trust region, until they stay.

    As `tracking.track`: every step is judged by the exact repaired total.
    """
    unit = scaled.time_unit
    wide = _bounds(problem, unit, floor)
    best, h = curve_merit(problem, np.clip(h, wide[0] * unit, wide[1] * unit))
    radius, step, iterations, converged, duals = 0.5, np.inf, 0, False, None
    for _ in range(_PASSES):
        if time_up():
            break
        x = h / unit
        p = packed(scaled, *follow(built, scaled, h))
        bounds = (
            np.maximum(wide[0], x * (1.0 - radius)),
            np.minimum(wide[1], x * (1.0 + 2.0 * radius)),
        )
        near = duals is not None and step < 1e-2
        try:
            solver, again = built.warm if near else built.cold, built.cold
        except TooLong:
            break
        x_new, new_duals, success, count = run(
            solver,
            built.formulation,
            x,
            p,
            bounds,
            duals if near else None,
        )
        iterations += count
        if not success and near:
            x_new, new_duals, success, count = run(again, built.formulation, x, p, bounds)
            iterations += count
        moved = float(np.abs(x_new / x - 1.0).max())
        total, h_new = curve_merit(problem, x_new * unit)
        if total < best * (1.0 + 1e-13):
            h, best, duals, step = h_new, total, new_duals, moved
            radius = min(0.5, 2.0 * radius)
            if success and moved < 1e-9:
                converged = True
                break
        else:
            if moved < 1e-7:
                converged = success
                break
            radius, step, duals = 0.25 * min(radius, moved), moved, None
    kept = check(problem, h).limits is Verdict.PASS
    return Local(h, None, float(h.sum()), converged, kept, iterations)


def curve_multistart(
    problem: Problem, built: CompiledCurve, points: Array, floor: float
) -> list[Local]:
    """Local optima of all starts; the same coarse solution is tracked only once."""
    tracked: list[tuple[Array, Local]] = []
    found: list[Local] = []
    for start in points:
        if found and time_up():
            break
        coarse, scaled, success, iterations = curve_coarse(problem, built, start, floor)
        usable = success and np.isfinite(coarse).all()
        known = [
            local
            for h, local in tracked
            if np.abs(h - coarse).max() <= 1e-6 * coarse.sum() and local.feasible
        ]
        first = coarse if usable else start
        local = known[0] if known else curve_track(problem, built, first, scaled, floor)
        if usable and not known:
            tracked.append((coarse, local))
        bar, _ = curve_merit(problem, start)
        if bar < local.total:
            # The coarse solve left the start's basin for a worse one: descend from the start.
            direct = curve_track(problem, built, start, scaled, floor)
            local = min(local, direct, key=lambda one: one.total)
        found.append(
            Local(
                local.durations,
                None,
                local.total,
                local.converged,
                local.feasible,
                local.iterations + iterations,
            )
        )
    return found
