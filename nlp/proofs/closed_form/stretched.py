"""The uniform cubic B-spline with stretched segments: the optimum in closed form."""

from __future__ import annotations

import math
from fractions import Fraction

from ....problem.curves import StretchedUniformBSpline
from ..answer import uniform_coefficients
from ..exact import ExactProblem
from ..rounding import root_below
from ..session import Certifier
from ..three_piece import PLACES
from .rest_polynomials import STILL, SegmentBound, proving


def _declares(problem: ExactProblem) -> bool:
    return isinstance(problem.curve, StretchedUniformBSpline)


def _peak(piece: list[Fraction], order: int) -> tuple[int, Fraction, Fraction]:
    """A place (in 1/PLACES) of almost the largest |derivative|, its value there, and the largest.

    The first derivative is a parabola in e, the second a line, the third a constant.
    """
    poly = [math.perm(p, order) * c for p, c in enumerate(piece)][order:]
    exact, places = [Fraction(0), Fraction(1)], {0, PLACES}
    if order == 1 and poly[2]:
        vertex = -poly[1] / (2 * poly[2])
        if 0 < vertex < 1:
            exact.append(vertex)
            places.add(round(vertex * PLACES))
    values = {k: abs(_at(poly, Fraction(k, PLACES))) for k in places}
    best = max(values, key=lambda k: (values[k], k))
    return best, values[best], max(abs(_at(poly, e)) for e in exact)


def _at(poly: list[Fraction], e: Fraction) -> Fraction:
    return sum((c * e**p for p, c in enumerate(poly)), Fraction(0))


def closed_form(problem: ExactProblem) -> tuple[list[SegmentBound], list[float]]:
    """Least duration of every segment, proved, and durations to try as the answer.

    Parameters
    ----------
    problem : ExactProblem
        With a stretched uniform cubic B-spline.

    Returns
    -------
    bounds : list of SegmentBound
    durations : list of float
        s.
    """
    curves = uniform_coefficients(problem.waypoints)
    bounds, durations = [], []
    for k in range(problem.segments):
        best = SegmentBound(problem.duration_lower[k])
        longest = float(best.least)
        for j, limits in enumerate(problem.limits):
            for order, limit in enumerate(limits, start=1):
                if limit is None or limit.low <= 0:
                    continue
                place, value, top = _peak(curves[j][k], order)
                longest = max(longest, float(top / limit.low) ** (1 / order))
                least = root_below(value / limit.high, order) if value else Fraction(0)
                if least > best.least:
                    best = SegmentBound(least, j, order, place)
        bounds.append(best)
        durations.append(longest)
    still = max(sum(durations), 1e-3) * STILL
    return bounds, [max(h, still) for h in durations]


STRETCHED = Certifier(
    "uniform cubic B-splines stretched in time",
    _declares,
    lambda _: None,
    proving("stretched", closed_form),
    instant=True,
)
"""One curve alone: its segments do not know of each other, so that each is a formula."""
