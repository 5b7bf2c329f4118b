"""Branch and bound over the directions of the durations: a proved interval of the optimum."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ..problem import Problem, TrajgapError, Verdict, check, evaluate
from .boxes import Boxes, Proof, Proposer
from .exact import ExactProblem, exact_problem
from .incumbent import float_problem, prove_feasible
from .rest_to_rest import SegmentBound, closed_form, is_rest_to_rest
from .solve import solve
from .three_piece import STRICT

GAP = 1e-6
_BATCH = 256
_LOOKS = 3
_ENDLESS = Fraction(10**12)
"""A total that stands for "whatever the total": only rows without it may be used."""
_STAGES = tuple(x * 10.0**-k for k in range(1, 9) for x in (3.0, 1.0))
_SAFE = Fraction(9, 10)
_DEEPEST = 44


class Outcome(StrEnum):
    """How a certification ended."""

    CERTIFIED = "certified"
    """The optimum lies in the interval, whose relative width is at most the gap asked for."""
    INFEASIBLE = "infeasible"
    """No durations within their bounds keep the limits: proved."""
    INTERVAL = "interval"
    """Stopped early: the optimum lies in the interval, which is wider than asked for."""
    OPEN = "open"
    """Nothing is proved."""


@dataclass(frozen=True)
class Progress:
    """What a long run reports: bounds in s, relative gap, open boxes, boxes per second."""

    lower: float
    upper: float
    gap: float
    open_boxes: int
    nodes: int
    rate: float


@dataclass(frozen=True, eq=False)
class State:
    """Boxes with their proofs, and boxes still open, for the total ``target``.

    Together the boxes cover the unit square of directions.
    """

    target: Fraction
    boxes: Boxes
    proofs: tuple[Proof | None, ...]
    proved: Fraction = Fraction(0)
    """Lower bound proved before."""


@dataclass(frozen=True, eq=False)
class Certified:
    """A proved interval of the optimum.

    Attributes
    ----------
    problem : ExactProblem
    outcome : Outcome
    lower : Fraction
        No feasible total is below it, s.
    upper : Fraction or None
        Total of ``durations``, s; None without an answer.
    durations : tuple of Fraction or None
        Feasible, proved in rational numbers.
    state : State or None
        Proof of ``lower``: every box carries one.
    resume : State or None
        Where a stopped run can go on.
    nodes, open_boxes : int
    seconds : float
    segments : tuple of SegmentBound or None
        Proof of ``lower`` in closed form, instead of ``state``.
    """

    problem: ExactProblem
    outcome: Outcome
    lower: Fraction
    upper: Fraction | None
    durations: tuple[Fraction, ...] | None
    state: State | None
    resume: State | None
    nodes: int
    open_boxes: int
    seconds: float
    segments: tuple[SegmentBound, ...] | None = None

    @property
    def gap(self) -> float:
        """Relative width of the interval, (upper − lower)/upper; inf without an answer."""
        if self.upper is None:
            return float("inf")
        return float((self.upper - self.lower) / self.upper)

    def __str__(self) -> str:
        if self.outcome is Outcome.INFEASIBLE:
            head = "no durations within their bounds keep the limits: proved"
        elif self.upper is None:
            head = "nothing proved"
        else:
            head = (
                f"optimum in [{float(self.lower):.9f}, {float(self.upper):.9f}] s, "
                f"gap {self.gap:.1e}, {self.outcome}"
            )
        return f"{self.problem.name}: {head}; {self.nodes} boxes, {self.seconds:.1f} s"


class _Stop(Exception):
    """Time is up, or boxes are as small as they may get."""


@dataclass(eq=False)
class _Run:
    problem: ExactProblem
    deadline: float
    began: float
    upper: Fraction | None
    report: Callable[[Progress], None] | None
    lower: Fraction = Fraction(0)
    nodes: int = 0
    state: State | None = None
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
        proposer = Proposer(rows, target)
        kept = np.array(
            [
                proof is not None and proposer.prover.proves(*proof, *boxes.sides(n))
                for n, proof in enumerate(proofs)
            ]
        )
        done = [(boxes.pick(kept), [p for p, k in zip(proofs, kept, strict=True) if k])]
        queue = [boxes.pick(~kept)] if not kept.all() else []
        try:
            while queue:
                head = queue[-1].pick(np.arange(min(_BATCH, len(queue[-1]))))
                self._look(head, target)
                found, axis = proposer.propose(head)
                proved = np.array([p is not None for p in found])
                rest = queue.pop().pick(np.s_[len(head) :])
                if len(rest):
                    queue.append(rest)
                if not proved.all():
                    queue.append(head.pick(~proved).halves(axis[~proved]))
                done.append((head.pick(proved), [p for p in found if p is not None]))
                self.nodes += len(head)
                self._tell(sum(map(len, queue)))
        except (KeyboardInterrupt, _Stop):
            self.stopped = self.better is None
            self.pending = _gathered(target, done, queue, self.lower)
            return None
        return _gathered(target, done, [], self.lower)

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


def _gathered(
    target: Fraction,
    done: list[tuple[Boxes, list[Proof | None]]],
    queue: list[Boxes],
    proved: Fraction,
) -> State:
    every = [b for b, _ in done] + queue
    proofs = [p for _, found in done for p in found] + [None] * sum(map(len, queue))
    boxes = Boxes(np.vstack([b.level for b in every]), np.vstack([b.index for b in every]))
    return State(target, boxes, tuple(proofs), proved)


def covered(problem: ExactProblem) -> str | None:
    """Why a problem is not covered, or None."""
    interpolant = problem.interpolant
    if is_rest_to_rest(problem):
        return None
    rest = ((1, 0.0), (2, 0.0))
    if (
        interpolant.degrees != (3, 5, 3)
        or interpolant.continuity != (2, 2)
        or interpolant.prescribed != (rest, (), (), rest)
        or interpolant.virtual
    ):
        return f"{interpolant.name}: only rest-to-rest polynomials and C2 3-5-3 are covered"
    usable = any(x is not None and x.high > 0 for row in problem.limits for x in row)
    if not usable and not any(problem.duration_lower):
        return "nothing limits the total from below"
    return None


def certify(
    problem: Problem | ExactProblem,
    *,
    gap: float = GAP,
    seconds: float = 60.0,
    seed: int = 0,
    resume: State | None = None,
    report: Callable[[Progress], None] | None = None,
) -> Certified:
    """Prove an interval of the least total of a problem with shared durations.

    Covered are C2 3-5-3 polynomials, and rest-to-rest polynomials in closed form.

    Parameters
    ----------
    problem : Problem or ExactProblem
        The floats of a `Problem` are taken as exact; `printed_problem` gives the printed one. Its
        coupling is not looked at.
    gap : float
        Relative width of the interval to reach.
    seconds : float
        Time limit. At the limit, or at Ctrl-C, the best interval proved so far is returned.
    seed : int
        Of the starts of the local solver that finds the answer.
    resume : State, optional
        ``resume`` of a stopped run.
    report : callable, optional
        Called with a `Progress` after every batch of boxes.

    Returns
    -------
    Certified

    Raises
    ------
    TrajgapError
        If the interpolant is not covered, or nothing limits the total.
    """
    exact = exact_problem(problem) if isinstance(problem, Problem) else problem
    why = covered(exact)
    if why is not None:
        raise TrajgapError(f"certify: {why}")
    began = time.perf_counter()
    if is_rest_to_rest(exact):
        return _in_closed_form(exact, gap, began)
    run = _Run(exact, began + seconds, began, None, report)
    answer = _answer(run.floats, exact, seed, None)
    start = np.zeros((1, 2), np.int64)
    proofs: tuple[Proof | None, ...] = (None,)
    boxes = Boxes(start, start)
    if resume is not None:
        boxes, proofs, run.lower = resume.boxes, resume.proofs, resume.proved
    searching = True
    while searching:
        run.upper = upper = sum(answer, Fraction(0)) if answer is not None else None
        run.better = None
        for target in _targets(exact, upper, gap, run.lower):
            state = run.stage(target, boxes, proofs)
            if state is None:
                break
            run.state, run.lower = state, target
            boxes, proofs = state.boxes, state.proofs
        searching = run.better is not None
        if run.better is not None:
            assert run.pending is not None
            boxes, proofs = run.pending.boxes, run.pending.proofs
            found = _answer(run.floats, exact, seed, run.better)
            if found is None or (upper is not None and sum(found) >= upper):
                run.stopped, searching = True, False  # the improvement is too slight to prove
            else:
                answer, run.pending = found, None
    pending = run.pending
    left = 0 if pending is None else sum(p is None for p in pending.proofs)
    if run.state is None:
        outcome = Outcome.OPEN if upper is None else Outcome.INTERVAL
    elif upper is None:
        outcome = Outcome.INFEASIBLE if not run.stopped else Outcome.OPEN
    else:
        outcome = Outcome.INTERVAL if run.stopped else Outcome.CERTIFIED
    return Certified(
        exact,
        outcome,
        run.lower,
        upper,
        answer,
        run.state,
        pending,
        run.nodes,
        left,
        time.perf_counter() - began,
    )


def _in_closed_form(exact: ExactProblem, gap: float, began: float) -> Certified:
    bounds, durations = closed_form(exact)
    lower = sum((b.least for b in bounds), Fraction(0))
    answer = prove_feasible(exact, np.array(durations))
    upper = sum(answer, Fraction(0)) if answer is not None else None
    late = any(
        u is not None and b.least > u for b, u in zip(bounds, exact.duration_upper, strict=True)
    )
    if upper is None:
        outcome = Outcome.INFEASIBLE if late else Outcome.OPEN
    else:
        outcome = Outcome.CERTIFIED if upper - lower <= upper * Fraction(gap) else Outcome.INTERVAL
    return Certified(
        exact,
        outcome,
        lower,
        upper,
        answer,
        None,
        None,
        0,
        0,
        time.perf_counter() - began,
        tuple(bounds) if upper is not None or late else None,
    )


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
    return [t for t in found if t > lower] or [found[-1]]


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
