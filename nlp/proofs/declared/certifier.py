"""Certified interval of the least total of a declared curve, by stages of rising totals."""

from __future__ import annotations

import math
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import TOLERANCE, Array, Interpolant, Verdict, check
from ....verify import (
    PLACES,
    Clock,
    Refused,
    proof_kind,
)
from ..certifier import Certifier
from ..document import stated_problem
from ..driver import grow
from ..exact import ExactProblem, decimal
from ..rounding import down
from ..session import Ladder, OutOfTime, Session, Shorter
from .rows import NearLimits
from .search import BoxSearch, Curves, Found, Middle, TooSmall

_KIND = "declared"
"""Of the proof, as documents name it."""
_LADDER = Ladder(
    (0.3, *(x * 10.0**-k for k in range(1, 11) for x in (1.0, 0.3))),
    share=0.9,
    apart=1.5,
    near=0.2,
    growth=30.0,
)
"""From a gap of 0.1 on, boxes grow to 2 to 6 times as many, whatever the last gap; few are needed
for a gap of 0.3."""
_WEIGHT = 2.0**12
"""Sum of the weights of a leaf, about: finer ones spare no box at 1e-8, 1 in 80 at 1e-9."""
_SAFE = 1e-12
"""Share of the weights by which a bound is positive, so it is in other batches too."""
_FINE = 1e-9
"""A gap below it may be too narrow for the rounding of floats: no stage before it is left out."""
_DIGITS = 11
"""Of a total after its first: short in a certificate, and 1e-11 of a gap is not a loss."""
_JUDGING = 0.4
"""Seconds that judging takes for one of search: 0.1 to 0.3 were measured."""
_ABOVE = 1 + Fraction(1, 2**40)
"""Factor on the sum of all upper bounds that makes a total exceed every admissible one."""
_DOUBLINGS = 20
"""Of the total below which an answer is looked for: beyond, no joint moves at a limit."""
_FEW = {3: 5, 5: 3}
"""Segments of cubic and quintic splines up to which these boxes close every committed one to its
gap in no more seconds than its own kind takes; beyond, some last, and certificates are longer."""


class DeclaredCurves(Curves):
    """Any declared curve."""

    widest, evenly = 2.4, True

    def __init__(self, kind: Any) -> None:
        task = kind.task
        super().__init__(kind, NearLimits(task.segments, task.powers, task.caps, PLACES))
        self._gain = task.half[:, None] * (task.at @ task.across)

    def middle(self, sides: Array) -> Middle:
        """At the geometric means."""
        centre, form = self.kind.centre(sides), self.kind.task.form
        flat = form.basis.reshape(-1, form.basis.shape[-1])
        pieces = form.fixed + (flat @ centre.x).reshape(-1, *form.fixed.shape)
        rate = centre.y[:, None] @ (self._gain.T[:, :, None] * centre.g[:, None])
        moved = -(flat @ rate).reshape(*rate.shape[:2], *form.fixed.shape)
        return Middle(centre, centre.h, centre.e, pieces, moved)

    def pick(self, centre: Any, which: NDArray[np.int64]) -> Any:
        """Whatever it has, by box."""
        own = copy(centre)
        for name, value in vars(centre).items():
            setattr(own, name, value if name == "task" else value[which])
        return own

    def proved(
        self, middle: Middle, rows: NDArray[np.int64], weights: Array, tau: Array
    ) -> tuple[NDArray[np.bool_], Array, Array, Array]:
        """By limits that count as 1 at the centre of their segment."""
        tau, weights = np.rint(tau * _WEIGHT), np.rint(weights * _WEIGHT)
        excluded = middle.centre.least(tau, rows, weights) > _SAFE * _WEIGHT
        return excluded, tau, weights, np.ones_like(middle.h)


@dataclass(frozen=True, eq=False)
class Tree:
    """Boxes of durations that prove a total.

    ``head`` is what a kind of proof states beside rows and tree, with all its keys in their order.
    """

    total: Fraction
    head: dict[str, Any]
    found: Found

    def document(self) -> dict[str, Any]:
        """Of docs/explanation/certificates.md."""
        own = self.found.document()
        if "windows" not in self.head:
            del own["windows"]
        else:
            own["windows"] = [self.head["windows"][at] for at in own["windows"]]
        return self.head | {"total": decimal(self.total)} | own


def _kind(problem: ExactProblem, total: Fraction) -> Any:
    """The verifier's own kind of proof, without rows."""
    return proof_kind(_KIND)(
        stated_problem(problem), {"rows": [], "tree": []}, total, Clock(math.inf)
    )


def _declares(problem: ExactProblem) -> bool:
    free = problem.shares is None and not problem.chord
    return isinstance(problem.curve, Interpolant) and free


@lru_cache(maxsize=64)
def _missing(problem: ExactProblem) -> str | None:
    # Asked several times of one problem, and answered by the exact form of its curve.
    limited = any(x is not None for j in range(len(problem.joints)) for r in (1, 2, 3)
                  for x in problem.sides(j, r))  # fmt: skip
    if not limited and not any(problem.duration_lower):
        return "nothing limits the total from below"
    try:
        _kind(problem, Fraction(1)).root()
    except Refused as error:
        return f"{problem.curve.name}: {error}"
    return None


class BoxStages:
    """What the stages of a run share, for all proofs by boxes that are computed in floats."""

    def __init__(self, session: Session) -> None:
        self.session = session

    def curves(self, target: Fraction) -> tuple[Curves, float, dict[str, Any]]:
        """What is said of boxes for a total, the unit of time in s, and the head of the proof."""
        kind = _kind(self.session.exact, target)
        return DeclaredCurves(kind), float(kind.second), {"kind": _KIND, "total": ""}

    def stage(self, target: Fraction) -> Tree:
        """Prove that no total is below ``target``, s."""
        session, before = self.session, self.session.nodes
        curves, second, head = self.curves(target)
        boxes = BoxSearch(
            curves,
            lambda h: self._look(h * second, target),
            lambda waiting, done: session.report(waiting, before + done),
        )
        try:
            grow(boxes, [[(1, curves.kind.root())]], session)
        except TooSmall:
            raise OutOfTime from None
        return Tree(target, head, boxes.found)

    def _look(self, durations: Array, target: Fraction) -> None:
        """Raise `Shorter` if a direction of these durations holds a total below the one given."""
        if not len(durations):
            return
        floats = self.session.floats
        rest = floats.curve.homogeneous
        tried = self.session.stretched(durations) if rest else durations
        totals = tried.sum(axis=1)
        totals[(tried > floats.duration_upper).any(axis=1)] = math.inf
        for best in totals.argsort():
            # What is shorter by less than the tolerance is not worth a new start of the ladder.
            if not totals[best] < float(target) * (1 - TOLERANCE):
                break
            # The stretch knows nothing of positions, and there is none for ends in motion.
            if check(floats, tried[best]).verdict is Verdict.PASS:
                raise Shorter(tried[best])


def _beyond(exact: ExactProblem) -> Found | None:
    """A way-point beyond a position limit, which no durations help."""
    virtual = exact.piecewise.virtual
    breaks = [b for b in range(exact.segments + 1) if b not in virtual]
    for b, angles in zip(breaks, exact.waypoints, strict=True):
        for j, x in enumerate(angles):
            for sign, ends in ((1, exact.position_upper[j]), (-1, exact.position_lower[j])):
                if ends is not None and sign * x > max(sign * y for y in ends.ends):
                    found = Found()
                    segment, place = (b, 0) if b < exact.segments else (b - 1, PLACES)
                    found.leaves[1] = ((segment, j, 0, sign, place),)
                    return found
    return None


def _rising(session: Session) -> Iterator[Fraction]:
    """Totals below which an answer is looked for where the local search finds none."""
    longest = [x for x in session.exact.duration_upper if x is not None]
    if len(longest) == session.exact.segments:
        yield sum(longest, Fraction(0)) * _ABOVE
        return
    # The total that its own least durations add up to. They shrink as it grows, by its square at
    # most, so each step halves the distance in logarithms at least.
    before, total = Fraction(0), Fraction(1)
    while abs(total - before) > TOLERANCE * total:
        kind = _kind(session.exact, total)
        least = sum(kind.shortest) * float(kind.second)
        before, total = total, Fraction(math.sqrt(float(total) * least))
    for _ in range(_DOUBLINGS):
        total *= 2
        yield total


def _prove(session: Session) -> bool:
    # A stage that was interrupted begins anew: of a stopped run only the proof counts.
    beyond = _beyond(session.exact)
    if beyond is not None:
        head = {"kind": _KIND, "total": ""}
        session.keep(Fraction(1), Tree(Fraction(1), head, beyond))
        session.infeasible = True
        return True
    session.judging = _JUDGING
    session.seek()
    stages = BoxStages(session)
    totals = _rising(session)
    while session.upper is None:
        total = next(totals, None)
        if total is None:
            return False
        try:
            session.keep(total, stages.stage(total))
        except Shorter as found:
            if not session.seek(found.durations):
                raise OutOfTime from None  # the improvement is too slight to prove
        else:
            session.infeasible = None not in session.exact.duration_upper
            if session.infeasible:
                return True
    ladder = _LADDER if session.request.gap >= _FINE else replace(_LADDER, near=0.0)
    session.climb(ladder, partial(down, digits=_DIGITS), stages.stage)
    return True


DECLARED = Certifier(
    "declared piecewise polynomials, each segment with a least duration",
    _declares,
    _missing,
    _prove,
    boxes=20_000,
    sided=True,
    moving=True,
)
"""Of any degrees, continuity and rest: 3-5-3, 4-3-4, septic splines and the like."""

WITHOUT_VIRTUAL = replace(
    DECLARED,
    declares=lambda problem: (
        _declares(problem) and not problem.piecewise.virtual and _missing(problem) is None
    ),
)
"""Leaves other kinds what they alone do: virtual way-points near the others, and segments in which
nothing moves."""

FEW_SEGMENTS = replace(
    WITHOUT_VIRTUAL,
    declares=lambda problem: (
        WITHOUT_VIRTUAL.declares(problem)
        and problem.segments <= _FEW.get(max(problem.piecewise.degrees), 0)
    ),
)
"""Stands in front of the kinds for cubic and quintic splines."""
