"""Proofs at fixed ratios of the durations, where the total is the one unknown.

Their tree is one leaf: a place at which every shorter total breaks a limit.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NoReturn

from .curve import UNIFORM, derivative, pieces, uniform_pieces, value_at
from .problem import StatedProblem
from .ranges import PLACES
from .reading import Clock, Refused, listed, need, required, whole
from .tree import ProofKind


class FixedRatios(ProofKind[None]):
    """Curves whose derivatives of order r fall with the total T as T⁻ʳ."""

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        self._shares = required(
            problem.shares, "the problem fixes no ratios that are rational numbers"
        )
        # A velocity prescribed at an end does not fall with the total.
        declared = problem.declaration
        known = problem.curve == UNIFORM if declared is None else declared.at_rest
        need(known, "declaration not covered: no curve that may be stretched in time")

    def root(self) -> None:
        """All totals."""
        return

    def cut(self, box: None, coordinate: int, place: Any) -> NoReturn:
        """No box is cut."""
        raise Refused("a proof in closed form has one leaf")

    def leaf(self, box: None, data: list[Any]) -> None:
        """[joint, order, segment, place]: limit·Tʳ ≥ |derivative if the total is 1 s|.

        The limit is that on the side of the derivative. Joint −1 stands for the lower bound of the
        segment's duration.
        """
        problem, total = self.problem, self.total
        joint, order, segment, place = listed(data, "a place", 4, 4)
        k = whole(segment, 0, problem.segments - 1)
        if whole(joint, -1, problem.joints - 1) == -1:
            need(total * self._shares[k] <= problem.shortest[k], "above its lower bound")
            return
        r = whole(order, 1, 3)
        value = self.value(joint, k, r, Fraction(whole(place, 0, PLACES), PLACES))
        side = problem.sides[1 if value > 0 else 0]
        bound = required(side[joint][r - 1], "a limit that is not there")
        need(bound[1] > 0, "a limit that is not there")
        need(bound[1] * total**r <= abs(value), "the total is not proved")

    def value(self, joint: int, segment: int, order: int, place: Fraction) -> Fraction:
        """Derivative at a place of a segment if the total is 1 s."""
        share = self._shares[segment]
        if self.problem.curve == UNIFORM:
            piece = uniform_pieces(self.problem, self.clock)[joint][segment]
            return value_at(derivative(piece, order), place) / share**order
        piece = pieces(self.problem, self._shares, self.clock)[joint][segment]
        return value_at(derivative(piece, order), place * share)

    @property
    def infeasible(self) -> bool:
        """Whether a segment takes more than its upper bound at the total that is proved."""
        both = zip(self._shares, self.problem.longest, strict=True)
        return any(top is not None and self.total * share > top for share, top in both)
