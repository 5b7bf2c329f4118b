"""A proved interval of the least total for C2 cubic splines: stages and answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from fractions import Fraction

import numpy as np

from ....problem import Array
from ....verify import MOST_CUBIC_SEGMENTS
from ..certifier import Certifier
from ..document import stated_problem
from ..driver import grow
from ..exact import ExactProblem
from ..session import Ladder, Session
from .search import CubicStage
from .system import CubicSystem, cubic_system, declares
from .tree import Prover, Tree, regrown

_LADDER = Ladder((0.1, 0.01, 1e-3, 1e-4, 1e-5), 0.98, 3.0)
"""A lower cap narrows every box from the start: each stage is cheap beside the next."""
_NEAR = 0.1
"""A stage starts anew if a better answer lowers its goal by this share of its gap."""


class _Run:
    """The stages of one run: a tree, the ticks to prove in it, and the goal to start anew below."""

    def __init__(self, session: Session) -> None:
        self.session, self.stated = session, stated_problem(session.exact)
        self._shortest_tried = math.inf

    def stages(self, resumed: Tree | None) -> Iterator[tuple[Tree, Callable[[], int], int]]:
        """Stages, each when the one before is over."""
        session = self.session
        if session.upper is None:
            longest = [x for x in session.exact.duration_upper if x is not None]
            if len(longest) < session.exact.segments:
                return
            system = cubic_system(self.stated, sum(longest, Fraction(0)), 1)
            cap = system.cap
            yield self._tree(system), lambda: cap if session.upper is None else 0, cap
        if session.upper is None:
            return
        if resumed is not None:
            own = resumed.prover.system
            yield resumed, lambda: self._ticks(0.0, own), 0
        for gap in _LADDER.stages(session.request.gap):
            asked = session.request.gap
            # Near a stage that others follow is enough; the last one has to reach what is asked.
            wanted = gap * (1 + _NEAR) if gap > asked else asked
            while session.lower < self._target(wanted):
                yield self._below(gap)

    def _below(self, gap: float) -> tuple[Tree, Callable[[], int], int]:
        """A stage whose cap lies this far below the answer."""
        system = cubic_system(self.stated, self._target(gap))
        restart = math.floor(system.cap * (1 - _NEAR * gap))
        return self._tree(system), lambda: self._ticks(gap, system), restart

    def _tree(self, system: CubicSystem) -> Tree:
        prover = Prover(system)
        return Tree(prover, prover.root())

    def _target(self, gap: float) -> Fraction:
        assert self.session.upper is not None
        return self.session.upper * (1 - Fraction(gap))

    def _ticks(self, gap: float, system: CubicSystem) -> int:
        """The target for a gap, in ticks."""
        wanted = max(gap, _LADDER.share * self.session.request.gap)
        return math.floor(self._target(wanted) / system.unit)

    def improve(self, system: CubicSystem, point: Array) -> None:
        """Start the local solver from a point of the relaxation, if it is a better start."""
        session = self.session
        h = np.array(
            [sum(x * point[c] for c, x in piece.items()) for piece in system.exact.lengths]
        )
        if not (h > 0).all():
            return
        tried = session.stretched(h[None] * float(system.exact.second))[0]
        known = math.inf if session.upper is None else float(session.upper)
        # A solve costs more than a box: what is shorter by less than a millionth is no start.
        if tried.sum() < min(known, self._shortest_tried) * (1 - 1e-6):
            self._shortest_tried = float(tried.sum())
            session.seek(tried)


def _prove(session: Session) -> bool:
    # Judging takes a fourth to a third of the search.
    run, nodes, session.judging = _Run(session), 0, 0.4
    # The steps that a state proposes are proved on the way, or it is refused.
    pending = None
    if session.proposals is not None:
        document = session.proposals.document()
        pending = session.read(lambda: regrown(run.stated, document, session.check_clock))
    if pending is not None:
        session.keep(pending.seconds, pending)
        session.proposals = pending.proposed
    session.seek()
    for tree, goal, restart in run.stages(pending):

        def watch(now: Tree, waiting: int, boxes: int, before: int = nodes) -> None:
            session.report(waiting, before + boxes, now.seconds)

        stage = CubicStage(tree, goal, restart, run.improve, watch)
        try:
            grow(stage, tree.root.leaves(), session)
        finally:
            nodes += stage.boxes
            session.keep(stage.tree.seconds, stage.tree)
            session.proposals = stage.tree.proposed
            session.report(sum(1 for _ in tree.root.leaves()), nodes)
        if stage.finest:
            return False
    longest = [x for x in session.exact.duration_upper if x is not None]
    above = len(longest) == session.exact.segments and session.lower > sum(longest)
    session.infeasible = session.upper is None and above
    return True


def _missing(problem: ExactProblem) -> str | None:
    if problem.segments > MOST_CUBIC_SEGMENTS:
        return f"more than {MOST_CUBIC_SEGMENTS} segments"
    if any(problem.duration_lower):
        return None
    exact = cubic_system(stated_problem(problem), Fraction(1)).exact
    moving = [any(column) for column in zip(*exact.steps, strict=True)]
    bounded = any(exact.fastest(j)[0] is not None for j, moves in enumerate(moving) if moves)
    return None if bounded else "nothing limits the total from below"


CUBIC = Certifier(
    "C2 cubic splines (clamped, natural, virtual)", declares, _missing, _prove, boxes=16
)
"""The ends that the verifier knows: only for them are the equations derived."""
