"""Whether durations keep every limit at all times on the declared curve, in rationals."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from .curve import UNIFORM, derivative, nonnegative, pieces
from .problem import StatedProblem
from .reading import Clock, need


def check_durations(
    h: Sequence[Fraction], shortest: Sequence[Fraction], longest: Sequence[Fraction | None]
) -> None:
    """Refuse durations that are not one for each segment, positive and within their bounds."""
    need(len(h) == len(shortest), "answer: one duration per segment")
    for k, (x, low, top) in enumerate(zip(h, shortest, longest, strict=True), 1):
        inside = x > 0 and x >= low and (top is None or x <= top)
        need(inside, f"answer: duration {k} is outside its bounds")


def check_answer(problem: StatedProblem, h: Sequence[Fraction], clock: Clock) -> None:
    """Refuse durations of other ratios, or whose trajectory does not keep every limit at all times.

    The velocity does not jump, nor does the acceleration of a joint whose jerk is limited, unless
    each segment is stretched in time separately: there the limits are those inside the segments.

    Parameters
    ----------
    h : sequence of Fraction
        Durations, s.

    Raises
    ------
    Refused
        With the joint, the segment and the derivative.
    """
    check_durations(h, problem.shortest, problem.longest)
    need(not problem.chord, "answer: no durations are exactly in the ratios of chord lengths")
    if problem.shares is not None:
        total = sum(clock.each(h), Fraction(0))
        alike = all(x == share * total for x, share in zip(h, problem.shares, strict=True))
        need(alike, "answer: the durations have other ratios")
    for j, curve in enumerate(pieces(problem, h, clock)):
        jerk = any(side[j][2] is not None for side in problem.sides)
        smooth = ((1, "velocity"), (2, "acceleration"))[: 2 if jerk else 1]
        for order, what in () if problem.curve == UNIFORM else smooth:
            slopes = [derivative(piece, order) for piece in curve]
            ends = [(c[0] / x**order, sum(c) / x**order) for c, x in zip(slopes, h, strict=True)]
            for (_, left), (right, _) in clock.each(pairwise(ends)):
                need(left == right, f"answer: the {what} jumps")
        for k, piece in enumerate(curve):
            for order, sign, limit in clock.each(_limits(problem, j, h[k])):
                rest = [-sign * c for c in derivative(piece, order)]
                rest[0] += limit
                need(
                    nonnegative(rest, clock),
                    f"answer: joint {j + 1}, segment {k + 1}, derivative {order} exceeds its limit",
                )


def _limits(
    problem: StatedProblem, joint: int, duration: Fraction
) -> list[tuple[int, int, Fraction]]:
    """Order, side and size of a joint's limits, in the time of a piece that lasts so long."""
    limits = [
        (r, s, x[0] * duration**r)
        for s, side in ((1, problem.sides[1]), (-1, problem.sides[0]))
        for r, x in enumerate(side[joint], 1)
        if x is not None
    ]
    low, high = (side[joint] for side in problem.position)
    limits += [] if high is None else [(0, 1, high[0])]
    limits += [] if low is None else [(0, -1, -low[1])]
    return limits
