"""Motions at their limits, moved inside by as much as rounding blurs them, so that they pass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import QUANTITIES, Array, Check, Problem, Verdict, check
from .descent import LogBox, descend
from .tracking import Local

ROUNDS = 6
"""Stretches that are tried: the bound on rounding errors changes little with each."""
AIM = 5e-10
"""Relative excess, rounding included, that a stretch aims at: half the checker's tolerance."""
NARROWINGS = 3
"""Descents within narrower limits: a shorter motion has larger rounding errors."""
DEEPER_INSIDE = 2.0
"""By how many bounds on rounding errors limits are narrowed where no stretch is possible."""


def kept(problem: Problem, verdict: Check) -> bool:
    """Whether a motion counts as feasible: curves that always jump are judged by their limits."""
    if problem.curve.piecewise is not None:
        return verdict.verdict is Verdict.PASS
    return verdict.limits is Verdict.PASS


def decided(problem: Problem, h: Array, nodal: Array | None = None) -> Local | None:
    """A motion that the checker passes, beside one that it does not: slightly longer, or None.

    Where way-points nearly coincide, the bound on rounding errors of a tight motion exceeds the
    checker's tolerance: it is *undecided*, though a motion longer by that bound passes. The same
    stretch repairs a motion that exceeds its limits.

    Parameters
    ----------
    problem : Problem
    h : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), optional

    Returns
    -------
    Local or None
        With what was given as ``tight``.
    """
    found = _stretched(problem, h, nodal)
    # A descent changes each duration by itself, which fixed ratios do not allow.
    if found is None and not problem.curve.free and problem.ratios is None:
        found = _narrowed(problem, h)
    if found is None:
        return None
    durations, values = found
    return Local(durations, values, float(durations.sum()), True, True, 0, (h, nodal))


def _blur(problem: Problem, verdict: Check) -> Array:
    """Bound on the rounding error of each joint's peaks over their limits, shape (joints, 3)."""
    blur = np.zeros((len(problem.joints), len(QUANTITIES)))
    for peak in verdict.peaks:
        if peak.quantity in QUANTITIES and peak.joint is not None and peak.limit > 0:
            j, r = problem.joints.index(peak.joint), QUANTITIES.index(peak.quantity)
            blur[j, r] = peak.error / peak.limit
    return blur


def _stretched(
    problem: Problem, h: Array, nodal: Array | None
) -> tuple[Array, Array | None] | None:
    """The motion stretched until it passes, if the duration bounds leave room."""
    for _ in range(ROUNDS):
        verdict = check(problem, h, nodal)
        if kept(problem, verdict):
            return h, nodal
        if not problem.curve.homogeneous:
            return None
        blur = _blur(problem, verdict)
        factor = 1.0
        for peak in verdict.peaks:
            if peak.quantity in QUANTITIES and peak.joint is not None and peak.limit > 0:
                r = QUANTITIES.index(peak.quantity)
                most = peak.ratio + blur[problem.joints.index(peak.joint), r]
                factor = max(factor, (most / (1.0 + AIM)) ** (1.0 / (r + 1)))
        longer = h * factor
        if not (factor > 1.0 and np.isfinite(longer).all()):
            return None
        if (longer > problem.duration_upper).any():
            return None
        if nodal is not None:
            orders = np.array([r for _, r in problem.piecewise.free_derivatives])[:, None]
            nodal = nodal / factor**orders
        h = longer
    return None


def _narrowed(problem: Problem, h: Array) -> tuple[Array, None] | None:
    """The end of a descent within limits that are narrower by the motion's rounding errors."""
    bottom = np.maximum(problem.duration_lower, 0.5 * h)
    box = LogBox(
        np.log(bottom), np.log(np.maximum(np.minimum(problem.duration_upper, 2 * h), bottom))
    )
    for _ in range(NARROWINGS):
        verdict = check(problem, h)
        if verdict.limits is not Verdict.UNDECIDED:
            return None
        end = descend(_narrower(problem, verdict), h, box).durations
        h = np.clip(end, problem.duration_lower, problem.duration_upper)
        if kept(problem, check(problem, h)):
            return h, None
    return None


def _narrower(problem: Problem, verdict: Check) -> Problem:
    """The problem with limits narrower by twice the bounds on rounding errors.

    A way-point may lie beyond them: the descent does not look at what no duration moves.
    """
    limits = problem.limits
    share = np.maximum(1.0 - DEEPER_INSIDE * _blur(problem, verdict), 0.5)
    low, high = limits.position_lower.copy(), limits.position_upper.copy()
    for peak in verdict.peaks:
        if peak.quantity == "position" and peak.joint is not None:
            j = problem.joints.index(peak.joint)
            inwards = min(DEEPER_INSIDE * peak.error, 0.25 * float(high[j] - low[j]))
            if peak.limit == limits.position_lower[j]:
                low[j] += inwards
            else:
                high[j] -= inwards
    inside = limits.with_sides(limits.sides * share)
    return replace(problem, limits=inside.with_positions(low, high))
