"""Answers that need no search: a proof that there is none, a closed form, an infimum of 0."""

from __future__ import annotations

from ...problem import Problem, check
from .decided import decided
from .feasibility import impossible
from .joined import joined
from .solution import Solution, Status
from .straight import straight_durations


def unsearched(problem: Problem) -> Solution | None:
    """The answer of a problem that elementary arguments decide, or None.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Solution or None
    """
    reason = impossible(problem)
    smooth = joined(problem) if reason is None else reason
    if isinstance(smooth, str):
        return Solution(problem, Status.INFEASIBLE, smooth)
    if smooth is not None and (answer := decided(problem, smooth)) is not None:
        return Solution(
            problem,
            Status.OPTIMAL,
            "the least durations without a jump, in closed form",
            durations=answer.durations,
            check=check(problem, answer.durations),
        )
    straight = straight_durations(problem)
    if straight is not None:
        return Solution(
            problem,
            Status.NOT_ATTAINED,
            "at durations in proportion to the way nothing accelerates, and no velocity is "
            "limited: the total falls to 0",
            durations=straight,
            check=check(problem, straight),
            infimum=0.0,
        )
    return None
