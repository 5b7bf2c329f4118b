"""Rest-to-rest polynomials: each duration stands alone, so the optimum is in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from ....problem import Interpolant
from ....verify import LEAF, PLACES
from ..answer import solve_exactly
from ..certifier import Certifier
from ..exact import ExactProblem, decimal
from ..rounding import root_below
from ..session import Session

STILL = 1e-9
"""Duration, as a share of the total, of a segment in which nothing moves."""


@dataclass(frozen=True)
class SegmentBound:
    """Why a segment takes at least ``least`` seconds: a limit at a place, or its own lower bound.

    ``joint`` is −1 for the lower bound of the duration.
    """

    least: Fraction
    joint: int = -1
    order: int = 0
    place: int = 0


@dataclass(frozen=True)
class SegmentBounds:
    """Bounds of all segments, as the proof of a certificate of kind ``kind``."""

    kind: str
    bounds: tuple[SegmentBound, ...]

    def document(self) -> dict[str, Any]:
        """Kinds "rest-to-rest" and "stretched" of docs/explanation/certificates.md."""
        leaf = [LEAF, *([b.joint, b.order, b.place, decimal(b.least)] for b in self.bounds)]
        total = sum((b.least for b in self.bounds), Fraction(0))
        return {"kind": self.kind, "total": decimal(total), "tree": [leaf]}


def is_rest_to_rest(problem: ExactProblem) -> bool:
    """Whether every segment starts and ends at rest, which then determines it."""
    interpolant = problem.curve
    if not isinstance(interpolant, Interpolant):
        return False
    orders = tuple((r, 0.0) for r in range(1, (interpolant.degrees[0] + 1) // 2))
    return (
        set(interpolant.degrees) == {2 * len(orders) + 1}
        and bool(orders)
        and set(interpolant.continuity) <= {0}
        and set(interpolant.prescribed) == {orders}
        and not interpolant.virtual
    )


def shape(degree: int) -> list[Fraction]:
    """Coefficients of the polynomial from 0 to 1 whose derivatives vanish at both ends."""
    half = (degree + 1) // 2
    start = [
        [Fraction(math.factorial(r) if p == r else 0) for p in range(degree + 1)]
        for r in range(half)
    ]
    end = [[Fraction(math.perm(p, r)) for p in range(degree + 1)] for r in range(half)]
    right = [[Fraction(0)] for _ in range(degree + 1)]
    right[half] = [Fraction(1)]
    solved = solve_exactly(start + end, right)
    assert solved is not None
    return [row[0] for row in solved]


def size(value: Fraction, sign: int) -> Fraction:
    """|value| for sign 0, else what lies to the side of the sign; 0 where nothing does."""
    return abs(value) if sign == 0 else max(sign * value, Fraction(0))


def peaks(degree: int, sign: int = 0) -> list[tuple[int, Fraction]]:
    """For orders 1 to 3, a place (in 1/PLACES) of the largest `size` of it, and that size."""
    found = []
    poly = shape(degree)
    for _ in range(3):
        poly = [p * c for p, c in enumerate(poly)][1:]
        slope = np.polynomial.Polynomial([float(p * c) for p, c in enumerate(poly)][1:] or [0.0])
        roots = np.real(slope.roots()) if slope.degree() else np.zeros(0)
        places = {0, PLACES, *(round(float(np.clip(s, 0, 1)) * PLACES) for s in roots)}
        values = {k: size(at(poly, Fraction(k, PLACES)), sign) for k in places}
        best = max(values, key=lambda k: (values[k], k))
        found.append((best, values[best]))
    return found


def at(poly: list[Fraction], s: Fraction) -> Fraction:
    """Value of a polynomial, its constant first."""
    return sum((c * s**p for p, c in enumerate(poly)), Fraction(0))


def closed_form(
    problem: ExactProblem, peak: Callable[[int, int, int, int], tuple[int, Fraction, Fraction]]
) -> tuple[list[SegmentBound], list[float]]:
    """Least duration of every segment, proved, and durations to try as the answer.

    Parameters
    ----------
    problem : ExactProblem
    peak : callable
        Of joint, segment, order and sign, if the segment takes 1 s: a place (in 1/PLACES) of almost
        the largest `size` of the derivative, its size there, and the largest.

    Returns
    -------
    bounds : list of SegmentBound
    durations : list of float
        s.
    """
    bounds, durations = [], []
    for k in range(problem.segments):
        best = SegmentBound(problem.duration_lower[k])
        longest = float(best.least)
        for j, order in product(range(len(problem.joints)), (1, 2, 3)):
            low, high = problem.sides(j, order)
            for sign, limit in ((-1, low), (1, high)) if low != high else ((0, high),):
                if limit is None or limit.low <= 0:
                    continue
                place, value, top = peak(j, k, order, sign)
                longest = max(longest, float(top / limit.low) ** (1 / order))
                least = root_below(value / limit.high, order) if value else Fraction(0)
                if least > best.least:
                    best = SegmentBound(least, j, order, place)
        bounds.append(best)
        durations.append(longest)
    still = max(sum(durations), 1e-3) * STILL
    return bounds, [max(h, still) for h in durations]


def _closed_form(problem: ExactProblem) -> tuple[list[SegmentBound], list[float]]:
    tops = {sign: peaks(problem.piecewise.degrees[0], sign) for sign in (-1, 0, 1)}

    def peak(joint: int, segment: int, order: int, sign: int) -> tuple[int, Fraction, Fraction]:
        way = problem.waypoints[segment + 1][joint] - problem.waypoints[segment][joint]
        place, top = tops[sign if way >= 0 else -sign][order - 1]
        return place, abs(way) * top, abs(way) * top

    return closed_form(problem, peak)


def proving(
    kind: str, closed: Callable[[ExactProblem], tuple[list[SegmentBound], list[float]]]
) -> Callable[[Session], bool]:
    """A proof from bounds of the segments, and durations to try as the answer."""

    def prove(session: Session) -> bool:
        bounds, durations = closed(session.exact)
        session.keep(
            sum((b.least for b in bounds), Fraction(0)), SegmentBounds(kind, tuple(bounds))
        )
        longest = session.exact.duration_upper
        if not session.offer(np.array(durations)):
            session.infeasible = any(
                u is not None and b.least > u for b, u in zip(bounds, longest, strict=True)
            )
        return True

    return prove


REST_TO_REST = Certifier(
    "rest-to-rest polynomials",
    is_rest_to_rest,
    lambda _: None,
    proving("rest-to-rest", _closed_form),
    instant=True,
    sided=True,
)
"""Rest at every way-point makes each segment a formula, whatever the odd degree."""
