"""Fixed ratios of the durations: one place, joint and derivative bounds the total from below."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import Interpolant, extrema, fit
from ....problem.curves import StretchedUniformBSpline
from ....verify import LEAF, PLACES
from ...optimum import solve
from ..answer import exact_coefficients, uniform_coefficients
from ..certifier import Certifier
from ..exact import ExactProblem, decimal
from ..rounding import root_below
from ..session import Session
from .rest_polynomials import at

MOST_REBUILT = 40
"""Of a curve that is rebuilt in rational numbers: its digits grow with each, and so many segments
of three joints take half a second."""


@dataclass(frozen=True)
class BoundingPlace:
    """Where every total below ``total`` breaks a limit.

    ``joint`` is −1 for the lower bound of the segment's duration; ``place`` counts in 1/PLACES.
    """

    total: Fraction
    segment: int
    joint: int = -1
    order: int = 0
    place: int = 0

    def document(self) -> dict[str, Any]:
        """Kind "fixed-ratios" of docs/explanation/certificates.md."""
        leaf = [LEAF, self.joint, self.order, self.segment, self.place]
        return {"kind": "fixed-ratios", "total": decimal(self.total), "tree": [leaf]}


def _missing(problem: ExactProblem) -> str | None:
    curve = problem.curve
    if problem.chord:
        return (
            "chord lengths of several joints are no rational numbers, so that no certificate "
            "states them exactly; write the ratios as numbers"
        )
    formula = "at fixed ratios the optimum is a formula, and `solve` gives it"
    if isinstance(curve, Interpolant) and curve.free:
        return f"{curve.name} leaves {curve.free} coefficients free: not covered at fixed ratios"
    if not isinstance(curve, Interpolant | StretchedUniformBSpline):
        return f"{curve.name}: not rebuilt in rational numbers; {formula}"
    if problem.segments > MOST_REBUILT:
        return f"more than {MOST_REBUILT} segments: not rebuilt in rational numbers; {formula}"
    return None


def _bounds(session: Session) -> Iterator[BoundingPlace]:
    """Totals that are proved: by a bound on a duration, and by the limit that asks for most."""
    exact, shares = session.exact, session.exact.shares
    assert shares is not None
    least = [low / share for low, share in zip(exact.duration_lower, shares, strict=True)]
    k = max(range(len(least)), key=least.__getitem__)
    yield BoundingPlace(least[k], k)
    found = _asking_most(session)
    if found is None:
        return
    joint, order, segment, place = found
    value = _value(exact, joint, order, segment, place)
    limit = exact.sides(joint, order)[1 if value > 0 else 0]
    if value and limit is not None and limit.high > 0:
        yield BoundingPlace(
            root_below(abs(value) / limit.high, order), segment, joint, order, place
        )


def _asking_most(session: Session) -> tuple[int, int, int, int] | None:
    """Joint, order, segment and place of the extremum that asks for the longest total."""
    problem = session.floats
    shares = np.array([float(x) for x in session.exact.shares or ()])
    motion = fit(problem.curve, problem.waypoints, shares)
    best, found = 0.0, None
    for j in range(len(problem.joints)):
        for order in (1, 2, 3):
            for e in extrema(motion, j, order):
                limit = float(problem.limits.sides[int(e.value > 0.0), j, order - 1])
                asked = (abs(e.value) / limit) ** (1 / order) if limit > 0 else 0.0
                if asked > best and math.isfinite(asked):
                    best, found = asked, (j, order, e.segment, round(e.s * PLACES))
    return found


def _value(exact: ExactProblem, joint: int, order: int, segment: int, place: int) -> Fraction:
    """Derivative at a place if the total is 1 s."""
    assert exact.shares is not None
    if isinstance(exact.curve, StretchedUniformBSpline):
        curves = uniform_coefficients(exact.waypoints)
    else:
        found = exact_coefficients(exact.piecewise, exact.waypoints, exact.shares)
        if found is None:  # the conditions determine no curve at these ratios
            return Fraction(0)
        curves = found
    poly = [math.perm(p, order) * c for p, c in enumerate(curves[joint][segment])][order:]
    return at(poly, Fraction(place, PLACES)) / exact.shares[segment] ** order


def _prove(session: Session) -> bool:
    for place in _bounds(session):
        session.keep(place.total, place)
    answer = solve(session.floats)
    if answer.durations is not None and session.offer(answer.durations):
        return True
    shares = session.exact.shares or ()
    session.infeasible = any(
        top is not None and session.lower * share > top
        for share, top in zip(shares, session.exact.duration_upper, strict=True)
    )
    return True


FIXED_RATIOS = Certifier(
    "curves at fixed ratios of the durations",
    lambda problem: problem.chord or problem.shares is not None,
    _missing,
    _prove,
    instant=True,
    sided=True,
)
"""The total is the one unknown, whatever the curve: this kind stands in front of all others."""
