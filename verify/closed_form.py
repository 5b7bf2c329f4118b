"""Proofs in closed form: curves that the durations do not change but by stretching each segment.

Their tree is one leaf.
"""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction
from typing import Any, NoReturn

from .curve import UNIFORM, derivative, pieces, value_at
from .ranges import PLACES
from .reading import Refused, listed, need, number, required, whole
from .tree import ProofKind


class ClosedForm(ProofKind[None]):
    """What all of them have in common: pieces for given durations, in a time from 0 to 1."""

    def read(self, proof: dict[str, Any]) -> None:
        """The curve."""
        self._pieces = pieces(self.problem, self.durations(), self.clock)
        self._least = [Fraction(0)] * self.problem.segments

    @abstractmethod
    def durations(self) -> list[Fraction]:
        """For which the curve is solved; its pieces for all others follow by stretching."""

    def root(self) -> None:
        """All durations."""
        return

    def cut(self, box: None, coordinate: int, place: Any) -> NoReturn:
        """No box is cut."""
        raise Refused("a proof in closed form has one leaf")

    def at(self, joint: int, segment: int, order: Any, place: Any) -> tuple[int, Fraction]:
        """A derivative's order, and the r-th power of the least duration that it needs.

        limit·hʳ ≥ |derivative in the piece's own time|, with the limit on the side of the latter.
        """
        r = whole(order, 1, 3)
        poly = derivative(self._pieces[joint][segment], r)
        value = value_at(poly, Fraction(whole(place, 0, PLACES), PLACES))
        side = self.problem.sides[1 if value > 0 else 0]
        bound = required(side[joint][r - 1], "a limit that is not there")
        need(bound[1] > 0, "a limit that is not there")
        return r, abs(value) / bound[1]

    @property
    def infeasible(self) -> bool:
        """Whether a segment needs more than its upper bound."""
        both = zip(self._least, self.problem.longest, strict=True)
        return any(top is not None and x > top for x, top in both)


class EachAlone(ClosedForm):
    """Curves whose segments have nothing to do with each other.

    Polynomials at rest at every way-point, with all derivatives that are to agree 0 there; or
    uniform cubic B-splines, each segment stretched in time. The limits of these are those inside
    the segments: where neighbours differ in duration, the velocity jumps.
    """

    def durations(self) -> list[Fraction]:
        """All 1."""
        declared = self.problem.declaration
        apart = declared is not None and declared.at_rest and not declared.virtual
        if declared is not None:
            inner = zip(declared.continuity, declared.prescribed[1:-1], strict=True)
            apart &= all(set(range(1, order + 1)) <= set(held) for order, held in inner)
        need(
            apart or self.problem.curve == UNIFORM,
            "declaration not covered: the segments of the curve are not independent",
        )
        return [Fraction(1)] * self.problem.segments

    def leaf(self, box: None, data: list[Any]) -> None:
        """[joint, order, place, least duration] of every segment.

        Joint −1 stands for the duration's own lower bound.
        """
        problem, n = self.problem, self.problem.segments
        for k, entry in enumerate(listed(data, "one bound per segment", n, n)):
            self.clock.check()
            joint, order, place, stated = listed(entry, "a bound", 4, 4)
            x = number(stated)
            need(x >= 0, f"segment {k + 1}: a negative duration")
            if whole(joint, -1, problem.joints - 1) == -1:
                need(x <= problem.shortest[k], f"segment {k + 1}: above its lower bound")
            else:
                r, power = self.at(joint, k, order, place)
                need(x**r <= power, f"segment {k + 1}: its least duration is not proved")
            self._least[k] = x
        reached = sum(self.clock.each(self._least), Fraction(0))
        need(self.total <= reached, "the total is not proved")


class FixedRatios(ClosedForm):
    """Fixed ratios of the durations, where the total is the one unknown."""

    def durations(self) -> list[Fraction]:
        """Those of a total of 1."""
        shares = self.problem.shares
        self._shares = required(shares, "the problem fixes no ratios that are rational numbers")
        declared = self.problem.declaration
        # A derivative prescribed other than 0 does not fall with the total.
        known = declared is not None and declared.at_rest
        need(
            known or self.problem.curve == UNIFORM,
            "declaration not covered: no curve that may be stretched in time",
        )
        return self._shares

    def leaf(self, box: None, data: list[Any]) -> None:
        """[joint, order, segment, place]; joint −1 stands for the segment's own lower bound."""
        problem = self.problem
        joint, order, segment, place = listed(data, "a place", 4, 4)
        k = whole(segment, 0, problem.segments - 1)
        own = self.total * self._shares[k]
        if whole(joint, -1, problem.joints - 1) == -1:
            need(own <= problem.shortest[k], "above its lower bound")
        else:
            r, power = self.at(joint, k, order, place)
            need(own**r <= power, "the total is not proved")
        self._least = [self.total * share for share in self._shares]
