"""Exact shares of the segments in the total, where ratios of the durations are fixed."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import Any

from ...problem import Problem
from ...problem.cases import Statement


def exact_shares(ratios: Iterable[Any] | None) -> tuple[Fraction, ...] | None:
    """Ratios of any scale as exact shares of their sum."""
    if ratios is None:
        return None
    exact = [Fraction(x) for x in ratios]
    total = sum(exact, Fraction(0))
    return tuple(x / total for x in exact)


def printed_shares(statement: Statement, problem: Problem) -> tuple[Fraction, ...] | None:
    """Exact shares of the segments from the printed ratios; None if there are none."""
    given = statement.durations.ratios
    if isinstance(given, tuple):
        return exact_shares(number.fraction for number in given)
    if given != "chord":
        return exact_shares(problem.ratios)
    if len(statement.joints) > 1:
        return None
    own = [row[statement.joints[0]].fraction for row in statement.waypoints.points]
    return exact_shares(abs(b - a) for a, b in pairwise(own))
