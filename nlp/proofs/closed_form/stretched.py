"""The uniform cubic B-spline with stretched segments: the optimum in closed form."""

from __future__ import annotations

import math
from fractions import Fraction

from ....problem.curves import StretchedUniformBSpline
from ....verify import PLACES
from ..answer import uniform_coefficients
from ..certifier import Certifier
from ..exact import ExactProblem
from .rest_polynomials import SegmentBound, at, closed_form, proving, size


def _declares(problem: ExactProblem) -> bool:
    return isinstance(problem.curve, StretchedUniformBSpline)


def _peak(piece: list[Fraction], order: int, sign: int) -> tuple[int, Fraction, Fraction]:
    """A place (in 1/PLACES) of almost the largest `size`, the size there, and the largest.

    The first derivative is a parabola in e, the second a line, the third a constant.
    """
    poly = [math.perm(p, order) * c for p, c in enumerate(piece)][order:]
    exact, places = [Fraction(0), Fraction(1)], {0, PLACES}
    if order == 1 and poly[2]:
        vertex = -poly[1] / (2 * poly[2])
        if 0 < vertex < 1:
            exact.append(vertex)
            places.add(round(vertex * PLACES))
    values = {k: size(at(poly, Fraction(k, PLACES)), sign) for k in places}
    best = max(values, key=lambda k: (values[k], k))
    return best, values[best], max(size(at(poly, e), sign) for e in exact)


def _closed_form(problem: ExactProblem) -> tuple[list[SegmentBound], list[float]]:
    curves = uniform_coefficients(problem.waypoints)
    return closed_form(problem, lambda joint, k, order, sign: _peak(curves[joint][k], order, sign))


STRETCHED = Certifier(
    "uniform cubic B-splines stretched in time",
    _declares,
    lambda _: None,
    proving("stretched", _closed_form),
    instant=True,
    sided=True,
)
"""One curve alone: its segments do not know of each other, so that each is a formula."""
