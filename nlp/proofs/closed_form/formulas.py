"""Optima that are formulas: of each segment separately, or of the total at fixed ratios.

The verifier gives the exact value of a derivative at a place; floats only say at which one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ....problem import Array, Extremum, Interpolant, extrema, fit
from ....problem.curves import StretchedUniformBSpline
from ....verify import LEAF, PLACES, Clock, Refused, proof_kind
from ...optimum import solve
from ..certifier import Certifier
from ..document import stated_problem
from ..exact import ExactProblem, decimal
from ..outcome import WrittenProof
from ..rounding import root_below
from ..session import Session

MOST_REBUILT = 40
"""Segments of a curve that is rebuilt in rational numbers: its digits grow with each, and so many
segments of three joints take half a second."""


@dataclass(frozen=True)
class LeastTime:
    """Why a segment, or the total, takes at least so long: a limit at a place, or a lower bound.

    ``joint`` is −1 for the lower bound of the segment's duration; ``place`` counts in 1/PLACES.
    """

    least: Fraction
    segment: int
    joint: int = -1
    order: int = 0
    place: int = 0


def _keep(session: Session, kind: str, total: Fraction, leaf: list[Any]) -> None:
    """Keep a proof of one leaf, as docs/explanation/certificates.md has it."""
    tree = [[LEAF, *leaf]]
    session.keep(total, WrittenProof({"kind": kind, "total": decimal(total), "tree": tree}))


def _exact_kind(name: str, problem: ExactProblem) -> Any:
    """The verifier's own kind of proof."""
    return proof_kind(name)(stated_problem(problem), {}, Fraction(0), Clock(math.inf))


def _is(name: str, problem: ExactProblem) -> bool:
    """Whether the verifier takes a problem's curve for one of a kind."""
    try:
        _exact_kind(name, problem)
    except Refused:
        return False
    return True


def _asking(session: Session, durations: Array) -> Iterator[tuple[Extremum, float]]:
    """Extrema of all derivatives, and the factor by which time is to be stretched for their limits.

    A limit that is not there, or 0, asks for nothing.
    """
    problem = session.floats
    motion = fit(problem.curve, problem.waypoints, durations)
    for j in range(len(problem.joints)):
        for order in (1, 2, 3):
            for e in extrema(motion, j, order):
                limit = float(problem.limits.sides[int(e.value > 0.0), j, order - 1])
                asked = (abs(e.value) / limit) ** (1 / order) if limit > 0 else 0.0
                if math.isfinite(asked):
                    yield e, asked


def _proved(kind: Any, e: Extremum, share: Fraction = Fraction(1)) -> LeastTime | None:
    """What an extremum proves of the segment that it is in, or of the total that it shares in."""
    place = round(e.s * PLACES)
    try:
        order, power = kind.at(e.joint, e.segment, e.order, place)
    except Refused:  # nothing is limited on the side of the value
        return None
    if not power:
        return None
    return LeastTime(root_below(power / share**order, order), e.segment, e.joint, order, place)


def _prove_segments(name: str, session: Session) -> bool:
    exact, n = session.exact, session.exact.segments
    kind = _exact_kind(name, exact)
    bounds = [LeastTime(low, k) for k, low in enumerate(exact.duration_lower)]
    longest = np.array([float(low) for low in exact.duration_lower])
    asking: list[Extremum | None] = [None] * n
    for e, asked in _asking(session, np.ones(n)):
        if asked > longest[e.segment]:
            longest[e.segment], asking[e.segment] = asked, e
    for k, most in enumerate(asking):
        found = None if most is None else _proved(kind, most)
        bounds[k] = bounds[k] if found is None or found.least < bounds[k].least else found
    leaf = [[b.joint, b.order, b.place, decimal(b.least)] for b in bounds]
    _keep(session, name, sum((b.least for b in bounds), Fraction(0)), leaf)
    # Nothing moves in a segment that asks for no time: a billionth of the total will do.
    still = max(float(longest.sum()), 1e-3) * 1e-9
    if not session.offer(np.maximum(longest, still)):
        session.infeasible = any(
            top is not None and b.least > top
            for b, top in zip(bounds, exact.duration_upper, strict=True)
        )
    return True


def _prove_total(session: Session) -> bool:
    exact, shares = session.exact, session.exact.shares
    assert shares is not None
    kind = _exact_kind("fixed-ratios", exact)
    lowest = [low / share for low, share in zip(exact.duration_lower, shares, strict=True)]
    k = max(range(len(lowest)), key=lowest.__getitem__)
    bounds: list[LeastTime | None] = [LeastTime(lowest[k], k)]
    asking = list(_asking(session, np.array([float(x) for x in shares])))
    if asking:
        with suppress(Refused):  # the conditions determine no curve at these ratios
            most, _ = max(asking, key=lambda one: one[1])
            bounds.append(_proved(kind, most, shares[most.segment]))
    for b in bounds:
        if b is not None:
            _keep(session, "fixed-ratios", b.least, [b.joint, b.order, b.segment, b.place])
    answer = solve(session.floats)
    if not answer.found or not session.offer(answer.durations):
        session.infeasible = any(
            top is not None and session.lower * share > top
            for share, top in zip(shares, exact.duration_upper, strict=True)
        )
    return True


def _missing(problem: ExactProblem) -> str | None:
    """Why a problem at fixed ratios is not covered, or None."""
    curve = problem.curve
    if problem.chord:
        return (
            "chord lengths of several joints are not rational numbers, so no certificate can "
            "state them exactly; write the ratios as numbers"
        )
    formula = "at fixed ratios the optimum is a formula, and `solve` gives it"
    if isinstance(curve, Interpolant) and curve.free:
        return f"{curve.name} leaves {curve.free} coefficients free: not covered at fixed ratios"
    if not isinstance(curve, Interpolant | StretchedUniformBSpline):
        return f"{curve.name}: not rebuilt in rational numbers; {formula}"
    if problem.segments > MOST_REBUILT:
        return f"more than {MOST_REBUILT} segments: not rebuilt in rational numbers; {formula}"
    return None


def _certifier(
    family: str,
    declares: Callable[[ExactProblem], bool],
    prove: Callable[[Session], bool],
    missing: Callable[[ExactProblem], str | None] = lambda _: None,
) -> Certifier:
    return Certifier(family, declares, missing, prove, instant=True, sided=True)


FIXED_RATIOS = _certifier(
    "curves at fixed ratios of the durations",
    lambda problem: problem.chord or problem.shares is not None,
    _prove_total,
    _missing,
)
"""The total is the one unknown, whatever the curve: this kind stands in front of all others."""
REST_TO_REST = _certifier(
    "rest-to-rest polynomials",
    partial(_is, "rest-to-rest"),
    partial(_prove_segments, "rest-to-rest"),
)
"""Rest at every way-point makes each segment a formula, whatever the odd degree."""
STRETCHED = _certifier(
    "uniform cubic B-splines stretched in time",
    partial(_is, "stretched"),
    partial(_prove_segments, "stretched"),
)
"""One curve alone: its segments do not know of each other, so each is a formula."""
