"""A proved interval of the least total for C2 cubic splines: stages, answer, clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ....problem import Array
from ....verify import MOST_CUBIC_SEGMENTS, TICKS
from ..certifier import Certifier
from ..exact import ExactProblem
from ..session import Ladder, Session
from .ranges import implied
from .replay import replayed
from .search import Search
from .system import CubicSystem, cubic_system, kind_of_ends
from .tree import Prover, TickBox, proof_document

_LADDER = Ladder((0.1, 0.01, 1e-3, 1e-4, 1e-5), 0.98, 3.0)
"""A lower cap narrows every box from the start: each stage is cheap beside the next."""
_NEAR = 0.1
"""A stage starts anew if a better answer lowers its goal by this share of its gap."""
_BETTER = 1e-6
"""Share by which a start must be better than all before it: a solve costs more than a box."""


@dataclass(frozen=True, eq=False)
class Tree:
    """The proof of a lower bound, in ticks; unfinished: open boxes of it are proposed."""

    prover: Prover
    root: TickBox
    lower: int
    unfinished: bool = False

    @property
    def seconds(self) -> Fraction:
        """The lower bound, s."""
        return Fraction(self.lower, TICKS) * Fraction(2) ** self.prover.system.second

    def document(self) -> dict[str, Any]:
        """The proof, ready for JSON."""
        return proof_document(self.prover, self.root, self.lower, self.unfinished)


class _Watch:
    """What a search asks of the session between its steps."""

    def __init__(self, session: Session) -> None:
        self.session, self.crew = session, session.crew
        self.nodes = 0
        """Boxes of the stages that are over."""
        self._tried = math.inf

    @property
    def searching(self) -> float:
        """Seconds that are left."""
        return self.session.searching

    def clock(self) -> None:
        """Stop when time is up."""
        self.session.check_clock()

    def look(self, search: Search, under_way: int) -> None:
        """Stop when time is up, and report."""
        tree = Tree(search.prover, search.root, search.lower)
        self.session.weigh(search.worked, lambda: tree)
        self.session.check_clock()
        self.session.report(len(search.heap) + under_way, self.nodes + search.boxes, tree.seconds)

    def improve(self, system: CubicSystem, point: Array) -> None:
        """Start the local solver from a point of the relaxation, if it is a better start."""
        pieces = [system.piece(k).items() for k in range(system.pieces)]
        h = np.array([sum(x * point[c] for c, x in piece) for piece in pieces])
        if not (h > 0).all():
            return
        tried = self.session.stretched(h[None] * 2.0**system.second)[0]
        upper = self.session.upper
        known = math.inf if upper is None else float(upper)
        if tried.sum() < min(known, self._tried) * (1 - _BETTER):
            self._tried = float(tried.sum())
            self.session.seek(tried)


@dataclass(frozen=True, eq=False)
class _Stage:
    """A tree to work on, the ticks to prove in it, and the goal below which to start anew."""

    prover: Prover
    root: TickBox
    goal: Callable[[], int]
    restart: int = 0


def _prove(session: Session) -> bool:
    watch = _Watch(session)
    # The steps that a state proposes are proved on the way, or it is refused.
    pending = session.taken_up(
        lambda document: Tree(*replayed(session.exact, document, watch.clock))
    )
    if pending is not None:
        session.keep(pending.seconds, pending)
        session.proposals = replace(pending, unfinished=True)
    session.seek()
    for stage in _stages(session, pending):
        search = Search(watch, stage.prover, stage.root)
        try:
            finished = search.until(stage.goal, stage.restart)
        finally:
            watch.nodes += search.boxes
            tree = Tree(stage.prover, stage.root, search.lower)
            session.keep(tree.seconds, tree)
            session.proposals = replace(tree, unfinished=True)
            left = sum(1 for _ in stage.root.leaves())
            session.report(left, watch.nodes)
        if not finished:
            return False
    longest = [x for x in session.exact.duration_upper if x is not None]
    above = len(longest) == session.exact.segments and session.lower > sum(longest)
    session.infeasible = session.upper is None and above
    return True


def _stages(session: Session, resumed: Tree | None) -> Iterator[_Stage]:
    """Stages, each when the one before is over."""
    if session.upper is None:
        longest = [x for x in session.exact.duration_upper if x is not None]
        if len(longest) < session.exact.segments:
            return
        above = sum(longest, Fraction(0))
        system = cubic_system(session.exact, above)
        cap = math.floor(above / Fraction(2) ** system.second * TICKS) + 1
        prover = Prover(system, cap)
        yield _Stage(prover, prover.root(), lambda: cap if session.upper is None else 0, cap)
    if session.upper is None:
        return
    if resumed is not None:
        system = resumed.prover.system
        yield _Stage(resumed.prover, resumed.root, partial(_ticks, session, 0.0, system))
    for gap in _LADDER.stages(session.request.gap):
        asked = session.request.gap
        # Near a stage that others follow is enough; the last one has to reach what is asked for.
        wanted = gap * (1 + _NEAR) if gap > asked else asked
        while session.lower < _target(session, wanted):
            system = cubic_system(session.exact, _target(session, gap))
            cap = _ticks(session, gap, system)
            prover, goal = Prover(system, cap), partial(_ticks, session, gap, system)
            yield _Stage(prover, prover.root(), goal, math.floor(cap * (1 - _NEAR * gap)))


def _target(session: Session, gap: float) -> Fraction:
    assert session.upper is not None
    return session.upper * (1 - Fraction(gap))


def _ticks(session: Session, gap: float, system: CubicSystem) -> int:
    """The target for a gap, in ticks."""
    wanted = max(gap, _LADDER.share * session.request.gap)
    return math.floor(_target(session, wanted) / Fraction(2) ** system.second * TICKS)


def _declares(problem: ExactProblem) -> bool:
    return kind_of_ends(problem) is not None


def _missing(problem: ExactProblem) -> str | None:
    if problem.segments > MOST_CUBIC_SEGMENTS:
        return f"more than {MOST_CUBIC_SEGMENTS} segments"
    system = cubic_system(problem, Fraction(1))
    moving = [any(step[j] for step in system.steps) for j in range(system.joints)]
    speeds = [v for v, _ in implied(system, Fraction(1))]
    if any(math.isfinite(v) for v, moves in zip(speeds, moving, strict=True) if moves):
        return None
    return None if any(problem.duration_lower) else "nothing limits the total from below"


CUBIC = Certifier(
    "C2 cubic splines (clamped, natural, virtual)", _declares, _missing, _prove, boxes=16
)
"""The ends that `kind_of_ends` knows: only for them are the equations derived."""
