"""Answers that need no search: a proof that there is none, a closed form, an infimum of 0.

Straight motions at constant speed take no time where no velocity is limited. Segments that are
stretched by themselves have their least durations, or ratios of them at which nothing jumps. At
fixed ratios the total is the one unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from ...problem import (
    QUANTITIES,
    TOLERANCE,
    Array,
    Problem,
    TrajgapError,
    Verdict,
    as_piecewise,
    check,
    shown_bound,
)
from ...problem.checks import worst_ratios
from .decided import decided, kept
from .feasibility import SURE, apart, impossible
from .solution import Route, Solution, Status
from .starts import equal_start, first_nodal

HALVINGS = 40
"""Times that a total whose infimum is 0 is halved, while the checker still passes it."""


def straight_shares(problem: Problem) -> Array | None:
    """Durations in proportion to the way, if a total of any length keeps every limit; or None.

    The decision is exact. Joints that nothing limits but their position are left out, and so is a
    problem with a positive lower bound on a duration.
    """
    curve = as_piecewise(problem.curve)
    if curve is None or curve.free or curve.virtual or problem.duration_lower.any():
        return None
    given = [entry for b in range(curve.segments + 1) for entry in curve.prescribed_at(b)]
    if any(order < 2 or value != 0.0 for order, value in given):
        return None
    moving = np.ptp(problem.waypoints, axis=0) > 0
    limited = problem.limits.limited
    bound = limited.any(axis=1)
    if (moving & limited[:, 0]).any() or not (moving & bound).any():
        return None
    ways = [
        [Fraction(float(b)) - Fraction(float(a)) for a, b in pairwise(q)]
        for q in problem.waypoints.T[moving & bound]
    ]
    first = ways[0]
    forth = all(way * first[0] > 0 for way in first)
    if not forth or any(w[k] * first[0] != w[0] * first[k] for w in ways for k in range(len(w))):
        return None
    return np.array([float(way / sum(first)) for way in first])


def _shortest(problem: Problem, share: Array) -> Array | None:
    """The shortest total that the checker passes, by halving; None if it passes none."""
    with np.errstate(divide="ignore"):
        room = float((problem.duration_upper / share).min())
    total, best = min(float(equal_start(problem).sum()), room), None
    for _ in range(HALVINGS):
        if not kept(problem, check(problem, total * share, first_nodal(problem))):
            break
        best, total = total * share, 0.5 * total
    return best


WITHIN = 0.5
"""Share of the checker's room for a jump that an answer uses."""
BEYOND = 1e3
"""Multiple of that room that a proof grants: the bounds on rounding are those at unit durations."""
RESOLVED = 20.0
"""Log ratio of two durations up to which an answer is given: beyond, rounding alone sets it."""


@dataclass(frozen=True, eq=False)
class _Ratios:
    """Bounds on the logarithm of each duration over the one before, and what sets the upper one."""

    low: Array
    high: Array
    reasons: tuple[str, ...]


def joined(problem: Problem) -> Array | str | None:
    """The shortest durations without a jump, s; why there are none, a proof; or None.

    None if no ratio is bounded, or rounding alone would set one.
    """
    if as_piecewise(problem.curve) is None or not apart(problem):
        return None
    wide = _ratios(problem, BEYOND)
    if np.isneginf(wide.low).all() and np.isposinf(wide.high).all():
        return None
    # Bounds on log durations, segment by segment.
    trajectory = problem.curve.fitted(problem.waypoints, np.ones(problem.segments))
    least = np.maximum(problem.duration_lower, worst_ratios(problem, trajectory))
    with np.errstate(divide="ignore"):
        low, high = np.log(least), np.log(problem.duration_upper)
    for k, reason in enumerate(wide.reasons):
        if not wide.low[k] <= wide.high[k] or np.isposinf(wide.low[k]):
            return f"the {reason} jumps at way-point {k + 2} for any durations"
    slack = float(np.log(SURE))
    late = np.flatnonzero(_least(low, wide) > high + slack)
    if late.size:
        k = int(late[0])
        shown = shown_bound(np.exp(_least(low, wide)[k]), "lower")
        bounded = np.flatnonzero(np.isfinite(wide.low) | np.isfinite(wide.high))
        smooth = wide.reasons[int(bounded[np.argmin(np.abs(bounded - k))])]
        return (
            f"without a jump of {smooth} segment {k + 1} takes at least "
            f"{shown} s within the limits and the duration bounds; "
            f"its upper bound is {problem.duration_upper[k]:.6g} s"
        )
    close = _ratios(problem, WITHIN)
    z = _least(low, close)
    if not np.ptp(z) < RESOLVED:
        return None
    if not (np.isfinite(z).all() and (close.low <= close.high).all() and (z <= high).all()):
        return None
    return np.asarray(np.maximum(np.exp(z), problem.duration_lower))


def _ratios(problem: Problem, share: float) -> _Ratios:
    """Bounds on log ratios of durations, by a share of the room that the checker leaves a jump.

    With x = h₁⁻ʳ, y = h₂⁻ʳ the two sides are Lx and Ry, and the checker asks for
    |Lx − Ry| ≤ Ex + Fy: with L ≥ 0, x(L − E) ≤ y(R + F) and x(L + E) ≥ y(R − F).
    """
    n = problem.segments
    found = problem.curve.enclosed(problem.waypoints, np.ones(n))
    low, high = np.full(n - 1, -np.inf), np.full(n - 1, np.inf)
    reasons = ["velocity"] * (n - 1)
    for k in range(n - 1):
        for j, joint in enumerate(problem.joints):
            for order in range(1, 1 + int(problem.limits.smooth_orders[j])):
                sides = [found.trajectory.derivative(k + i, j, order) for i in (0, 1)]
                # A joint that stands still has no derivative: rounding has no part in that.
                still = np.diff(problem.waypoints[k : k + 3, j]) == 0.0
                room = [
                    share
                    * (float(found.error[k + i, order, j]) + TOLERANCE * float(np.abs(s).sum()))
                    if not still[i]
                    else 0.0
                    for i, s in enumerate(sides)
                ]
                least, most = _ratio(float(sides[0].sum()), float(sides[1][0]), *room)
                if least > np.exp(order * low[k]) or most < np.exp(order * high[k]):
                    reasons[k] = f"{QUANTITIES[order - 1]} of joint {joint}"
                with np.errstate(divide="ignore"):
                    low[k] = max(low[k], float(np.log(least)) / order)
                    high[k] = min(high[k], float(np.log(most)) / order)
    return _Ratios(low, high, tuple(reasons))


def _ratio(left: float, right: float, room: float, other: float) -> tuple[float, float]:
    """Least and largest t = x/y = (h₂/h₁)ʳ ≥ 0; the least above the largest where there is none."""
    least, most = 0.0, np.inf
    for slope, side in (
        (left - room, right + other),
        (-left - room, other - right),
    ):  # slope t ≤ side
        if slope > 0.0:
            most = min(most, side / slope)
        elif slope < 0.0:
            least = max(least, side / slope)
        elif side < 0.0:
            least = np.inf
    return (least, most) if most > 0.0 else (np.inf, 0.0)


def _least(low: Array, ratios: _Ratios) -> Array:
    """The least log durations above ``low`` whose differences keep their bounds from below.

    z₂ ≥ z₁ + low and z₁ ≥ z₂ − high: along a chain one pass each way reaches the fixed point.
    """
    z = low.copy()
    for k in range(z.size - 1):
        z[k + 1] = max(z[k + 1], z[k] + ratios.low[k])
    for k in range(z.size - 2, -1, -1):
        z[k] = max(z[k], z[k + 1] - ratios.high[k])
    for k in range(z.size - 1):
        z[k + 1] = max(z[k + 1], z[k] + ratios.low[k])
    return z


FORMULA = "at fixed ratios the total is the only unknown, and has a closed form"
"""Beside every optimum at fixed ratios: no search stands behind it."""


def tight_at_ratios(problem: Problem) -> Array | Solution:
    """The shortest durations with the ratios of the problem, s, or why no total keeps the limits.

    A derivative of order r falls with the total T as T⁻ʳ where a curve may be stretched in time:
    with its peak p_r at T = 1 s, a limit asks for T ≥ (p_r/limit_r)^(1/r), and the largest of these
    is the answer, unless bounds on durations ask for more. Positions do not depend on T. Where
    nothing that moves is limited, any total is returned.

    Raises
    ------
    TrajgapError
        If the curve has free coefficients or cannot be stretched, so there is no formula.
    """
    shares, why = problem.shares, problem.unscaled
    if why is not None:
        raise TrajgapError(why)
    assert shares is not None
    at_one = check(problem, shares)
    if any(p.quantity == "curve" for p in at_one.peaks):
        why = f"no curve exists at these ratios: {at_one.feasible_why}"
        return Solution(problem, Status.FAILED, why)
    for p in at_one.peaks:
        if np.isinf(p.ratio) and p.quantity in QUANTITIES:
            why = f"joint {p.joint} moves, though its {p.quantity} limit is 0"
            return Solution(problem, Status.INFEASIBLE, why)
    least = max(at_one.stretch, float((problem.duration_lower / shares).max()))
    most = float((problem.duration_upper / shares).min())
    # Rounding may take a duration beyond the bound that it meets.
    h = shares * min(least or 1.0, most)
    h = np.clip(h, problem.duration_lower, problem.duration_upper)
    if least <= most:
        return h
    # The longest total breaks the limits least: it passes where rounding alone decides.
    verdict = check(problem, h).limits
    if verdict is Verdict.PASS:
        return h
    said = (
        f"at these ratios limits and least durations ask for {shown_bound(least, 'lower')} s "
        f"in total, and the upper bounds on durations end at {shown_bound(most, 'upper')} s"
    )
    if verdict is Verdict.VIOLATED:
        return Solution(problem, Status.INFEASIBLE, said)
    return Solution(problem, Status.NONE_FOUND, f"{said}; rounding errors hide which is larger")


def refused_at_ratios(problem: Problem, h: Array) -> Solution:
    """The answer where no total makes a motion pass, though it is as tight as its limits allow."""
    verdict = check(problem, h)
    outside = [p for p in verdict.peaks if p.quantity == "position" and p.ratio > 1.0 + TOLERANCE]
    if verdict.limits is Verdict.VIOLATED and outside:
        worst = max(outside, key=lambda p: p.ratio)
        unit = "m" if problem.linear[problem.joints.index(str(worst.joint))] else "rad"
        why = (
            f"at these ratios joint {worst.joint} reaches {worst.value:.6g} {unit}, beyond its "
            f"position limit of {worst.limit:.6g} {unit}, whatever the total"
        )
        return Solution(problem, Status.INFEASIBLE, why)
    why = "rounding errors hide whether any total keeps the limits at these ratios"
    if verdict.jumps:
        jump = max(verdict.jumps, key=lambda one: (-one.order, abs(one.size)))
        what = ("position", *QUANTITIES)[jump.order]
        why = f"at these ratios the {what} of joint {jump.joint} jumps, whatever the total"
    return Solution(problem, Status.NONE_FOUND, why)


CUT_SHORT = "the time ran out; what was not searched may contain a shorter motion"
"""Beside the answer of a search that its time limit ended."""
OUT_OF_TIME = "the time ran out, so it is unknown whether there are any"
"""Beside the word that nothing was found, by a search that its time limit ended."""


def unsearched(problem: Problem) -> Solution | None:
    """The answer of a problem that elementary arguments decide, or None."""
    reason = impossible(problem)
    smooth = joined(problem) if reason is None else reason
    if isinstance(smooth, str):
        return Solution(problem, Status.INFEASIBLE, smooth)
    if smooth is not None and (answer := decided(problem, smooth)) is not None:
        return Solution(
            problem,
            Status.CONVERGED,
            "the least durations without a jump, in closed form",
            vector=answer.durations,
            check=check(problem, answer.durations),
            route=Route.CLOSED_FORM,
        )
    limits = problem.limits
    limited = np.isfinite(limits.sides).any() or limits.limits_position
    if not limited and not problem.duration_lower.any():
        why = "nothing is limited: the total falls to 0"
        shares = np.full(problem.segments, 1.0 / problem.segments)
    else:
        why = (
            "at durations in proportion to the distance nothing accelerates, and no velocity is "
            "limited: the total falls to 0"
        )
        straight = straight_shares(problem)
        if straight is None:
            return None
        shares = straight
    short, nodal = _shortest(problem, shares), first_nodal(problem)
    if short is None:
        return None
    return Solution(
        problem,
        Status.NOT_ATTAINED,
        why,
        vector=short,
        nodal=nodal,
        check=check(problem, short, nodal),
        route=Route.CLOSED_FORM,
        infimum=0.0,
    )


def cut_short(answer: Solution) -> Solution:
    """The answer of a search whose time ran out, with a word that says so.

    Proofs need no search: *infeasible* stays as it is.
    """
    if answer.status is Status.INFEASIBLE:
        return answer
    said = OUT_OF_TIME if not answer.found else CUT_SHORT
    return replace(answer, why=said if answer.why is None else f"{answer.why}; {said}")
