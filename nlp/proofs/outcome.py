"""What a certifier is asked for and returns: a proved interval, and the argument behind it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from typing import Any, Protocol

from ...problem import Array, shown_bound
from ...verify import CertificateVerdict, Subject, number
from ..clock import RunClock
from .crew import ProofCrew
from .exact import ExactProblem

GAP = 1e-6
"""Relative width of the interval that is asked for by default."""


class Outcome(StrEnum):
    """How a certification ended."""

    CERTIFIED = "certified"
    """The optimum lies in the interval, whose relative width is at most the gap asked for."""
    INFEASIBLE = "infeasible"
    """No durations within their bounds keep the limits: proved."""
    INTERVAL = "interval"
    """Stopped early: the optimum lies in the interval, which is wider than asked for."""
    OPEN = "open"
    """No motion is proved to keep the limits; a lower bound may be proved."""


@dataclass(frozen=True)
class Progress:
    """Progress of a long run: bounds in s, relative gap, open boxes, boxes per second."""

    lower: float
    upper: float
    gap: float
    open_boxes: int
    nodes: int
    rate: float


class Argument(Protocol):
    """What proves a lower bound, or what a stopped run can go on from."""

    def document(self) -> dict[str, Any]:
        """JSON-ready, with ``kind``; every number as exact text."""


@dataclass(frozen=True)
class WrittenProof:
    """A proof as it stands in documents: small, or read in one and proved again."""

    proof: dict[str, Any]

    def document(self) -> dict[str, Any]:
        """As it stands there."""
        return self.proof


@dataclass(frozen=True)
class Request:
    """What is asked of a certifier.

    Attributes
    ----------
    gap : float
        Relative width of the interval to reach.
    clock : RunClock
        Of search and judging; the session ends the search early enough.
    boxes : float
        Boxes after which the search ends, whatever the time.
    known : ndarray, shape (segments,), or None
        An answer that a local search has found already, s.
    seed : int
        Of the starts of a local solver.
    resume : Certified or None
        Where a stopped run is to go on: proved again.
    report : callable or None
        Called with a `Progress` now and then.
    crew : ProofCrew
        Who works on pieces of search and judging.
    """

    gap: float = GAP
    clock: RunClock = field(default_factory=lambda: RunClock(math.inf))
    seed: int = 0
    resume: Certified | None = None
    report: Callable[[Progress], None] | None = None
    crew: ProofCrew = field(default_factory=ProofCrew)
    boxes: float = math.inf
    known: Array | None = None


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
    nodes, open_boxes : int
    seconds : float
    proof : Argument or None
        What proves ``lower``; None if nothing is proved.
    stopped : bool
        Whether its state is worth continuing from.
    proposals : Argument or None
        Parts that a stopped run had not finished.
    subject : Subject
        Curves that the interval covers.
    speeds : tuple or None
        Velocities of the answer at the way-points, if it is an answer for any curve.
    verdict : CertificateVerdict or None
        The verdict of `trajgap.verify` on the certificate; None if nothing is proved.
    left_out : str or None
        The step that the time limit was too short for, in words, if nothing more is known.
    widened : bool
        Whether the bound was proved within the larger size of limits whose sides differ: it holds,
        but may stay below the optimum for any time limit.
    kept : bool
        Whether the proof comes from an earlier run and was verified in this one.
    """

    problem: ExactProblem
    outcome: Outcome
    lower: Fraction
    upper: Fraction | None
    durations: tuple[Fraction, ...] | None
    nodes: int
    open_boxes: int
    seconds: float
    proof: Argument | None = None
    stopped: bool = False
    proposals: Argument | None = None
    subject: Subject = Subject.DECLARED
    speeds: tuple[tuple[Fraction, ...], ...] | None = None
    verdict: CertificateVerdict | None = None
    left_out: str | None = None
    widened: bool = False
    kept: bool = False

    @property
    def one_sided(self) -> Certified:
        """Without the answer, where limits were left out that it need not keep."""
        if not self.problem.relaxed or self.durations is None:
            return self
        proved = self.outcome is Outcome.INFEASIBLE
        outcome = self.outcome if proved else Outcome.INTERVAL
        return replace(self, outcome=outcome, upper=None, durations=None, speeds=None)

    @property
    def gap(self) -> float:
        """Relative width of the interval, (upper − lower)/upper; inf without an answer."""
        if self.upper is None:
            return float("inf")
        return float((self.upper - self.lower) / self.upper)

    def __str__(self) -> str:
        if self.outcome is Outcome.INFEASIBLE:
            head = "no durations within their bounds keep the limits: proved"
        elif self.upper is None and not self.lower:
            head = "nothing proved"
        elif self.upper is None:
            head = f"optimum at least {shown_bound(self.lower, 'lower', places=9)} s, no answer"
        else:
            head = (
                f"optimum in [{shown_bound(self.lower, 'lower', places=9)}, "
                f"{shown_bound(self.upper, 'upper', places=9)}] s, "
                f"gap {self.gap:.1e}, {self.outcome}"
            )
        left = "" if self.left_out is None else f"; left out: {self.left_out}"
        return f"{self.problem.name}: {head}; {self.nodes} boxes, {self.seconds:.1f} s{left}"


def claimed(
    problem: ExactProblem,
    document: dict[str, Any],
    verdict: CertificateVerdict,
    gap: float,
    subject: Subject,
) -> Certified:
    """What stands in a problem's certificate or state, which `trajgap.verify` has proved again.

    ``gap`` is the one up to which its interval counts as certified.
    """
    claim, written = document["claim"], document["proof"]
    durations, speeds = claim["durations"], claim["speeds"]
    proof = None if written is None else WrittenProof(written)
    pending = document.get("proposals")
    answer = None if durations is None else tuple(map(number, durations))
    lower = Fraction(0) if proof is None or verdict.lower is None else verdict.lower
    upper = None if answer is None else sum(answer, Fraction(0))
    outcome = outcome_of(lower, upper, gap)
    return Certified(
        problem,
        Outcome.INFEASIBLE if verdict.infeasible else outcome,
        lower,
        upper,
        answer,
        0,
        0,
        0.0,
        proof,
        stopped=outcome is not Outcome.CERTIFIED and not verdict.infeasible,
        proposals=None if pending is None else WrittenProof(pending),
        subject=subject,
        speeds=None if speeds is None else tuple(tuple(map(number, row)) for row in speeds),
        verdict=verdict,
    )


def outcome_of(lower: Fraction, upper: Fraction | None, gap: float) -> Outcome:
    """What an interval amounts to; without a proof the lower end is 0."""
    if upper is None:
        return Outcome.OPEN
    near = lower > 0 and upper - lower <= upper * Fraction(gap)
    return Outcome.CERTIFIED if near else Outcome.INTERVAL
