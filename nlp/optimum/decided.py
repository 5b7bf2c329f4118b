"""Motions at their limits, moved inside by as much as rounding blurs them, so that they pass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...problem import (
    QUANTITIES,
    TOLERANCE,
    Array,
    Check,
    Problem,
    Verdict,
    as_piecewise,
    check,
    evaluate,
    half_range,
)
from .descent import descend
from .optimality import Local
from .starts import DENSE, LogBox, slowed, stretching

ROUNDS = 6
"""Stretches, or descents within narrower limits, that are tried: the bound on rounding errors
changes little with each."""
AIM = 0.5 * TOLERANCE
"""Relative excess, rounding included, that a stretch aims at: half the checker's tolerance."""
LENGTHENINGS = 30
"""Doublings of the shortest durations where rounding hides the limits: a jerk's error falls to an
eighth each time, and over nine decades in all."""
DEEPER_INSIDE = 2.0
"""By how many bounds on rounding errors limits are narrowed where no stretch is possible."""
Motion = tuple[Array, Array | None]
"""Durations, s, and free derivatives, where the declaration leaves some."""


def kept(problem: Problem, verdict: Check) -> bool:
    """Whether a motion counts as feasible: curves that always jump are judged by their limits."""
    if as_piecewise(problem.curve) is not None:
        return verdict.verdict is Verdict.PASS
    return verdict.limits is Verdict.PASS


def tolerated(problem: Problem) -> Problem:
    """The problem with limits wider by half of what `check` tolerates beyond them.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Problem
        With the same duration bounds. A side of 0, and a range of no width, stay as they are.
    """
    low, high = problem.limits.position_lower, problem.limits.position_upper
    half = np.array([[half_range(a, b, x) for x in (a, b)] for a, b in zip(low, high, strict=True)])
    room = np.where(np.isfinite(half), AIM * half, 0.0)
    return _moved(problem, 1.0 + AIM, room * [-1.0, 1.0])


def _moved(problem: Problem, share: Array | float, positions: Array) -> Problem:
    """The problem with sides of limits times a share, and both ends of positions moved."""
    limits = problem.limits
    low, high = limits.position_lower + positions[:, 0], limits.position_upper + positions[:, 1]
    return replace(
        problem, limits=limits.with_sides(limits.sides * share).with_positions(low, high)
    )


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
    found = stretched(problem, h, nodal)
    # A descent changes each duration by itself, which fixed ratios do not allow.
    descends = not problem.curve.free and problem.ratios is None and problem.segments <= DENSE
    if found is None and descends:
        found = _narrowed(problem, h) or _lengthened(problem, h)
    if found is None:
        return None
    durations, values = found
    return Local(durations, values, float(durations.sum()), True, True, 0, (h, nodal))


def incumbent(problem: Problem, known: Array, nodal: Array | None) -> Local | None:
    """The shortest motion that passes of those that somebody has, as they are or just tight.

    A printed motion that exceeds a limit by its last digit is worth what its repair is worth.

    Parameters
    ----------
    problem : Problem
    known : ndarray, shape (motions, segments)
        s.
    nodal : ndarray, shape (motions, free, joints), or None
        Without them motions of a curve that leaves derivatives free are not determined.

    Returns
    -------
    Local or None
    """
    if problem.curve.free and nodal is None:
        return None
    motions: list[Motion] = []
    for h, v in zip(known, [None] * len(known) if nodal is None else nodal, strict=True):
        motions.append((h, v))
        c = float(evaluate(stretching(problem), h[None], v).stretch[0])
        # What rounding alone could shorten is tight as it is, in the digits that somebody has.
        if problem.curve.homogeneous and 0 < c < np.inf and not 1 - TOLERANCE <= c <= 1:
            tight = np.clip(h * c, problem.duration_lower, problem.duration_upper)
            motions.append((tight, None if v is None else slowed(problem, v, c)))
    best: Local | None = None
    for h, v in sorted(motions, key=lambda motion: float(motion[0].sum())):
        if best is not None and h.sum() >= best.total:
            break
        passing = stretched(problem, h, v)
        if passing is not None and not (best and passing[0].sum() >= best.total):
            best = Local(*passing, float(passing[0].sum()), False, True, 0)
    return best


def longer_than_tight(beyond: float) -> str:
    """Why an answer is longer than a tight motion, by that share."""
    return f"longer by {beyond:.1e} (relative) than a tight motion, which rounding errors blur"


def _blur(problem: Problem, verdict: Check) -> Array:
    """Bound on the rounding error of each joint's peaks over their limits, shape (joints, 3)."""
    blur = np.zeros((len(problem.joints), len(QUANTITIES)))
    for peak in verdict.peaks:
        if peak.quantity in QUANTITIES and peak.joint is not None and peak.limit > 0:
            j, r = problem.joints.index(peak.joint), QUANTITIES.index(peak.quantity)
            blur[j, r] = peak.error / peak.limit
    return blur


def stretched(problem: Problem, h: Array, nodal: Array | None) -> Motion | None:
    """The motion stretched until it passes, or None where the duration bounds leave no room.

    Parameters
    ----------
    problem : Problem
    h : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), or None

    Returns
    -------
    (durations, free derivatives) or None
    """
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
        nodal = None if nodal is None else slowed(problem, nodal, factor)
        h = longer
    return None


def _narrowed(problem: Problem, h: Array) -> Motion | None:
    """The end of a descent within limits that are narrower by the motion's rounding errors."""
    bottom = np.maximum(problem.duration_lower, 0.5 * h)
    box = LogBox(
        np.log(bottom), np.log(np.maximum(np.minimum(problem.duration_upper, 2 * h), bottom))
    )
    for _ in range(ROUNDS):
        verdict = check(problem, h)
        if verdict.limits is not Verdict.UNDECIDED:
            return None
        end = descend(_narrower(problem, verdict), h, box).durations
        h = np.clip(end, problem.duration_lower, problem.duration_upper)
        if kept(problem, check(problem, h)):
            return h, None
    return None


def _lengthened(problem: Problem, h: Array) -> Motion | None:
    """The end of a descent whose shortest durations are longer, by as much as it takes.

    A segment that is far shorter than the others blurs what is known of all derivatives in it. The
    total often hardly depends on it.
    """
    if check(problem, h).limits is not Verdict.UNDECIDED:
        return None
    top = np.minimum(problem.duration_upper, 2.0 * h.sum())
    for _ in range(LENGTHENINGS):
        floor = 2.0 * float(h.min())
        if floor > h.sum():
            break
        bottom = np.minimum(np.maximum(problem.duration_lower, floor), top)
        end = descend(problem, np.maximum(h, bottom), LogBox(np.log(bottom), np.log(top)))
        if not end.feasible:
            break
        h = np.clip(end.durations, problem.duration_lower, problem.duration_upper)
        found = stretched(problem, h, None) or _narrowed(problem, h)
        if found is not None:
            return found
    return None


def _narrower(problem: Problem, verdict: Check) -> Problem:
    """The problem with limits narrower by twice the bounds on rounding errors.

    A way-point may lie beyond them: the descent does not look at what no duration moves.
    """
    limits = problem.limits
    share = np.maximum(1.0 - DEEPER_INSIDE * _blur(problem, verdict), 0.5)
    inwards = np.zeros((len(problem.joints), 2))
    for peak in verdict.peaks:
        if peak.quantity == "position" and peak.joint is not None:
            j = problem.joints.index(peak.joint)
            room = 0.25 * float(limits.position_upper[j] - limits.position_lower[j])
            end = int(peak.limit != limits.position_lower[j])
            inwards[j, end] = (1 - 2 * end) * min(DEEPER_INSIDE * peak.error, room)
    return _moved(problem, share, inwards)
