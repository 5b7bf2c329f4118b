"""Proofs in which each segment stands alone, checked again: standard library only."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from .verify_answer import read_answer
from .verify_problem import Proved, Stated, need, number, whole

PLACES = 2**20

Peak = Callable[[int, int, int, Fraction], Fraction]
"""From joint, segment, order and place: |derivative| there if the segment takes 1 s."""


def prove_segments(
    document: dict[str, Any],
    problem: Stated,
    peak: Peak,
    check: Callable[[Sequence[Fraction]], None],
) -> Proved:
    """Prove a claim from a least duration for each segment.

    Parameters
    ----------
    document : dict
        ``proof.segments`` has [joint, order, place·2²⁰, least duration] per segment; joint −1
        stands for the duration's own lower bound.
    problem : Stated
    peak : callable
    check : callable
        Refuses durations that do not keep the limits.

    Returns
    -------
    Proved

    Raises
    ------
    Refused
        If it does not prove its claim.
    """
    claim = document["claim"]
    least = _least(problem, document["proof"]["segments"], peak)
    lower = number(claim["lower"])
    need(lower <= sum(least), "the lower bound exceeds the total that is proved")
    answer = read_answer(claim)
    if claim["infeasible"] is True:
        need(answer is None, "infeasible, but with an answer")
        late = any(u is not None and x > u for x, u in zip(least, problem.longest, strict=True))
        need(late, "infeasible only if a segment needs more than its upper bound")
        return Proved(lower, None, True)
    if answer is None:
        return Proved(lower)
    check(answer[0])
    return Proved(lower, answer[1])


def _least(problem: Stated, bounds: Any, peak: Peak) -> list[Fraction]:
    """Least duration of every segment: limit·hʳ ≥ |derivative at a place|."""
    need(len(bounds) == len(problem.longest), "one bound per segment")
    out = []
    for k, (joint, order, place, text) in enumerate(bounds):
        x = number(text)
        need(x >= 0, f"segment {k + 1}: a negative duration")
        if whole(joint, -1, len(problem.limits) - 1) == -1:
            need(x <= problem.shortest[k], f"segment {k + 1}: above its lower bound")
        else:
            bound = problem.limits[joint][whole(order, 1, 3) - 1]
            need(bound is not None and bound[1] > 0, "a limit that is not there")
            assert bound is not None
            value = peak(joint, k, order, Fraction(whole(place, 0, PLACES), PLACES))
            proved = bound[1] * x**order <= value
            need(proved, f"segment {k + 1}: its least duration is not proved")
        out.append(x)
    return out
