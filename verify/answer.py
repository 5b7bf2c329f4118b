"""Whether durations keep every limit at all times on the declared curve, in rationals."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from .curve import UNIFORM, derivative, nonnegative, pieces, uniform_pieces, value_at
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

    The velocity does not jump, nor does the acceleration of a joint whose jerk is limited, but
    where each segment is stretched in time by itself: there the limits are those inside the
    segments.

    Parameters
    ----------
    problem : StatedProblem
    h : sequence of Fraction
        Durations, s.
    clock : Clock

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
    if problem.curve == UNIFORM:
        # Each piece takes 1; the derivatives of order r are divided by hʳ.
        for j, curve in enumerate(uniform_pieces(problem, clock)):
            for k, piece in enumerate(curve):
                _keeps(problem, j, k, piece, Fraction(1), h[k], clock)
        return
    for j, curve in enumerate(pieces(problem, h, clock)):
        jerk = any(side[j][2] is not None for side in problem.sides)
        for order, what in ((1, "velocity"), (2, "acceleration"))[: 2 if jerk else 1]:
            slopes = [derivative(piece, order) for piece in curve]
            for k, (left, right) in enumerate(pairwise(slopes)):
                clock.check()
                need(value_at(left, h[k]) == right[0], f"answer: the {what} jumps")
        for k, piece in enumerate(curve):
            _keeps(problem, j, k, piece, h[k], Fraction(1), clock)


def _keeps(
    problem: StatedProblem,
    joint: int,
    segment: int,
    piece: Sequence[Fraction],
    end: Fraction,
    unit: Fraction,
    clock: Clock,
) -> None:
    """Refuse a piece on [0, end] that exceeds a limit; its time is counted in ``unit`` s."""
    limits = [
        (r, s, x[0] * unit**r)
        for s, side in ((1, problem.sides[1]), (-1, problem.sides[0]))
        for r, x in enumerate(side[joint], 1)
        if x is not None
    ]
    low, high = (side[joint] for side in problem.position)
    limits += [] if high is None else [(0, 1, high[0])]
    limits += [] if low is None else [(0, -1, -low[1])]
    for order, sign, limit in limits:
        clock.check()
        rest = [-sign * c for c in derivative(piece, order)]
        rest[0] += limit
        need(
            nonnegative(rest, end, clock),
            f"answer: joint {joint + 1}, segment {segment + 1}, "
            f"derivative {order} exceeds its limit",
        )
