"""Proof of a lower bound for any declared curve: boxes of durations and weighted limits.

The argument is that of docs/explanation/certificates-declared.md.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import inf, nan, nextafter, sqrt
from typing import Any

import numpy as np

from . import ranges
from .boxes import SLACK, Array, Boxes, Sides
from .declared_bound import Centre, Task
from .declared_form import linear_form
from .floors import least_durations
from .problem import Bounds, Declaration
from .reading import need, required, whole
from .tree import LEAF

_NO_FLOOR = "no limit of a joint that moves in it, and no bound, keeps its duration above 0"
"""Why a problem is not covered: logarithms of durations have to be bounded."""


class DeclaredCurve(Boxes):
    """Boxes between least durations, which are proved, and the total or upper bounds.

    Answers may be stretched where no duration has an upper bound and no derivative is prescribed
    but 0.
    """

    keys = ("rows",)
    centres = Centre

    def read(self, proof: dict[str, Any]) -> None:
        """The curve and its limits in units of the proof, least durations, and the rows."""
        super().read(proof)
        problem, n, most = self.problem, self.problem.segments, ranges.MOST_DECLARED_SEGMENTS
        declared = required(
            problem.declaration, "declaration not covered: no declared piecewise polynomial"
        )
        need(n > 1 or not declared.at_rest, "one segment alone has no inner break")
        need(n <= most, f"more than {most} segments")
        need(self.total > 0, "the total is not positive")
        self.second = Fraction(2) ** _power(self.total)
        self.stretches = declared.at_rest and not any(x is not None for x in problem.longest)
        self.task = self._task(declared)
        exact = [x / self.second for x in least_durations(problem, self.total)]
        both = zip(exact, self._returning(declared), strict=True)
        self.shortest = [max(nextafter(float(x), 0.0), y) for x, y in both]
        self.rows = self.read_rows(proof["rows"], 0, ranges.PLACES)
        self.longest = [
            self.task.total * (1.0 + SLACK) if x is None else nextafter(float(x / self.second), inf)
            for x in problem.longest
        ]
        self.most, m, breaks = self.task.total, self.task.unknowns, self.task.breaks
        self.together(m * breaks * max(m, breaks * problem.joints))
        self._hopeless = False
        match proof["tree"]:
            case [[tag, _]] if tag == LEAF:
                self._hopeless = True

    @property
    def infeasible(self) -> bool:
        """Whether the proof is one way-point beyond its limit, whatever the durations."""
        return self._hopeless

    def _task(self, declared: Declaration) -> Task:
        """The curve and its limits in units in which joints and total are about 1."""
        problem, joints = self.problem, self.problem.joints
        start = problem.waypoints[0]
        moved = [[q - a for q, a in zip(row, start, strict=True)] for row in problem.waypoints]
        units = [Fraction(2) ** _power(max(map(abs, way))) for way in zip(*moved, strict=True)]

        def own(row: list[Fraction], order: int = 0) -> list[Fraction]:
            return [x * self.second**order / u for x, u in zip(row, units, strict=True)]

        stated = declared.prescribed
        prescribed = [{r: own(row, r) for r, row in at.items()} for at in stated]
        sizes = [abs(x) for at in prescribed for row in at.values() for x in row if x]
        usual = all(ranges.within(x, ranges.SMALLEST_CAP) for x in sizes)
        need(usual, "a prescribed derivative is of unusual size")
        scaled = replace(declared, prescribed=prescribed)
        form = linear_form(scaled, list(map(own, moved)), self.clock)
        need(len(form.orders) <= ranges.MOST_DECLARED_UNKNOWNS, "the curve has too many unknowns")
        caps = np.full((2, joints, 4), inf)
        for j, unit in enumerate(units):
            for s, sign in enumerate((-1, 1)):
                ends = problem.position[s][j]
                if ends is not None:
                    caps[s, j, 0] = float(max(sign * (x - start[j]) for x in ends) / unit)
                for r, size in enumerate(problem.sides[s][j], 1):
                    caps[s, j, r] = _cap(size, self.second**r / unit)
        return Task(form, caps, float(self.total / self.second))

    def _returning(self, declared: Declaration) -> list[float]:
        """Least durations of segments at whose end a joint is where it was at the start.

        Its velocity is 0 somewhere inside: a velocity u at an end, which the neighbour alone
        determines, takes |u|/A to fall. Where there is no A, and an acceleration towards the same
        side is determined too, the way |u|h is to be made good by J h³/6.
        """
        task, form, n = self.task, self.task.form, self.problem.segments
        rows, caps = iter(self.problem.waypoints), task.caps.max(axis=0)
        at = [None if b in declared.virtual else next(rows) for b in range(n + 1)]
        least = [0.0] * n
        known: dict[tuple[int, int, int], Array] = {}
        for p, (b, order) in enumerate(zip(form.breaks, form.orders, strict=True)):
            before, behind = form.sides[b].tolist()
            # Seen from the segment, time runs away from the neighbour.
            for own, other, stated, turn in (
                (behind, before, form.ends[p], 1.0),
                (before, behind, form.starts[p], (-1.0) ** order),
            ):
                free, value = np.split(stated, [task.unknowns])
                if own < n and not free.any():
                    longest = task.total * (1.0 + SLACK) if other < n else 1.0
                    known[own, int(b), int(order)] = value * turn / longest**order
        for (own, b, order), speeds in known.items():
            start, finish = at[own], at[own + 1]
            if order != 1 or start is None or finish is None:
                continue
            bend = known.get((own, b, 2), np.full(task.joints, nan))
            for j, speed in enumerate(speeds):
                if start[j] != finish[j]:
                    continue
                found = abs(speed) / caps[j, 2]
                if speed * bend[j] >= 0.0:
                    found = max(found, sqrt(6.0 * abs(speed) / caps[j, 3]))
                least[own] = max(least[own], found * (1.0 - SLACK))
        return least

    def root(self) -> Sides:
        """As any kind has it, where no duration may go to 0."""
        zero = [k for k, x in enumerate(self.shortest, 1) if x <= 0]
        need(self._hopeless or not zero, f"segment {min(zero, default=0)}: {_NO_FLOOR}")
        return super().root()

    @staticmethod
    def middle(low: float, high: float) -> float:
        """The geometric mean."""
        return sqrt(max(0.0, low * high))

    def leaf(self, box: Sides, data: list[Any]) -> None:
        """[row] alone, or as any kind has it."""
        if len(data) != 1:
            super().leaf(box, data)
            return
        row = self.rows[whole(data[0], 0, len(self.rows) - 1)]
        need(self._beyond(*row.tolist()), "no way-point is beyond its limit there")

    def _beyond(self, segment: int, joint: int, order: int, sign: int, place: int) -> bool:
        """Whether a way-point is there that is beyond a position limit."""
        declared, ends = self.problem.declaration, self.problem.position[(1 + sign) // 2][joint]
        virtual = [] if declared is None else declared.virtual
        at = segment + place // ranges.PLACES
        if order != 0 or place % ranges.PLACES != 0 or at in virtual or ends is None:
            return False
        angle = self.problem.waypoints[at - sum(b < at for b in virtual)][joint]
        return sign * angle > max(sign * x for x in ends)


def _power(size: Fraction) -> int:
    """Of a power of two within a factor 2 of a size; 0 for a size of 0."""
    return size.numerator.bit_length() - size.denominator.bit_length() if size else 0


def _cap(size: Bounds, unit: Fraction) -> float:
    """A limit in the proof's units; one that is 0, or of unusual size there, takes no part."""
    if size is None:
        return inf
    own = size[1] * unit
    return float(own) if ranges.within(own, ranges.SMALLEST_CAP) else inf
