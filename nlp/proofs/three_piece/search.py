"""Branch and bound over the directions of three durations: 3-5-3 and 4-3-4 polynomials."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import Problem, TrajgapError, Verdict, check, evaluate
from ...optimum import solve
from ..answer import float_problem, prove_feasible
from ..exact import ExactProblem
from ..outcome import Argument, Certified, Certifier, Outcome, Progress, Request, Resumed
from .boxes import Boxes, Proof, Proposer
from .ratios import shape_of
from .rows import STRICT, shape_for
from .tree import State, proposed, tree_document

_BATCH = 256
_LOOKS = 3
_ENDLESS = Fraction(10**12)
"""A total that stands for "whatever the total": only rows without it may be used."""
_STAGES = tuple(x * 10.0**-k for k in range(1, 9) for x in (3.0, 1.0))
_SAFE = Fraction(9, 10)
_DEEPEST = 44


@dataclass(frozen=True, eq=False)
class Tree:
    """Boxes that prove a total, or are to prove it: kind of proof, and what is known."""

    kind: str
    state: State

    def document(self) -> dict[str, Any]:
        """Kind "three-piece" or "four-three-four" of docs/certificates.md."""
        return tree_document(self.kind, self.state)


class _Stop(Exception):
    """Time is up, or boxes are as small as they may get."""


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

    def state(self, target: Fraction) -> State:
        """All boxes; the open ones without a proof."""
        every = [boxes for boxes, _ in self.done] + list(self.queue)
        proofs: list[Proof | None] = [proof for _, found in self.done for proof in found]
        proofs += [None] * sum(map(len, self.queue))
        level = np.vstack([boxes.level for boxes in every])
        return State(target, Boxes(level, np.vstack([b.index for b in every])), tuple(proofs))


@dataclass(eq=False)
class _Run:
    problem: ExactProblem
    deadline: float
    began: float
    upper: Fraction | None
    report: Callable[[Progress], None] | None
    lower: Fraction = Fraction(0)
    nodes: int = 0
    proof: Argument | None = None
    pending: State | None = None
    stopped: bool = False
    better: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        self.floats = float_problem(self.problem)

    def stage(self, target: Fraction, boxes: Boxes, proofs: Sequence[Proof | None]) -> State | None:
        """Prove that no total is below ``target``.

        None if stopped, with `pending` set, or if durations with a smaller total turned up, with
        `better` set as well.
        """
        rows = self.problem if target < _ENDLESS else _positions_alone(self.problem)
        work = _Work((), (boxes,))
        try:
            proposer = Proposer(rows, target)
            kept = np.array(
                [
                    proof is not None and proposer.prover.proves(*proof, *boxes.sides(n))
                    for n, proof in enumerate(proofs)
                ]
            )
            again = tuple(p for p, k in zip(proofs, kept, strict=True) if k and p is not None)
            left = (boxes.pick(~kept),) if not kept.all() else ()
            work = _Work(((boxes.pick(kept), again),), left)
            while work.queue:
                head = work.queue[-1].pick(np.arange(min(_BATCH, len(work.queue[-1]))))
                self._look(head, target)
                # One assignment: wherever an interrupt strikes, the boxes cover the square.
                work = work.after(head, *proposer.propose(head))
                self.nodes += len(head)
                self._tell(sum(map(len, work.queue)))
        except (KeyboardInterrupt, _Stop):
            self.stopped = self.better is None
            self.pending = work.state(target)
            return None
        return work.state(target)

    def _look(self, boxes: Boxes, target: Fraction) -> None:
        """Stop where there is reason to."""
        if time.perf_counter() > self.deadline or (boxes.level >= _DEEPEST).any():
            raise _Stop
        better = self.improve(boxes, target)
        if better is not None:
            self.better = better
            raise _Stop

    def improve(self, boxes: Boxes, target: Fraction) -> NDArray[np.float64] | None:
        """Durations in the direction of a box's centre that are shorter than ``target``, if any."""
        a, b = ((boxes.index + 0.5) * 0.5**boxes.level).T
        shares = np.stack([a * (1 - b), (1 - a) * (1 - b), b * (1 - a)], axis=1)
        shares /= (1 - a * b)[:, None]
        stretch = evaluate(self.floats, shares).stretch
        stretch = np.maximum(stretch, (self.floats.duration_lower / shares).max(axis=1))
        outside = (shares * stretch[:, None] > self.floats.duration_upper).any(axis=1)
        stretch = np.where(outside, np.inf, stretch)
        for best in np.argsort(stretch)[:_LOOKS]:
            if not stretch[best] < float(target) * (1 - 1e-9):
                break
            durations = np.asarray(shares[best] * stretch[best], dtype=np.float64)
            # The stretch knows nothing of positions.
            if check(self.floats, durations).verdict is Verdict.PASS:
                return durations
        return None

    def _tell(self, open_boxes: int) -> None:
        if self.report is None:
            return
        seconds = time.perf_counter() - self.began
        upper = float("inf") if self.upper is None else float(self.upper)
        lower = float(self.lower)
        gap = (upper - lower) / upper if self.upper is not None else float("inf")
        self.report(Progress(lower, upper, gap, open_boxes, self.nodes, self.nodes / seconds))


def _declares(problem: ExactProblem) -> bool:
    return shape_of(problem.curve) is not None


def _missing(problem: ExactProblem) -> str | None:
    usable = any(x is not None and x.high > 0 for row in problem.limits for x in row)
    if not usable and not any(problem.duration_lower):
        return "nothing limits the total from below"
    return None


def _certify(exact: ExactProblem, request: Request) -> Certified:
    began, kind = time.perf_counter(), shape_for(exact).proof
    run = _Run(exact, began + request.seconds, began, None, request.report)
    start = np.zeros((1, 2), np.int64)
    proofs: tuple[Proof | None, ...] = (None,)
    boxes = Boxes(start, start)
    answer: tuple[Fraction, ...] | None = None
    if request.resume is not None:
        run.proof, run.lower = request.resume.proof, request.resume.lower
        answer = request.resume.durations
        pending = _pending(exact, request.resume)
        if pending is not None:
            boxes, proofs = pending.boxes, pending.proofs
    run.pending = State(run.lower, boxes, proofs)
    try:
        found = _answer(run.floats, exact, request.seed, None)
        answer = min([h for h in (answer, found) if h is not None], key=sum, default=None)
    except KeyboardInterrupt:
        run.stopped = True
    searching = not run.stopped
    while searching:
        run.upper = upper = sum(answer, Fraction(0)) if answer is not None else None
        run.better = None
        for target in _targets(exact, upper, request.gap, run.lower):
            state = run.stage(target, boxes, proofs)
            if state is None:
                break
            run.proof, run.lower, run.pending = Tree(kind, state), target, None
            boxes, proofs = state.boxes, state.proofs
        searching = run.better is not None
        if run.better is not None:
            assert run.pending is not None
            boxes, proofs = run.pending.boxes, run.pending.proofs
            found = _answer(run.floats, exact, request.seed, run.better)
            if found is None or (upper is not None and sum(found) >= upper):
                run.stopped, searching = True, False  # the improvement is too slight to prove
            else:
                answer = found
    return _result(run, answer, began, request.gap)


def _result(run: _Run, answer: tuple[Fraction, ...] | None, began: float, gap: float) -> Certified:
    kind = shape_for(run.problem).proof
    upper = sum(answer, Fraction(0)) if answer is not None else None
    pending = run.pending if run.stopped else None
    if upper is not None:
        enough = run.proof is not None and upper - run.lower <= upper * Fraction(gap)
        outcome = Outcome.CERTIFIED if enough else Outcome.INTERVAL
    else:
        # A resumed proof may be of any total, and nothing may be left to prove.
        wanted = _targets(run.problem, None, 0.0, Fraction(0))
        above = run.proof is not None and not run.stopped and run.lower in wanted
        outcome = Outcome.INFEASIBLE if above else Outcome.OPEN
    return Certified(
        run.problem,
        outcome,
        run.lower,
        upper,
        answer,
        run.nodes,
        0 if pending is None else sum(p is None for p in pending.proofs),
        time.perf_counter() - began,
        run.proof,
        pending is not None,
        None if pending is None else Tree(kind, pending),
    )


def _pending(exact: ExactProblem, resumed: Resumed) -> State | None:
    """Boxes of a stopped run: what they say of themselves only proposes."""
    document = resumed.proposals
    if document is None:
        return None
    kind = shape_for(exact).proof
    try:
        if document["kind"] != kind:
            raise TrajgapError(f"resume: a state of kind {document['kind']!r}")
        return proposed(exact, document)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        if isinstance(error, TrajgapError):
            raise
        raise TrajgapError(f"resume: malformed state ({type(error).__name__}: {error})") from None


def _answer(
    floats: Problem, exact: ExactProblem, seed: int, initial: NDArray[np.float64] | None
) -> tuple[Fraction, ...] | None:
    """Feasible durations of the local solver, or else the ones it started from."""
    solution = solve(floats, seed=seed, initial=initial)
    tries = [h for h in (solution.durations, initial) if h is not None]
    found = [h for h in (prove_feasible(exact, h) for h in tries) if h is not None]
    return min(found, key=sum, default=None)


def _targets(
    exact: ExactProblem, upper: Fraction | None, gap: float, lower: Fraction
) -> list[Fraction]:
    """Totals to prove one after the other; above every admissible total if there is no answer."""
    if upper is None:
        longest = [u for u in exact.duration_upper if u is not None]
        if len(longest) < exact.segments:
            anywhere = (*exact.position_lower, *exact.position_upper)
            return [_ENDLESS] if any(x is not None for x in anywhere) else []
        return [sum(longest, Fraction(0)) * (1 + STRICT)]
    last = float(_SAFE) * gap
    found = [_down(upper * (1 - Fraction(g))) for g in (*(g for g in _STAGES if g > last), last)]
    return [t for t in found if t > lower]


def _positions_alone(exact: ExactProblem) -> ExactProblem:
    """The problem without anything that more time could mend."""
    nothing = ((None, None, None),) * len(exact.joints)
    return replace(exact, limits=nothing, duration_lower=(Fraction(0),) * exact.segments)


def _down(total: Fraction) -> Fraction:
    """A little less, in 12 decimals after the first digit."""
    digits = 12 - len(str(int(total))) if total >= 1 else 12
    while total * 10**digits < 10**11:
        digits += 1
    return Fraction(int(total * 10**digits), 10**digits)


THREE_PIECE = Certifier(
    "C2 3-5-3 and 4-3-4 polynomials at rest at the ends", _declares, _missing, _certify
)
