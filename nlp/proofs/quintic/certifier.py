"""Certified interval of the least total of a C4 quintic spline, by stages of rising totals."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from ....problem import Interpolant
from ....verify import (
    MOST_POWER,
    SHORTEST_TOTAL,
    Clock,
    Refused,
    proof_kind,
)
from ..certifier import Certifier
from ..declared import BoxStages, Curves, Found, Tree
from ..document import stated_problem
from ..exact import ExactProblem, decimal
from ..rounding import below
from ..session import Ladder, Session
from .curves import QuinticCurves
from .windows import windows

_KIND = "quintic-spline"
"""Of the proof, as documents name it."""
_LADDER = Ladder(
    (0.3, 0.2, 0.1, 0.05, *(x * 10.0**-k for k in range(2, 7) for x in (2.0, 1.0, 0.5))),
    share=0.9,
    apart=1.5,
    near=0.2,
    growth=70.0,
)
"""Boxes grow with a power of 1/gap: small steps keep a stopped run near its goal. From 0.2 on they
grow to 15 to 20 times as many, and judging takes on one core as long again as the search."""


def _declares(problem: ExactProblem) -> bool:
    curve = problem.curve
    return (
        isinstance(curve, Interpolant)
        and curve.segments > 1
        and set(curve.degrees) == {5}
        and set(curve.continuity) == {4}
        and not curve.virtual
    )


def _missing(problem: ExactProblem) -> str | None:
    own = OwnUnits(problem)
    try:
        _kind(problem, own.head([]), own.time)
    except Refused as error:
        return f"{problem.curve.name}: {error}"
    if all(problem.duration_lower):
        return None
    if not np.isfinite(own.limits).any() and not any(problem.duration_lower):
        return "nothing limits the total from below"
    moving = np.asarray(own.steps.any(axis=0), dtype=np.bool_)
    if not (np.isfinite(own.limits[:, :2]) & moving[:, None]).any():
        return "no joint that moves has a velocity or acceleration limit"
    return None


class OwnUnits:
    """A problem in floats, in units in which steps and total are not far from 1.

    They are powers of two, which spoil no digit; where the problem's own units do, they are those.
    Weights, multipliers and totals of a proof have ranges, which these units keep to: joint j is
    measured in 2**powers[j] of the problem's unit of angle, time in 2**second s. ``low`` are the
    least durations.
    """

    def __init__(self, problem: ExactProblem) -> None:
        exact = [
            [b - a for a, b in zip(*pair, strict=True)] for pair in pairwise(problem.waypoints)
        ]
        # The looser ends of the limits; one of 0 takes no part.
        caps = [[None if x is None or x.high <= 0 else x.high for x in row]
                for row in problem.limits]  # fmt: skip
        steps = np.array([[float(x) for x in row] for row in exact])
        limits = np.array([[math.inf if x is None else float(x) for x in row] for row in caps])
        powers = np.array([_power(float(column.max())) for column in np.abs(steps).T])
        needs = np.abs(steps[:, :, None] / limits) ** (1.0 / np.arange(1, 4))
        bounds = np.array([float(x) for x in problem.duration_lower])
        self.powers = powers.tolist()
        self.second = _power(float(np.maximum(bounds, needs.max(axis=(1, 2))).sum()))
        self.time = Fraction(2) ** self.second
        self.steps = steps / 2.0**powers
        times = 2.0 ** (self.second * np.array([1.0, 2.0, 3.0]))
        self.limits = limits * times / 2.0 ** powers[:, None]
        # By their bounds and by the mean velocities.
        least = [
            max([low, *(abs(x) / v for x, (v, *_) in zip(row, caps, strict=True) if v is not None)])
            for low, row in zip(problem.duration_lower, exact, strict=True)
        ]
        self.low = tuple(below(x / self.time) for x in least)

    def head(self, library: list[list[int]]) -> dict[str, Any]:
        """What a certificate states beside rows and tree."""
        return {
            "kind": _KIND,
            "total": "",
            "powers": list(self.powers),
            "second": self.second,
            "low": [decimal(x * self.time) for x in self.low],
            "windows": library,
        }


class QuinticStages(BoxStages):
    """Windows that exclude boxes, in the units of the proof, which all stages share."""

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._own = own = OwnUnits(session.exact)
        assert session.durations is not None
        near = np.array([float(h / own.time) for h in session.durations])
        self._windows = windows(own.steps, own.limits, near, clock=session.check_clock)

    def rounded(self, total: Fraction) -> Fraction:
        """A total that is exact in floating point in the units of the proof, s."""
        return below(total / self._own.time) * self._own.time

    def curves(self, target: Fraction) -> tuple[Curves, float, dict[str, Any]]:
        """Those of the verifier's own kind."""
        head = self._own.head(self._windows)
        kind = _kind(self.session.exact, head, target)
        return QuinticCurves(kind), float(self._own.time), head


def _kind(problem: ExactProblem, head: dict[str, Any], total: Fraction) -> Any:
    """The verifier's, without rows."""
    proof = head | {"rows": [], "tree": []}
    return proof_kind(_KIND)(stated_problem(problem), proof, total, Clock(math.inf))


def _power(size: float) -> int:
    """Of two, for a size far from 1; else 0."""
    power = math.frexp(size)[1] if size > 0.0 else 0
    return 0 if abs(power) <= 8 else max(-MOST_POWER, min(MOST_POWER, power))


def _keep_mean_velocities(session: Session) -> None:
    """Bound the total by the sum of the least durations: one leaf proves it, in no time."""
    own = OwnUnits(session.exact)
    low = own.low
    # The first box is to be empty by far more than the verifier's slack.
    total = below(sum(low, Fraction(0)) * (1 - Fraction(1, 10**9)))
    if total > SHORTEST_TOTAL:
        tree = Tree(total * own.time, own.head([]), Found(leaves={1: ()}))
        session.keep_at_once(total * own.time, tree)


def _prove(session: Session) -> bool:
    # A stage that was interrupted begins anew: of a stopped run only the proof counts.
    _keep_mean_velocities(session)
    session.seek()
    if session.upper is None:
        return False
    # Judging takes as long as the search on one core: 0.9 to 1.1 times were measured.
    session.judging = 1.2
    stages = QuinticStages(session)
    session.climb(_LADDER, stages.rounded, stages.stage)
    return True


QUINTIC = Certifier(
    "C4 quintic splines without virtual way-points, at rest at the ends",
    _declares,
    _missing,
    _prove,
    boxes=20_000,
    prepares=True,
)
"""At rest alone: the windows and the nodal equations are derived for it."""
