"""Ends of searches as the checker judges them, and moved inside limits that rounding blurs."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
from .optimality import KKT
from .starts import DENSE, LogBox, slowed, stretching

ROUNDS = 6
"""Stretches that are tried: the bound on rounding errors changes little with each."""
AIM = 0.5 * TOLERANCE
"""Relative excess, rounding included, that a stretch aims at: half the checker's tolerance."""
LENGTHENINGS = 30
"""Doublings of the shortest durations where rounding hides the limits: a jerk's error falls to an
eighth each time, and over nine decades in all."""
NARROWER = tuple(TOLERANCE * 4.0**k for k in range(10))
"""Shares by which limits are narrowed where no stretch is possible: from what the checker tolerates
to 3e-4, so an answer is at most four times as far inside as it has to be."""


@dataclass(frozen=True, eq=False)
class Local:
    """The end of a local search, as the checker judges it.

    Attributes
    ----------
    durations : ndarray, shape (segments,)
        s.
    nodal : ndarray, shape (free, joints), or None
        Free derivatives, where the declaration leaves some.
    verdict : Check
    feasible : bool
        Whether the checker passes the motion: curves that always jump by their limits alone.
    converged : bool
        Whether the search ended because no step gained any more.
    iterations : int
    tight : (durations, nodal) or None
        What was moved inside its limits so that rounding errors do not decide, if anything was.
    report : KKT or None
        The optimality conditions, where the search knows them already.
    build_seconds : float
    """

    durations: Array
    nodal: Array | None
    verdict: Check
    feasible: bool
    converged: bool = False
    iterations: int = 0
    tight: tuple[Array, Array | None] | None = None
    report: KKT | None = None
    build_seconds: float = 0.0

    @classmethod
    def of(
        cls, problem: Problem, h: Array, nodal: Array | None = None, converged: bool = False
    ) -> Local:
        """A motion as the checker judges it, who raises where float64 has lost the curve."""
        verdict = check(problem, h, nodal)
        return cls(h, nodal, verdict, kept(problem, verdict), converged)

    @property
    def total(self) -> float:
        """Sum of the durations, s."""
        return float(self.durations.sum())


def kept(problem: Problem, verdict: Check) -> bool:
    """Whether a motion counts as feasible: curves that always jump are judged by their limits."""
    if as_piecewise(problem.curve) is not None:
        return verdict.verdict is Verdict.PASS
    return verdict.limits is Verdict.PASS


def widened(problem: Problem, share: float) -> Problem:
    """The problem with limits wider by a share, or narrower by one below 0.

    Duration bounds, sides of 0 and ranges of no width stay as they are.
    """
    limits = problem.limits
    low, high = limits.position_lower, limits.position_upper
    half = np.array([[half_range(a, b, x) for x in (a, b)] for a, b in zip(low, high, strict=True)])
    room = np.where(np.isfinite(half), share * half, 0.0)
    wider = limits.with_sides(limits.sides * (1.0 + share))
    return replace(problem, limits=wider.with_positions(low - room[:, 0], high + room[:, 1]))


def decided(problem: Problem, h: Array, nodal: Array | None = None) -> Local | None:
    """A motion that the checker passes, beside one that it does not: slightly longer, or None.

    Where way-points nearly coincide, the bound on rounding errors of a tight motion exceeds the
    checker's tolerance: it is *undecided*, though a motion longer by that bound passes. The same
    stretch repairs a motion that exceeds its limits.
    """
    found = stretched(problem, h, nodal)
    # A descent changes each duration separately, which fixed ratios do not allow.
    descends = not problem.curve.free and problem.ratios is None and problem.segments <= DENSE
    if found is None and descends:
        found = _narrowed(problem, h) or _lengthened(problem, h)
    return found and replace(found, converged=True, tight=(h, nodal))


def incumbent(problem: Problem, known: Array, nodal: Array | None) -> Local | None:
    """The shortest motion that passes of those that somebody has, as they are or just tight.

    A printed motion that exceeds a limit by its last digit is worth what its repair is worth.
    Without their free derivatives motions of a curve that leaves some are not determined.
    """
    if problem.curve.free and nodal is None:
        return None
    motions: list[tuple[Array, Array | None]] = []
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
        if passing is not None and not (best and passing.total >= best.total):
            best = passing
    return best


def stretched(problem: Problem, h: Array, nodal: Array | None) -> Local | None:
    """The motion stretched until it passes, or None if the duration bounds leave no room."""
    for _ in range(ROUNDS):
        found = Local.of(problem, h, nodal)
        if found.feasible:
            return found
        if not problem.curve.homogeneous:
            return None
        factor = 1.0
        for peak in found.verdict.peaks:
            if peak.quantity in QUANTITIES and peak.joint is not None and peak.limit > 0:
                r = QUANTITIES.index(peak.quantity)
                most = peak.ratio + peak.error / peak.limit
                factor = max(factor, (most / (1.0 + AIM)) ** (1.0 / (r + 1)))
        longer = h * factor
        room = np.isfinite(longer) & (longer <= problem.duration_upper)
        if not (factor > 1.0 and room.all()):
            return None
        nodal = None if nodal is None else slowed(problem, nodal, factor)
        h = longer
    return None


def _narrowed(problem: Problem, h: Array) -> Local | None:
    """The end of a descent within the widest of narrower limits in which rounding decides nothing.

    A way-point may lie beyond them: the descent does not look at what no duration moves.
    """
    bottom = np.maximum(problem.duration_lower, 0.5 * h)
    top = np.maximum(np.minimum(problem.duration_upper, 2.0 * h), bottom)
    box = LogBox(np.log(bottom), np.log(top))
    found = Local.of(problem, h)
    for share in NARROWER:
        if found.verdict.limits is not Verdict.UNDECIDED:
            return None
        end = descend(widened(problem, -share), found.durations, box).durations
        found = Local.of(problem, np.clip(end, problem.duration_lower, problem.duration_upper))
        if found.feasible:
            return found
    return None


def _lengthened(problem: Problem, h: Array) -> Local | None:
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
