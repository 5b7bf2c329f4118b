"""A lower bound over any curve from one linear program, where no boxes are searched."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from ....problem import Array, cubic_spline
from ..exact import ExactProblem
from .question import question, unbounded
from .search import Search

_PART = 1000
"""Segments of one linear program: a certificate states no more, and the time is linear in them."""


def bound_at_once(problem: ExactProblem, durations: Array, speeds: Array) -> Fraction:
    """No motion of a problem is shorter, s; 0 if that is all that is proved.

    The verifier's rows hold in the one box of all durations. A linear program proposes their
    weights, and the verifier adds them up in rationals. Longer paths are divided: the least total
    is at least the sum of those of the parts, whose ends may have any speed.

    Parameters
    ----------
    problem : ExactProblem
    durations : ndarray, shape (way-points − 1,)
        Of a motion near the optimum, between way-points, s.
    speeds : ndarray, shape (way-points, joints)
        Its speeds there, in the problem's unit of angle.

    Raises
    ------
    Refused
        If no certificate can state the problem.
    """
    total = Fraction(0)
    for first, part in _parts(problem):
        asked, count = question(part), len(part.waypoints)
        if unbounded(part, asked) is None:
            own, near = durations[first:][: count - 1], speeds[first:][:count]
            search = Search(asked, Fraction(float(own.sum())))
            total += search.at_once(own, near[:, list(asked.joints)])
    return total


def _parts(problem: ExactProblem) -> Iterator[tuple[int, ExactProblem]]:
    """Parts that a certificate can state, and the first way-point of each."""
    breaks = problem.curve.waypoint_breaks
    if problem.segments <= _PART:
        yield 0, problem
        return
    for first in range(0, len(breaks) - 1, _PART):
        places = breaks[first : first + _PART + 1]
        count = len(places) - 1
        yield (
            first,
            replace(
                problem,
                curve=cubic_spline(count, ()),
                waypoints=problem.waypoints[first : first + count + 1],
                duration_lower=tuple(
                    sum(problem.duration_lower[a:b], Fraction(0)) for a, b in pairwise(places)
                ),
                duration_upper=(None,) * count,
                prescribed=None,
                shares=None,
                chord=False,
            ),
        )
