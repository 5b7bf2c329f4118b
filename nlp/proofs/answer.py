"""An answer whose feasibility is proved in rational numbers, by the verifier's own arithmetic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ...problem import Array, Limits, Problem
from ...verify import Clock, Refused, StatedProblem, check_answer
from ..optimum import exact_rows
from .document import stated_problem
from .exact import ExactProblem, Real
from .rounding import ROOMS, up


def _tight(size: Real | None) -> float:
    """The tighter end of a limit in floats; inf for none."""
    return np.inf if size is None else float(size.low)


def float_problem(exact: ExactProblem) -> Problem:
    """Nearest problem in floats, in the unit of angle of ``exact``; π on the tighter side."""
    pairs = [[exact.sides(j, r) for r in (1, 2, 3)] for j in range(len(exact.joints))]
    sides = [[[_tight(pair[side]) for pair in row] for row in pairs] for side in (0, 1)]
    low = [-np.inf if x is None else float(x.high) for x in exact.position_lower]
    high = [np.inf if x is None else float(x.low) for x in exact.position_upper]
    return Problem(
        np.array([[float(q) for q in row] for row in exact.waypoints]),
        Limits(joints=len(exact.joints)).with_sides(sides).with_positions(low, high),
        exact.curve,
        np.array([float(x) for x in exact.duration_lower]),
        np.array([np.inf if x is None else float(x) for x in exact.duration_upper]),
        joints=exact.joints,
        name=exact.name,
        ratios=None if exact.shares is None else np.array([float(x) for x in exact.shares]),
    )


def keeps_limits(
    problem: ExactProblem, durations: Sequence[Fraction], clock: Clock | None = None
) -> bool:
    """Whether durations are within their bounds and their trajectory keeps every limit, exactly.

    Raises
    ------
    OutOfTime
        If the time runs out.
    """
    try:
        check_answer(stated_problem(problem), durations, clock or Clock(math.inf))
    except Refused:
        return False
    return True


def prove_feasible(
    problem: ExactProblem, durations: Array, clock: Clock | None = None
) -> tuple[Fraction, ...] | None:
    """Rational durations near the given ones, proved feasible; None if none was found.

    They are rounded up to 15 digits, and never lie beyond their bounds; where ratios are fixed,
    they have these ratios exactly. If they exceed a limit all the same, by what rounding hides,
    they are moved inside all limits, by 1e-13 first and by 1e-7 at most.

    Raises
    ------
    OutOfTime
        If the time runs out.
    """
    stated = stated_problem(problem)
    for room in (0.0, *ROOMS):
        moved = durations if room == 0.0 else _moved_inside(problem, durations, room)
        found = _within_bounds(stated, [Fraction(float(h)) for h in moved])
        if keeps_limits(problem, found, clock):
            return tuple(found)
    return None


def _moved_inside(problem: ExactProblem, durations: Array, room: float) -> Array:
    """Durations moved inside all limits by a share of them, to first order.

    A uniform stretch does it where no position is limited, no duration has an upper bound and the
    ends stand still. Elsewhere the logarithms change by room·x, where x is the cheapest change,
    min Σ h x, with excess + gradient·room·x ≤ −room for all limits.
    """
    floats = float_problem(problem)
    stays = floats.limits.limits_position or np.isfinite(floats.duration_upper).any()
    if floats.ratios is not None or (floats.curve.homogeneous and not stays):
        return durations * (1.0 + room)
    from scipy.optimize import linprog  # half a second to import; most answers need none

    rows = exact_rows(floats, durations)
    if rows.worst == np.inf:  # they define no curve
        return durations
    near = rows.excess + ROOMS[-1] * np.abs(rows.gradient).sum(axis=1) > -room
    with np.errstate(divide="ignore"):
        ends = np.log([floats.duration_lower / durations, floats.duration_upper / durations])
    found = linprog(
        durations,
        A_ub=rows.gradient[near],
        b_ub=-rows.excess[near] / room - 1.0,
        bounds=np.clip(ends.T, -ROOMS[-1], ROOMS[-1]) / room,
    )
    return durations * (np.exp(room * found.x) if found.status == 0 else 1.0 + room)


def _within_bounds(stated: StatedProblem, durations: Sequence[Fraction]) -> list[Fraction]:
    """Durations rounded up to 15 digits and within their bounds, of exactly the fixed ratios."""
    bounds = list(zip(stated.shortest, stated.longest, strict=True))
    if stated.shares is None:
        each = zip(durations, bounds, strict=True)
        longer = [(max(up(h, 15), low), high) for h, (low, high) in each]
        return [h if high is None else min(h, high) for h, high in longer]
    both = list(zip(stated.shares, bounds, strict=True))
    total = max(up(sum(durations, Fraction(0)), 15), *(low / share for share, (low, _) in both))
    total = min([total, *(high / share for share, (_, high) in both if high is not None)])
    return [share * total for share in stated.shares]
