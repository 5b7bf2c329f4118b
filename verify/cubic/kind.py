"""Proof of a lower bound for C2 cubic splines: the steps and leaves of its tree.

Why the proof holds is in docs/explanation/certificates-cubic.md. A file gives weights; every bound
that follows from them is computed here anew, in exact arithmetic.
"""

from __future__ import annotations

from typing import Any

from ..ranges import MOST_INTEGER, MOST_ROWS, TICKS
from ..reading import listed, need, sign_of, text, whole
from ..tree import ProofKind
from .box import Box, Range
from .system import Cubic, Number
from .weights import least


class CubicSpline(ProofKind[Box]):
    """Boxes of durations, which steps narrow."""

    keys = ("powers", "second", "cap", "root", "rows")
    apart = 8  # each node is rational arithmetic

    def read(self, proof: dict[str, Any]) -> None:
        """The system, its cap, the table of rows, and the outermost box."""
        self.cubic = Cubic(self.problem, proof)
        total = self.total / self.cubic.second
        need(total <= self.cubic.cap, "the total exceeds the cap below which the boxes lie")
        self._ticks = total * TICKS
        rows = listed(proof["rows"], "rows", MOST_ROWS)
        self._known = [self.cubic.condition(entry) for entry in self.clock.each(rows)]
        self._root = self.cubic.root(proof["root"])

    def root(self) -> Box:
        """Its lower sides are stated in the file, and proved."""
        low, high = self._root
        nothing: list[list[Range]] = [[None] * self.cubic.size for _ in range(self.cubic.joints)]
        box = Box(list(low), list(high), nothing)
        box.trim(self.cubic)
        return box

    def cut(self, box: Box, coordinate: int, place: Any) -> tuple[Box, Box]:
        """At the stated tick; a place outside leaves one part empty."""
        k, at = whole(coordinate, 0, self.cubic.free - 1), whole(place, 0, MOST_INTEGER)
        below, above = box.again(), box.again()
        below.move(self.cubic, k, -1, at)
        above.move(self.cubic, k, 1, at)
        return below, above

    def step(self, box: Box, tag: str, data: list[Any]) -> Box:
        """Narrow the ranges ("r"), raise the floor of the total ("f"), or move a side ("t")."""
        if tag not in ("r", "f", "t"):
            return super().step(box, tag, data)
        if box.empty:
            return box
        if tag == "r":
            listed(data, 'a step "r"', 0)
            box.narrow(self.cubic, self.clock)
        elif tag == "f":
            value, scale, *weights = listed(data, 'a step "f"', 5, 5)
            whole(value, 0, MOST_INTEGER)
            total = dict.fromkeys(range(self.cubic.m), whole(scale, 1, MOST_INTEGER))
            proved = self._least(box, total, weights) * TICKS >= value * scale
            need(proved, "a floor is not proved")
            box.floor = max(box.floor, value)
            box.trim(self.cubic)
        else:
            k, sign, value, scale, *weights = listed(data, 'a step "t"', 7, 7)
            whole(k, 0, self.cubic.free - 1)
            sign_of(sign)
            whole(value, -MOST_INTEGER, MOST_INTEGER)
            target = {k: sign * whole(scale, 1, MOST_INTEGER)}
            proved = self._least(box, target, weights) * TICKS >= sign * value * scale
            need(proved, "a side is not proved")
            box.move(self.cubic, k, sign, value)
        return box

    def leaf(self, box: Box, data: list[Any]) -> None:
        """The box is empty, which weights may have to show, or its floor is high enough."""
        if box.empty:
            return
        if data:
            need(self._least(box, {}, data) > 0, "the box is not proved to be empty")
        else:
            need(box.floor >= self._ticks, "the floor of a box is below the total")

    def _least(self, box: Box, target: dict[int, int], weights: list[Any]) -> Number:
        """Least value of the target with weights: of conditions, of equations, and the shares."""
        held, equations, mix = listed(weights, "weights", 3, 3)
        text(mix, "shares of products")
        return least(self.cubic, box, self._known, target, held, equations, lambda _: mix)
