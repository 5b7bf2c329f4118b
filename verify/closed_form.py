"""Proofs in closed form, in which each segment stands alone.

Their tree is one leaf: a least duration for each segment.
"""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction
from math import comb
from typing import Any, NoReturn

from .curve import UNIFORM, derivative, uniform_pieces, value_at
from .problem import StatedProblem
from .ranges import PLACES
from .reading import Clock, Refused, listed, need, number, required, whole
from .tree import ProofKind


class ClosedForm(ProofKind[None]):
    """What both kinds have in common."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        self._late = False

    @abstractmethod
    def value(self, joint: int, segment: int, order: int, place: Fraction) -> Fraction:
        """Derivative at a place if the segment takes 1 s."""

    def root(self) -> None:
        """All durations."""
        return

    def cut(self, box: None, coordinate: int, place: Any) -> NoReturn:
        """No box is cut."""
        raise Refused("a proof in closed form has one leaf")

    def leaf(self, box: None, data: list[Any]) -> None:
        """[joint, order, place, least duration] of every segment: limit·hʳ ≥ |derivative|.

        The limit is that on the side of the derivative.

        Joint −1 stands for the duration's own lower bound.
        """
        problem, n, least = self.problem, self.problem.segments, []
        for k, entry in enumerate(listed(data, "one bound per segment", n, n)):
            self.clock.check()
            joint, order, place, stated = listed(entry, "a bound", 4, 4)
            x = number(stated)
            need(x >= 0, f"segment {k + 1}: a negative duration")
            if whole(joint, -1, problem.joints - 1) == -1:
                need(x <= problem.shortest[k], f"segment {k + 1}: above its lower bound")
            else:
                r = whole(order, 1, 3)
                value = self.value(joint, k, r, Fraction(whole(place, 0, PLACES), PLACES))
                side = problem.sides[1 if value > 0 else 0]
                bound = required(side[joint][r - 1], "a limit that is not there")
                need(bound[1] > 0, "a limit that is not there")
                proved = bound[1] * x**r <= abs(value)
                need(proved, f"segment {k + 1}: its least duration is not proved")
            least.append(x)
        reached = sum(self.clock.each(least), Fraction(0))
        need(self.total <= reached, "the total is not proved")
        both = zip(least, problem.longest, strict=True)
        self._late = any(top is not None and x > top for x, top in both)

    @property
    def infeasible(self) -> bool:
        """Whether a segment needs more than its upper bound."""
        return self._late


class RestToRest(ClosedForm):
    """Polynomials of one odd degree, at rest at every way-point."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        self._shape = _from_rest(_degree(problem))

    def value(self, joint: int, segment: int, order: int, place: Fraction) -> Fraction:
        """Of q_k + Δq·φ."""
        q = self.problem.waypoints
        way = q[segment + 1][joint] - q[segment][joint]
        return way * value_at(derivative(self._shape, order), place)


class Stretched(ClosedForm):
    """Uniform cubic B-splines, each segment stretched in time.

    A segment's duration h divides the derivatives in its own time by h, h², h³, and enters no
    other segment. The limits are those inside the segments: where neighbours differ in duration,
    the velocity jumps.
    """

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        stretched = problem.curve == UNIFORM
        need(stretched, "declaration not covered: no stretched uniform cubic B-spline")
        self._curves = uniform_pieces(problem, clock)

    def value(self, joint: int, segment: int, order: int, place: Fraction) -> Fraction:
        """In the time of the segment."""
        return value_at(derivative(self._curves[joint][segment], order), place)


def _degree(problem: StatedProblem) -> int:
    declared = required(problem.declaration, "declaration not covered: no rest-to-rest polynomials")
    degree, n = declared.degrees[0], len(declared.degrees)
    still = [Fraction(0)] * problem.joints
    rest = dict.fromkeys(range(1, (degree + 1) // 2), still)
    need(
        declared.degrees == [2 * len(rest) + 1] * n
        and bool(rest)
        and declared.continuity == [0] * (n - 1)
        and declared.prescribed == [rest] * (n + 1)
        and not declared.virtual,
        "declaration not covered: no rest-to-rest polynomials",
    )
    return degree


def _from_rest(degree: int) -> list[Fraction]:
    """From 0 to 1 with half of the derivatives 0 at both ends: the integral of (s(1 − s))ᵐ."""
    m = degree // 2
    inside = [Fraction(0)] * m + [Fraction((-1) ** k * comb(m, k)) for k in range(m + 1)]
    total = sum(c / (p + 1) for p, c in enumerate(inside))
    return [Fraction(0)] + [c / (p + 1) / total for p, c in enumerate(inside)]
