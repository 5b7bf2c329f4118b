"""A proved interval of the least total for C2 cubic splines: stages, answer, clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import TrajgapError, evaluate
from ...optimum import solve
from ...verify_problem import number
from ..answer import float_problem, keeps_limits, prove_feasible
from ..exact import ExactProblem
from ..outcome import Certified, Certifier, Outcome, Progress, Request
from .ranges import implied
from .replay import replayed
from .search import Search
from .system import CubicSystem, cubic_system, kind_of_ends
from .tree import TICKS, Box, Prover, proof_document

_STAGES = (0.1, 0.01, 1e-3, 1e-4, 1e-5)
_APART = 3.0
"""No stage is nearer to the last one than by this factor."""
_SHARE = 0.98
_NEAR = 0.1
"""A stage starts anew if a better answer lowers its goal by this share of its gap."""
_BETTER = 1e-6
_OFTEN = 0.2
"""Seconds between reports."""


@dataclass(frozen=True, eq=False)
class Tree:
    """The proof of a lower bound, in ticks."""

    prover: Prover
    root: Box
    lower: int

    @property
    def seconds(self) -> Fraction:
        """The lower bound, s."""
        return Fraction(self.lower, TICKS) * Fraction(2) ** self.prover.system.second

    def document(self) -> dict[str, Any]:
        """The proof, ready for JSON."""
        return proof_document(self.prover, self.root, self.lower)


@dataclass(frozen=True, eq=False)
class Stopped:
    """Where a stopped run can go on."""

    proved: Tree | None
    pending: Tree | None
    durations: tuple[Fraction, ...] | None

    def document(self) -> dict[str, Any]:
        """The state, ready for JSON."""
        return {
            "kind": "cubic",
            "proved": None if self.proved is None else self.proved.document(),
            "pending": None if self.pending is None else self.pending.document(),
            "durations": None if self.durations is None else [str(h) for h in self.durations],
        }


class _Stop(Exception):
    """Time is up."""


class _Run:
    """What the stages share: the answer, the clock, the reports."""

    def __init__(self, exact: ExactProblem, request: Request) -> None:
        self.exact, self.request = exact, request
        self.began = time.perf_counter()
        self.floats = float_problem(exact)
        self.durations: tuple[Fraction, ...] | None = None
        self.proved: Tree | None = None
        self.nodes = 0
        """Boxes of the stages that are over."""
        self._told = 0.0
        self._looked = math.inf

    @property
    def upper(self) -> Fraction | None:
        """Total of the answer, s."""
        return None if self.durations is None else sum(self.durations, Fraction(0))

    def answer(self, initial: NDArray[np.float64] | None = None) -> None:
        """Look for a better answer."""
        solution = solve(self.floats, seed=self.request.seed, initial=initial)
        for h in (solution.durations, initial):
            proved = None if h is None else prove_feasible(self.exact, h)
            if proved is not None and (self.upper is None or sum(proved) < self.upper):
                self.durations = proved

    def improve(self, system: CubicSystem, point: NDArray[np.float64]) -> None:
        """Start the local solver from a point of the relaxation, if it is a better start."""
        h = (
            np.array(
                [
                    sum(x * point[c] for c, x in system.piece(k).items())
                    for k in range(system.pieces)
                ]
            )
            * 2.0**system.second
        )
        if not (h > 0).all():
            return
        total = float(evaluate(self.floats, h[None]).stretch[0]) * h.sum()
        known = math.inf if self.upper is None else float(self.upper)
        if total < min(known, self._looked) * (1 - _BETTER):
            self._looked = total
            self.answer(h * (total / h.sum()))

    def clock(self) -> None:
        """Stop when time is up."""
        if time.perf_counter() > self.began + self.request.seconds:
            raise _Stop

    def look(self, search: Search) -> None:
        """Stop when time is up, and report."""
        self.clock()
        now = time.perf_counter()
        if self.request.report is None or now - self._told < _OFTEN:
            return
        self._told = now
        tree = Tree(search.prover, search.root, search.lower)
        lower = max(tree.seconds, Fraction(0) if self.proved is None else self.proved.seconds)
        upper = math.inf if self.upper is None else float(self.upper)
        gap = math.inf if self.upper is None else float(1 - lower / self.upper)
        nodes = self.nodes + search.boxes
        self.request.report(
            Progress(float(lower), upper, gap, len(search.heap), nodes, nodes / (now - self.began))
        )

    def keep(self, prover: Prover, root: Box, lower: int) -> None:
        """Keep a proof if it is the best."""
        tree = Tree(prover, root, lower)
        if lower > 0 and (self.proved is None or tree.seconds > self.proved.seconds):
            self.proved = tree


def _target(run: _Run, gap: float) -> Fraction:
    assert run.upper is not None
    return run.upper * (1 - Fraction(gap))


def _certify(exact: ExactProblem, request: Request) -> Certified:
    run = _Run(exact, request)
    pending: Tree | None = None
    stopped = False
    if request.resume is not None:
        pending = _resumed(run, request.resume)
    try:
        run.answer()
        for stage in _stages(run, pending):
            search = Search(run, stage.prover, stage.root)
            try:
                finished = search.until(stage.goal, stage.restart)
            finally:
                run.nodes += search.boxes
                run.keep(stage.prover, stage.root, search.lower)
                pending = Tree(stage.prover, stage.root, search.lower)
            if not finished:
                stopped = True
                break
            pending = None
    except (KeyboardInterrupt, _Stop):
        stopped = True
    return _result(run, pending if stopped else None, stopped)


@dataclass(frozen=True, eq=False)
class _Stage:
    """A tree to work on, the ticks to prove in it, and the goal below which to start anew."""

    prover: Prover
    root: Box
    goal: Callable[[], int]
    restart: int = 0


def _stages(run: _Run, resumed: Tree | None) -> Iterator[_Stage]:
    """Stages, each when the one before is over."""
    if run.upper is None:
        longest = [x for x in run.exact.duration_upper if x is not None]
        if len(longest) < run.exact.segments:
            return
        above = sum(longest, Fraction(0))
        system = cubic_system(run.exact, above)
        cap = math.floor(above / Fraction(2) ** system.second * TICKS) + 1
        prover = Prover(system, cap)
        yield _Stage(prover, prover.root(), lambda: cap if run.upper is None else 0, cap)
    if run.upper is None:
        return
    if resumed is not None:
        yield _Stage(resumed.prover, resumed.root, partial(_ticks, run, 0.0, resumed.prover.system))
    last = _SHARE * run.request.gap
    for gap in (*(g for g in _STAGES if g > _APART * last), last):
        while run.proved is None or run.proved.seconds < min(
            _target(run, gap * (1 + _NEAR)), _target(run, run.request.gap)
        ):
            system = cubic_system(run.exact, _target(run, gap))
            cap = _ticks(run, gap, system)
            prover, goal = Prover(system, cap), partial(_ticks, run, gap, system)
            yield _Stage(prover, prover.root(), goal, math.floor(cap * (1 - _NEAR * gap)))


def _ticks(run: _Run, gap: float, system: CubicSystem) -> int:
    """The target for a gap, in ticks."""
    wanted = max(gap, _SHARE * run.request.gap)
    return math.floor(_target(run, wanted) / Fraction(2) ** system.second * TICKS)


def _result(run: _Run, pending: Tree | None, stopped: bool) -> Certified:
    upper, proved = run.upper, run.proved
    lower = Fraction(0) if proved is None else proved.seconds
    if upper is not None:
        near = upper - lower <= upper * Fraction(run.request.gap)
        outcome = Outcome.CERTIFIED if near else Outcome.INTERVAL
    else:
        longest = [x for x in run.exact.duration_upper if x is not None]
        above = len(longest) == run.exact.segments and lower > sum(longest)
        outcome = Outcome.INFEASIBLE if above and not stopped else Outcome.OPEN
    resume = Stopped(proved, pending, run.durations) if stopped else None
    return Certified(
        run.exact,
        outcome,
        lower,
        upper,
        run.durations,
        run.nodes,
        0 if pending is None else sum(1 for _ in pending.root.leaves()),
        time.perf_counter() - run.began,
        proved,
        resume,
    )


def _resumed(run: _Run, document: dict[str, Any]) -> Tree | None:
    """Read a state; everything in it is proved again."""
    try:
        if document["kind"] != "cubic":
            raise TrajgapError(f"resume: a state of kind {document['kind']!r}")
        trees = [
            None if document[key] is None else Tree(*replayed(run.exact, document[key]))
            for key in ("proved", "pending")
        ]
        answer = document["durations"]
        durations = None if answer is None else tuple(number(h) for h in answer)
    except TrajgapError:
        raise
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise TrajgapError(f"resume: malformed state ({type(error).__name__}: {error})") from None
    if durations is not None and not keeps_limits(run.exact, durations):
        raise TrajgapError("resume: the durations of the state do not keep the limits")
    run.durations = durations
    for tree in trees:
        if tree is not None:
            run.keep(tree.prover, tree.root, tree.lower)
    return trees[1]


def _declares(problem: ExactProblem) -> bool:
    return kind_of_ends(problem) is not None


def _missing(problem: ExactProblem) -> str | None:
    system = cubic_system(problem, Fraction(1))
    moving = [any(step[j] for step in system.steps) for j in range(system.joints)]
    speeds = [v for v, _ in implied(system, Fraction(1))]
    if any(math.isfinite(v) for v, moves in zip(speeds, moving, strict=True) if moves):
        return None
    return None if any(problem.duration_lower) else "nothing limits the total from below"


CUBIC = Certifier("C2 cubic splines (clamped, natural, virtual)", _declares, _missing, _certify)
