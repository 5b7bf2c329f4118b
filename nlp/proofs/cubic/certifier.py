"""A proved interval of the least total for C2 cubic splines: stages and answers."""

from __future__ import annotations

import math
from contextlib import suppress
from fractions import Fraction

import numpy as np

from ....problem import Array
from ....verify import OutOfTime, Refused
from ..certifier import Certifier
from ..declared import WITHOUT_VIRTUAL
from ..document import stated_problem
from ..driver import grow
from ..exact import ExactProblem
from ..session import Ladder, Session, Shorter
from .search import CubicStage
from .system import CubicSystem, cubic_system, declares, in_ticks
from .tree import Prover, Tree, regrown

_LADDER = Ladder((0.1, 0.01, 1e-3, 1e-4, 1e-5), 0.98, 3.0)
"""A lower cap narrows every box from the start: each stage is cheap beside the next."""
_NEAR = 0.1
"""A stage ends if a better answer lies this share of the gap below: the next has a lower cap."""


class _Run:
    """What the stages of one run share."""

    def __init__(self, session: Session) -> None:
        self.session, self.stated = session, stated_problem(session.exact)
        self._shortest_tried = self._ends = math.inf

    def stage(self, target: Fraction, more: int = 0) -> Tree:
        """Prove that no total is below ``target``, s, and so many ticks."""
        system = cubic_system(self.stated, target, more)
        prover = Prover(system)
        return self.grown(Tree(prover, prover.root()), system.cap * system.unit)

    def grown(self, tree: Tree, target: Fraction) -> Tree:
        """A tree that proves that no total is below ``target``, s, or as much as its boxes can.

        Raises
        ------
        Shorter
            If an answer turns up that is better by far.
        OutOfTime
            If boxes are as small as they may get, too.
        """
        session, before, upper = self.session, self.session.nodes, self.session.upper
        self._ends = math.inf if upper is None else float(upper - _NEAR * (upper - target))
        stage = CubicStage(
            tree,
            target,
            self._improve,
            lambda now, waiting, done: session.report(waiting, before + done, now.seconds),
        )
        try:
            grow(stage, tree.root.leaves(), session)
        finally:
            tree = stage.tree
            session.keep(tree.seconds, tree)
            session.proposals = tree.proposed
            session.report(sum(1 for _ in tree.root.leaves()), before + stage.boxes)
        if stage.finest:
            raise OutOfTime
        return tree

    def _improve(self, system: CubicSystem, point: Array) -> None:
        """Start the local solver from a point of the relaxation, if it is a better start."""
        session = self.session
        h = np.array(
            [sum(x * point[c] for c, x in piece.items()) for piece in system.exact.lengths]
        )
        if not (h > 0).all():
            return
        tried = session.stretched(h[None] * float(system.exact.second))[0]
        known = math.inf if session.upper is None else float(session.upper)
        # A solve costs more than a box: what is shorter by less than a millionth is not a start.
        if tried.sum() < min(known, self._shortest_tried) * (1 - 1e-6):
            self._shortest_tried = float(tried.sum())
            session.seek(tried)
            if session.upper is not None and session.upper < self._ends:
                raise Shorter(tried)


def _prove(session: Session) -> bool:
    # Judging takes a fifteenth to a seventh of the search.
    run, session.judging = _Run(session), 0.2
    # The steps that a state proposes are proved on the way, or it is refused.
    pending = None
    if session.proposals is not None:
        document = session.proposals.document()
        pending = session.read(lambda: regrown(run.stated, document, session.check_clock))
    if pending is not None:
        session.keep(pending.seconds, pending)
        session.proposals = pending.proposed
    session.seek()
    longest = [x for x in session.exact.duration_upper if x is not None]
    if session.upper is None and len(longest) == session.exact.segments:
        most = sum(longest, Fraction(0))
        with suppress(Shorter):
            run.stage(most, 1)
        session.infeasible = session.upper is None and session.lower > most
    if session.upper is None:
        return True
    if pending is not None:
        last = Fraction(_LADDER.stages(session.request.gap)[-1])
        with suppress(Shorter):
            run.grown(pending, session.upper * (1 - last))
    session.climb(_LADDER, in_ticks, run.stage)
    return True


def _missing(problem: ExactProblem) -> str | None:
    try:
        exact = cubic_system(stated_problem(problem), Fraction(1)).exact
    except Refused as error:
        return f"{problem.curve.name}: {error}"
    if any(problem.duration_lower):
        return None
    moving = [any(column) for column in zip(*exact.steps, strict=True)]
    bounded = any(exact.fastest(j)[0] is not None for j, moves in enumerate(moving) if moves)
    return None if bounded else "nothing limits the total from below"


CUBIC = Certifier(
    "C2 cubic splines (clamped, natural, virtual)",
    declares,
    _missing,
    _prove,
    boxes=16,
    first=WITHOUT_VIRTUAL,
)
"""The ends that the verifier knows: only for them are the equations derived."""
