"""One certification run, whatever the kind of proof: clock, answer, stages, reports, result."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeVar

import numpy as np

from ...problem import Array, TrajgapError, evaluate
from ...verify import Clock, OutOfTime as OutOfTime, Subject
from ..clock import stopping_after
from ..optimum import solve
from .answer import float_problem, prove_feasible
from .exact import ExactProblem
from .outcome import Argument, Certified, Outcome, Progress, Request, outcome_of

T = TypeVar("T")

Answer = tuple[tuple[Fraction, ...], tuple[tuple[Fraction, ...], ...] | None]
"""Durations, and the speeds at the way-points that an answer of any curve has."""

UNBOUNDED = "the time ended before a lower bound was proved"
"""What was left out where a search had to end before its first proof."""
BARE = "the time ended before a bound better than that of the mean velocities was proved"
"""What was left out where all that is proved is what needs no search."""
BOXED = "the allowed number of boxes was used up before a lower bound was proved"
"""The same where boxes were counted, and no time was limited."""
UNPROVED = "a motion was found, but the exact proof that it keeps its limits was cut short"
"""What was left out where `Session.answering` is over."""


class Shorter(Exception):
    """Durations turned up whose total is below the one that is to be proved."""

    def __init__(self, durations: Array) -> None:
        self.durations = durations


@dataclass(frozen=True)
class Ladder:
    """The stages of a run: gaps to prove one after the other.

    Wide gaps come first since they are quick, and a stopped run has them to show.

    Attributes
    ----------
    gaps : tuple of float
        Descending.
    share : float
        Of the gap asked for, so rounding has room in the last stage.
    apart : float
        No stage is nearer to the last one than by this factor.
    near : float
        From a stage of this gap on, the last one takes at most ``growth`` times as long: where that
        time is there, the stages between are left out. Without a time limit they are after the
        first stage; at 0 they never are.
    growth : float
    """

    gaps: tuple[float, ...]
    share: float
    apart: float
    near: float = 0.0
    growth: float = math.inf

    def stages(self, gap: float) -> list[float]:
        """Gaps of the stages for the one that is asked for."""
        last = self.share * gap
        return [*(g for g in self.gaps if g > self.apart * last), last]

    def leaps(self, gap: float, took: float, left: float) -> bool:
        """Whether the last stage is next, after one of ``gap`` that took ``took`` seconds."""
        soon = gap <= self.near and took * self.growth <= left
        return self.near > 0.0 and (soon or left == math.inf)


class Session:
    """What a run knows and shares with its kind of proof.

    Attributes
    ----------
    exact : ExactProblem
    request : Request
    crew : ProofCrew
        Who works on pieces of search and judging.
    floats : Problem
        The nearest problem in floats, for the local solver.
    answer : tuple of (durations, speeds) or None
        The shortest durations proved feasible so far, and, of any curve, the speeds at the
        way-points that belong to them. One assignment sets both: an interrupt parts no pair.
    lower : Fraction
        The best bound proved, s.
    proof : Argument or None
        What proves it.
    proposals : Argument or None
        What a stopped run had not finished; a kind of proof sets it before it is interrupted. Until
        then it is what the run continues from.
    judging : float
        Seconds that judging takes for one of search: what a kind of proof asks for is left to it.
    infeasible : bool
        A kind of proof showed that nothing is feasible.
    one_sided : bool
        The kind of proof bounds from below only: no answer of its own is claimed.
    left_out : str or None
        What the time was too short for, in words; a kind of proof sets it where it ends the run.
    nodes, open_boxes : int
        Boxes visited, boxes left.
    often : float
        Seconds between reports: a reader follows them, and they cost nothing beside the boxes.
    seeking : float
        Share of what is left of the time that a local search may take: the rest is for the proof.
    answering : float
        Seconds that the exact proof of an answer may take beyond the time limit, or beyond its
        beginning where that is later: an answer of usual size is proved in a tenth of it, whatever
        the limit.
    """

    often, seeking, answering = 0.2, 0.5, 0.5

    def __init__(self, exact: ExactProblem, request: Request) -> None:
        self.exact, self.request, self.crew = exact, request, request.crew
        self.floats = float_problem(exact)
        self.answer: Answer | None = None
        self.lower = Fraction(0)
        self.proof: Argument | None = None
        self.proposals: Argument | None = None
        self.infeasible = self.one_sided = False
        self.left_out: str | None = None
        self.nodes = self.open_boxes = 0
        self._unsearched = True
        self.judging = 0.25
        self.clock, self._answering = request.clock, 0.0
        self._reported = -math.inf
        resumed = request.resume
        if resumed is not None:
            if resumed.durations is not None:
                self.answer = resumed.durations, resumed.speeds
            self.lower, self.proof = resumed.lower, resumed.proof
            self._unsearched = resumed.proof is None
            self.proposals = resumed.proposals

    def read(self, state: Callable[[], T]) -> T:
        """What a kind of proof reads in a state, in which it trusts nothing.

        Raises
        ------
        TrajgapError
            If it is malformed, or not proved where that is asked for.
        """
        try:
            return state()
        except (KeyError, IndexError, TypeError, ValueError, ArithmeticError) as error:
            if isinstance(error, TrajgapError):
                raise
            name = type(error).__name__
            raise TrajgapError(f"resume: malformed state ({name}: {error})") from None

    @property
    def durations(self) -> tuple[Fraction, ...] | None:
        """Of the answer; setting them alone leaves it without speeds."""
        return None if self.answer is None else self.answer[0]

    @durations.setter
    def durations(self, durations: tuple[Fraction, ...]) -> None:
        self.answer = durations, None

    @property
    def upper(self) -> Fraction | None:
        """Total of the answer, s."""
        return None if self.durations is None else sum(self.durations, Fraction(0))

    @property
    def seconds(self) -> float:
        """Time since the run began."""
        return self.clock.used

    @property
    def left(self) -> float:
        """Seconds that a search may still take: judging and the answer have the rest."""
        return (self.clock.seconds - self._answering) / (1.0 + self.judging) - self.seconds

    def check_clock(self) -> None:
        """Raise `OutOfTime` when what is left of the time is needed for judging.

        So it does when as many boxes were visited as are allowed: whether the clock has a say is up
        to who asks.
        """
        boxed = self.nodes >= self.request.boxes
        if not boxed and self.left >= 0.0:
            return
        if self._unsearched and self.left_out is None:
            self.left_out = BOXED if boxed else UNBOUNDED if self.proof is None else BARE
        raise OutOfTime

    @contextmanager
    def part(self, boxes: float, share: float) -> Iterator[None]:
        """Limit what runs within to some boxes and a share of the time that is left.

        Reaching that limit does not end the run, and the boxes are not counted against its own.
        """
        request, clock, before = self.request, self.clock, self.nodes
        self.request = replace(request, boxes=before + boxes)
        self.clock = clock.share(share)
        try:
            yield
        except OutOfTime:
            self.left_out = None
        finally:
            self.request = replace(request, boxes=request.boxes + self.nodes - before)
            self.clock = clock

    def searching(self) -> AbstractContextManager[None]:
        """Within, `time_up` says when a search is to end that does not ask the session."""
        return stopping_after(self.left)

    # --- the answer -------------------------------------------------------------------------------

    def offer(self, durations: Array) -> bool:
        """Take durations as the answer if they are proved feasible and shorter than it.

        Raises
        ------
        OutOfTime
            If the time for that proof is over: nothing is said of the durations then.
        """
        began = self.seconds
        try:
            proved = prove_feasible(self.exact, durations, Clock(self.clock.left + self.answering))
        except OutOfTime:
            self.left_out = UNPROVED
            raise
        # Whoever judges proves the answer once more.
        self._answering = max(self._answering, self.seconds - began)
        if proved is None or (self.upper is not None and sum(proved) >= self.upper):
            return False
        self.durations = proved
        return True

    def seek(self, initial: Array | None = None) -> bool:
        """Look for a shorter answer with the local solver, from given durations or its own starts.

        What a local search has found already is taken instead of its starts. The solver has a
        share of the time that is left, and then what it has found is taken.

        Returns
        -------
        bool
            Whether one was found.
        """
        known = self.request.known
        if initial is None and known is not None and self.offer(known):
            return True
        with self.sharing_the_time():
            solution = solve(self.floats, seed=self.request.seed, initial=initial)
        tries = [h for h in (solution.vector, initial) if h is not None]
        shorter = [self.offer(h) for h in tries]
        return any(shorter)

    def sharing_the_time(self) -> AbstractContextManager[None]:
        """Within, a local search ends after its share of the time that is left."""
        return stopping_after(self.seeking * self.clock.left)

    def stretched(self, directions: Array) -> Array:
        """Rows of durations, each stretched until it keeps the limits and the least durations.

        A stretch knows nothing of positions and of upper bounds.
        """
        stretch = evaluate(self.floats, directions).stretch
        stretch = np.maximum(stretch, (self.floats.duration_lower / directions).max(axis=1))
        return np.asarray(directions * stretch[:, None], dtype=np.float64)

    # --- the bound --------------------------------------------------------------------------------

    def keep(self, lower: Fraction, proof: Argument) -> None:
        """Keep a proof if it is the best."""
        if lower > self.lower:
            self.lower, self.proof, self._unsearched = lower, proof, False

    def keep_at_once(self, lower: Fraction, proof: Argument) -> None:
        """Keep a proof that needs no search, before one begins: with no time left it is there."""
        if lower > self.lower:
            self.lower, self.proof, self._unsearched = lower, proof, True

    def climb(
        self,
        ladder: Ladder,
        rounded: Callable[[Fraction], Fraction],
        stage: Callable[[Fraction], Argument],
    ) -> None:
        """Prove one total after the other; a shorter answer begins the ladder anew.

        Parameters
        ----------
        ladder : Ladder
        rounded : callable
            Rounds a total down to what the kind of proof can write.
        stage : callable
            Proves that no total is below the one given; raises `Shorter` or `OutOfTime`.

        Raises
        ------
        OutOfTime
            If a stage raises it, or a shorter answer cannot be proved feasible.
        """
        while True:
            before = self.upper
            try:
                stages, leaping = ladder.stages(self.request.gap), False
                for gap in stages:
                    assert self.upper is not None
                    target = rounded(self.upper * (1 - Fraction(gap)))
                    if target <= self.lower or (leaping and gap != stages[-1]):
                        continue
                    began = self.seconds
                    self.keep(target, stage(target))
                    took = self.seconds - began
                    leaping = leaping or ladder.leaps(gap, took, self.clock.left)
                return
            except Shorter as found:
                if self.upper == before and not self.seek(found.durations):
                    raise OutOfTime from None  # the improvement is too slight to prove

    def report(self, open_boxes: int, nodes: int, lower: Fraction | float | None = None) -> None:
        """Tell whoever asked how far the run is, now and then."""
        self.open_boxes, self.nodes = open_boxes, nodes
        now = self.seconds
        if self.request.report is None or now - self._reported < self.often:
            return
        self._reported = now
        least = max(float(self.lower), 0.0 if lower is None else float(lower))
        upper = math.inf if self.upper is None else float(self.upper)
        gap = math.inf if self.upper is None else 1.0 - least / upper
        self.request.report(Progress(least, upper, gap, open_boxes, nodes, nodes / max(now, 1e-9)))

    # --- the end ----------------------------------------------------------------------------------

    def result(self, complete: bool, subject: Subject) -> Certified:
        """The interval that is proved.

        Raises
        ------
        TrajgapError
            If the bound lies above the answer: one of the two proofs is wrong.
        """
        durations, speeds = (None, None) if self.answer is None else self.answer
        upper = self.upper
        if upper is not None and upper < self.lower:
            raise TrajgapError("certify: the proof contradicts the answer, one of them is wrong")
        outcome = outcome_of(self.lower, upper, self.request.gap)
        if outcome is Outcome.OPEN and self.infeasible:
            outcome = Outcome.INFEASIBLE
        elif outcome is Outcome.OPEN and self.one_sided:
            outcome = Outcome.INTERVAL
        return Certified(
            self.exact,
            outcome,
            self.lower,
            upper,
            durations,
            self.nodes,
            0 if complete else self.open_boxes,
            self.seconds,
            self.proof,
            outcome in (Outcome.INTERVAL, Outcome.OPEN) and not (complete and self.proof is None),
            None if complete else self.proposals,
            subject,
            speeds,
            left_out=None if complete else self.left_out,
        )
