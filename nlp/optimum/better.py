"""The better one of two answers."""

from __future__ import annotations

from dataclasses import replace

from .solution import Solution, Status

BETTER = 1e-7
"""Relative gain from which a basin or a known motion is worth a further descent."""


def better_of(one: Solution, other: Solution) -> Solution:
    """The first of two answers, unless the second is shorter, or as short and better founded.

    Parameters
    ----------
    one, other : Solution
        The time to build of the first, and iterations of both, go with the second.
    """
    if other.durations is None:
        return one
    shorter = other.best < one.best * (1 - BETTER)
    founded = other.best <= one.best * (1 + BETTER) and settled(other) and not settled(one)
    if one.durations is not None and not shorter and not founded:
        return one
    iterations = one.iterations + other.iterations
    return replace(other, build_seconds=one.build_seconds, iterations=iterations)


def settled(solution: Solution) -> bool:
    """Whether an answer meets the conditions of an optimum, or of a total that is not attained."""
    return solution.status in (Status.CONVERGED, Status.OPTIMAL, Status.NOT_ATTAINED)
