"""Answers that need no search: a proof that there is none, a closed form, an infimum of 0."""

from __future__ import annotations

from dataclasses import replace

from ...problem import Problem, check
from .decided import decided
from .feasibility import impossible
from .joined import joined
from .solution import Route, Solution, Status
from .straight import straight_durations

CUT_SHORT = "the time ran out: what was not searched may hold a shorter motion"
"""Beside the answer of a search that its time limit ended."""
OUT_OF_TIME = "the time ran out, which says nothing about whether there are any"
"""Beside the word that nothing was found, by a search that its time limit ended."""


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
            Status.CONVERGED,
            "the least durations without a jump, in closed form",
            durations=answer.durations,
            check=check(problem, answer.durations),
            route=Route.CLOSED_FORM,
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
            route=Route.CLOSED_FORM,
            infimum=0.0,
        )
    return None


def cut_short(answer: Solution) -> Solution:
    """The answer of a search whose time ran out, with a word that says so.

    Parameters
    ----------
    answer : Solution

    Returns
    -------
    Solution
        Proofs need no search: *infeasible* stays as it is.
    """
    if answer.status is Status.INFEASIBLE:
        return answer
    said = OUT_OF_TIME if answer.durations is None else CUT_SHORT
    return replace(answer, why=said if answer.why is None else f"{answer.why}; {said}")
