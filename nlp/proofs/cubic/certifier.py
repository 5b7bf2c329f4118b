"""A proved interval of the least total for C2 cubic splines: stages, answer, clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import TrajgapError, evaluate
from ....verify import MOST_CUBIC_SEGMENTS, TICKS
from ...optimum import solve
from ..answer import float_problem, prove_feasible
from ..exact import ExactProblem
from ..outcome import Argument, Certified, Certifier, Outcome, Progress, Request, Resumed
from .ranges import implied
from .replay import replayed
from .search import Search
from .system import CubicSystem, cubic_system, kind_of_ends
from .tree import Box, Prover, proof_document

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
    """The proof of a lower bound, in ticks; unfinished: open boxes of it are proposed."""

    prover: Prover
    root: Box
    lower: int
    unfinished: bool = False

    @property
    def seconds(self) -> Fraction:
        """The lower bound, s."""
        return Fraction(self.lower, TICKS) * Fraction(2) ** self.prover.system.second

    def document(self) -> dict[str, Any]:
        """The proof, ready for JSON."""
        return proof_document(self.prover, self.root, self.lower, self.unfinished)


class _Stop(Exception):
    """Time is up."""


class _Run:
    """What the stages share: the answer, the clock, the reports."""

    def __init__(self, exact: ExactProblem, request: Request) -> None:
        self.exact, self.request = exact, request
        self.began = time.perf_counter()
        self.floats = float_problem(exact)
        self.durations: tuple[Fraction, ...] | None = None
        self.proof: Argument | None = None
        self.lower = Fraction(0)
        """What it proves, s."""
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
        lower = max(tree.seconds, self.lower)
        upper = math.inf if self.upper is None else float(self.upper)
        gap = math.inf if self.upper is None else float(1 - lower / self.upper)
        nodes = self.nodes + search.boxes
        self.request.report(
            Progress(float(lower), upper, gap, len(search.heap), nodes, nodes / (now - self.began))
        )

    def keep(self, prover: Prover, root: Box, lower: int) -> None:
        """Keep a proof if it is the best."""
        tree = Tree(prover, root, lower)
        if tree.seconds > self.lower:
            self.proof, self.lower = tree, tree.seconds


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
        while run.lower < min(_target(run, gap * (1 + _NEAR)), _target(run, run.request.gap)):
            system = cubic_system(run.exact, _target(run, gap))
            cap = _ticks(run, gap, system)
            prover, goal = Prover(system, cap), partial(_ticks, run, gap, system)
            yield _Stage(prover, prover.root(), goal, math.floor(cap * (1 - _NEAR * gap)))


def _ticks(run: _Run, gap: float, system: CubicSystem) -> int:
    """The target for a gap, in ticks."""
    wanted = max(gap, _SHARE * run.request.gap)
    return math.floor(_target(run, wanted) / Fraction(2) ** system.second * TICKS)


def _result(run: _Run, pending: Tree | None, stopped: bool) -> Certified:
    upper, lower = run.upper, run.lower
    if upper is not None:
        near = upper - lower <= upper * Fraction(run.request.gap)
        outcome = Outcome.CERTIFIED if near else Outcome.INTERVAL
    else:
        longest = [x for x in run.exact.duration_upper if x is not None]
        above = len(longest) == run.exact.segments and lower > sum(longest)
        outcome = Outcome.INFEASIBLE if above and not stopped else Outcome.OPEN
    return Certified(
        run.exact,
        outcome,
        lower,
        upper,
        run.durations,
        run.nodes,
        0 if pending is None else sum(1 for _ in pending.root.leaves()),
        time.perf_counter() - run.began,
        run.proof,
        stopped,
        None if pending is None else replace(pending, unfinished=True),
    )


def _resumed(run: _Run, resumed: Resumed) -> Tree | None:
    """Take up what a state proves; the steps that it proposes are proved here, or it is refused."""
    run.durations, run.proof, run.lower = resumed.durations, resumed.proof, resumed.lower
    if resumed.proposals is None:
        return None
    try:
        tree = Tree(*replayed(run.exact, resumed.proposals))
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        if isinstance(error, TrajgapError):
            raise
        raise TrajgapError(f"resume: malformed state ({type(error).__name__}: {error})") from None
    run.keep(tree.prover, tree.root, tree.lower)
    return tree


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


CUBIC = Certifier("C2 cubic splines (clamped, natural, virtual)", _declares, _missing, _certify)
