"""Branch and bound over the directions of three durations: 3-5-3 and 4-3-4 polynomials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import TrajgapError, Verdict, check
from ..certifier import Certifier
from ..exact import ExactProblem
from ..rounding import down
from ..session import Ladder, OutOfTime, Session, Shorter
from .boxes import Boxes, Proof, Proposer
from .ratios import shape_of
from .rows import STRICT, shape_for
from .tree import Cover, proposed, tree_document

_BATCH = 256
"""Boxes that are looked at together: numpy is busy, and a look at the clock comes soon."""
_LOOKS = 3
"""Directions of a batch that are checked for a better answer: the shortest ones."""
_ENDLESS = Fraction(10**12)
"""A total that stands for "whatever the total": only rows without it may be used."""
_LADDER = Ladder(tuple(x * 10.0**-k for k in range(1, 9) for x in (3.0, 1.0)), 0.9, 1.0)
"""A stage costs about as much as all before it, so that steps of a factor 3 lose little."""
_DIGITS = 11
"""Of a total after its first: short in a certificate, and 1e-11 of a gap is no loss."""
_SLIGHT = 1e-9
"""Share by which durations must be shorter to be worth a new start of the ladder."""
_DEEPEST = 44
"""Halvings of a side: `Proposer` computes with its ends as floats, which have 53 bits."""


@dataclass(frozen=True, eq=False)
class Tree:
    """Boxes that prove a total, or are to prove it: kind of proof, and what is known."""

    kind: str
    state: Cover

    def document(self) -> dict[str, Any]:
        """Kind "three-piece" or "four-three-four" of docs/explanation/certificates.md."""
        return tree_document(self.kind, self.state)


@dataclass(frozen=True, eq=False)
class _Work:
    """Boxes with their proofs, and batches of open ones; together they cover the square."""

    done: tuple[tuple[Boxes, tuple[Proof, ...]], ...]
    queue: tuple[Boxes, ...]

    def after(self, head: Boxes, found: list[Proof | None], axis: NDArray[np.int64]) -> _Work:
        """The last batch without ``head``, whose boxes are proved or halved."""
        proved = np.array([proof is not None for proof in found])
        rest = self.queue[-1].pick(np.s_[len(head) :])
        halved = () if proved.all() else (head.pick(~proved).halves(axis[~proved]),)
        queue = (*self.queue[:-1], *((rest,) if len(rest) else ()), *halved)
        new = (head.pick(proved), tuple(proof for proof in found if proof is not None))
        return _Work((*self.done, new), queue)

    def state(self, target: Fraction) -> Cover:
        """All boxes; the open ones without a proof."""
        every = [boxes for boxes, _ in self.done] + list(self.queue)
        proofs: list[Proof | None] = [proof for _, found in self.done for proof in found]
        proofs += [None] * sum(map(len, self.queue))
        level = np.vstack([boxes.level for boxes in every])
        return Cover(target, Boxes(level, np.vstack([b.index for b in every])), tuple(proofs))


@dataclass(eq=False)
class _Search:
    """What one stage hands on to the next: the boxes so far, with what proves them."""

    session: Session
    boxes: Boxes
    proofs: Sequence[Proof | None]

    def stage(self, target: Fraction) -> Tree:
        """Prove that no total is below ``target``."""
        session = self.session
        endless = target >= _ENDLESS
        rows = _positions_alone(session.exact) if endless else session.exact
        kind = shape_for(session.exact).proof
        proposer, work = Proposer(rows, target), _Work((), (self.boxes,))
        try:
            work = self._again(proposer)
            while work.queue:
                head = work.queue[-1].pick(np.arange(min(_BATCH, len(work.queue[-1]))))
                self._look(head, target)
                # One assignment: wherever an interrupt strikes, the boxes cover the square.
                work = work.after(head, *proposer.propose(head))
                session.report(sum(map(len, work.queue)), session.nodes + len(head))
        finally:
            state = work.state(target)
            self.boxes, self.proofs = state.boxes, state.proofs
            session.proposals = Tree(kind, state)
        return Tree(kind, state)

    def _again(self, proposer: Proposer) -> _Work:
        """The boxes of the stage before, and what of their proofs holds for this total."""
        kept = np.array(
            [
                proof is not None and proposer.prover.proves(*proof, *self.boxes.sides(n))
                for n, proof in enumerate(self.proofs)
            ]
        )
        again = tuple(p for p, k in zip(self.proofs, kept, strict=True) if k and p is not None)
        left = (self.boxes.pick(~kept),) if not kept.all() else ()
        return _Work(((self.boxes.pick(kept), again),), left)

    def _look(self, boxes: Boxes, target: Fraction) -> None:
        """Stop where there is reason to."""
        self.session.check_clock()
        if (boxes.level >= _DEEPEST).any():
            raise OutOfTime
        a, b = ((boxes.index + 0.5) * 0.5**boxes.level).T
        shares = np.stack([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)], axis=1)
        tried = self.session.stretched(shares / (1 - a * b)[:, None])
        floats = self.session.floats
        totals = tried.sum(axis=1)
        totals[(tried > floats.duration_upper).any(axis=1)] = np.inf
        for best in np.argsort(totals)[:_LOOKS]:
            if not totals[best] < float(target) * (1 - _SLIGHT):
                break
            # The stretch knows nothing of positions.
            if check(floats, tried[best]).verdict is Verdict.PASS:
                raise Shorter(tried[best])


def _declares(problem: ExactProblem) -> bool:
    return shape_of(problem.curve) is not None


def _missing(problem: ExactProblem) -> str | None:
    joints = range(len(problem.joints))
    every = [x for j in joints for r in (1, 2, 3) for x in problem.sides(j, r)]
    usable = any(x is not None and x.high > 0 for x in every)
    if not usable and not any(problem.duration_lower):
        return "nothing limits the total from below"
    return None


def _prove(session: Session) -> bool:
    start, kind = np.zeros((1, 2), np.int64), shape_for(session.exact).proof
    given = session.taken_up(partial(_proposed, session.exact, kind))
    if given is None:
        given = Cover(Fraction(0), Boxes(start, start), (None,))
    session.proposals = Tree(kind, given)
    search = _Search(session, given.boxes, given.proofs)
    session.seek()
    while session.upper is None:
        target = _above_all(session.exact)
        if target is None:
            return False
        try:
            session.keep(target, search.stage(target))
        except Shorter as found:
            if not session.seek(found.durations):
                raise OutOfTime from None  # the improvement is too slight to prove
        else:
            session.infeasible = True
            return True
    session.climb(_LADDER, partial(down, digits=_DIGITS), search.stage)
    return True


def _proposed(exact: ExactProblem, kind: str, document: dict[str, Any]) -> Cover:
    """Boxes of a stopped run: what they say of themselves only proposes."""
    if document["kind"] != kind:
        raise TrajgapError(f"resume: a state of kind {document['kind']!r}")
    return proposed(exact, document)


def _above_all(exact: ExactProblem) -> Fraction | None:
    """A total above every admissible one; None where none can be refuted as a whole."""
    longest = [u for u in exact.duration_upper if u is not None]
    if len(longest) == exact.segments:
        return sum(longest, Fraction(0)) * (1 + STRICT)
    anywhere = (*exact.position_lower, *exact.position_upper)
    return _ENDLESS if any(x is not None for x in anywhere) else None


def _positions_alone(exact: ExactProblem) -> ExactProblem:
    """The problem without anything that more time could repair."""
    nothing = ((None, None, None),) * len(exact.joints)
    return replace(exact, limits=nothing, duration_lower=(Fraction(0),) * exact.segments, pairs=())


THREE_PIECE = Certifier(
    "C2 3-5-3 and 4-3-4 polynomials at rest at the ends",
    _declares,
    _missing,
    _prove,
    boxes=2_000,
    sided=True,
)
"""At rest alone: the pieces are quotients of polynomials in two ratios only then."""
