"""Proof of a lower bound for any declared curve: boxes of durations and weighted limits.

The argument is that of docs/explanation/certificates-declared.md.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from fractions import Fraction
from math import inf, nan, nextafter, sqrt
from typing import Any

import numpy as np

from .declared_bound import Array, Centre, Task, padded
from .declared_form import linear_form
from .floors import least_durations
from .problem import Bounds, Declaration, StatedProblem
from .ranges import (
    MOST_DECLARED_SEGMENTS,
    MOST_DECLARED_UNKNOWNS,
    MOST_LIMITS,
    MOST_ROWS,
    MOST_WEIGHT,
    PLACES,
    SMALLEST_CAP,
)
from .reading import Clock, listed, need, sign_of, whole
from .tree import LEAF, ProofKind

SLACK = 1e-12
"""Of the sides of a box: far more than the rounding of the sums that shrink it."""
_NUMBERS = 2_000_000
"""In the largest array of a batch: 16 MB, beyond which numpy is no faster."""
_LEAVES = 512
"""In a batch at most: from there on numpy's own work outweighs the calls."""

_NO_FLOOR = "no limit of a joint that moves in it, and no bound, keeps its duration above 0"
"""Why a problem is not covered: logarithms of durations have to be bounded."""

Sides = tuple[list[float], list[float]]
"""Least and largest durations, in the proof's unit of time."""


class DeclaredCurve(ProofKind[Sides]):
    """Boxes that hold every feasible answer of the total, or of a smaller one.

    Without upper bounds of the durations, and if no derivative is prescribed but 0, an answer with
    a smaller total is stretched to this one, which keeps every limit: boxes are then those of the
    simplex of durations whose sum is the total, and τ may have either sign.
    """

    keys = ("rows",)
    apart = True

    def __init__(
        self, problem: StatedProblem, proof: dict[str, Any], total: Fraction, clock: Clock
    ) -> None:
        super().__init__(problem, proof, total, clock)
        declared = covered(problem)
        need(total > 0, "the total is not positive")
        self.second = Fraction(2) ** _power(total)
        self._stretches = declared.at_rest and not any(x is not None for x in problem.longest)
        self.task = self._task(declared)
        exact = [x / self.second for x in least_durations(problem, total)]
        both = zip(exact, self._returning(declared), strict=True)
        self.least = [max(nextafter(float(x), 0.0), y) for x, y in both]
        stated = listed(proof["rows"], "rows", MOST_ROWS)
        rows = [self._row(entry) for entry in clock.each(stated)]
        self._rows = np.array(rows, np.int64).reshape(-1, 5)
        there = np.isfinite(self.task.cap(self._rows)).all()
        need(bool(there), "a row leans on a limit that is not there")
        self.batch = self._batch()
        nodes = proof["tree"]
        self._hopeless = type(nodes) is list and len(nodes) == 1 and _single(nodes[0])
        self._waiting: list[tuple[Sides, list[Any]]] = []

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
        prescribed = [
            {
                r: [x * self.second**r / u for x, u in zip(row, units, strict=True)]
                for r, row in at.items()
            }
            for at in declared.prescribed
        ]
        sizes = [abs(x) for at in prescribed for row in at.values() for x in row if x]
        usual = all(SMALLEST_CAP < x < 1 / SMALLEST_CAP for x in sizes)
        need(usual, "a prescribed derivative is of unusual size")
        form = linear_form(
            replace(declared, prescribed=prescribed),
            [[q / unit for q, unit in zip(row, units, strict=True)] for row in moved],
            self.clock,
        )
        need(len(form.orders) <= MOST_DECLARED_UNKNOWNS, "the curve has too many unknowns")
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
            for own, other, free, value, turn in (
                (behind, before, form.ends[p], form.end[p], 1.0),
                (before, behind, form.starts[p], form.start[p], (-1.0) ** order),
            ):
                if own < n and not free.any():
                    longest = task.total * (1.0 + SLACK) if other < n else 1.0
                    known[own, other, int(order)] = value * turn / longest**order
        for (own, other, order), speeds in known.items():
            start, finish = at[own], at[own + 1]
            if order != 1 or start is None or finish is None:
                continue
            bend = known.get((own, other, 2), np.full(task.joints, nan))
            for j, speed in enumerate(speeds):
                if start[j] != finish[j]:
                    continue
                found = abs(speed) / caps[j, 2]
                if speed * bend[j] >= 0.0:
                    found = max(found, sqrt(6.0 * abs(speed) / caps[j, 3]))
                least[own] = max(least[own], found * (1.0 - SLACK))
        return least

    def _row(self, entry: Any) -> list[int]:
        """[segment, joint, order, sign, place]."""
        segment, joint, order, sign, place = listed(entry, "a row", 5, 5)
        return [
            whole(segment, 0, self.problem.segments - 1),
            whole(joint, 0, self.problem.joints - 1),
            whole(order, 0, 3),
            sign_of(sign),
            whole(place, 0, PLACES),
        ]

    def _batch(self) -> int:
        """Leaves that are judged together: long curves fewer."""
        task = self.task
        m, breaks = task.unknowns, task.breaks
        most = max(1, m * breaks * max(m, breaks * task.joints))
        return int(max(1, min(_LEAVES, _NUMBERS // most)))

    def root(self) -> Sides:
        """From the least durations, which are proved, to the total or the upper bounds."""
        zero = [k for k, x in enumerate(self.least, 1) if x <= 0]
        need(self._hopeless or not zero, f"segment {min(zero, default=0)}: {_NO_FLOOR}")
        high = [
            self.task.total * (1.0 + SLACK) if x is None else nextafter(float(x / self.second), inf)
            for x in self.problem.longest
        ]
        return self._shrunk(self.least, high)

    def _shrunk(self, low: list[float], high: list[float]) -> Sides:
        """Part of a box whose durations can add up to the total, with something to spare."""
        total = self.task.total
        below, above = sum(low), sum(high)
        slack = SLACK * (above + total)
        if self._stretches:
            least = [max(a, total - (above - b) - slack) for a, b in zip(low, high, strict=True)]
        else:
            least = low  # a smaller total is not stretched
        most = [min(b, total - (below - a) + slack) for a, b in zip(low, high, strict=True)]
        return least, most

    def cut(self, box: Sides, coordinate: int, place: Any) -> tuple[Sides, Sides]:
        """At the geometric mean of a side."""
        need(place is None, "the place of a cut is not stated in this kind of proof")
        least, most = box
        k = whole(coordinate, 0, len(least) - 1)
        middle = sqrt(max(0.0, least[k] * most[k]))
        # Where the parts overlap or leave the box they still cover it.
        return (
            self._shrunk(least, [*most[:k], middle, *most[k + 1 :]]),
            self._shrunk([*least[:k], middle, *least[k + 1 :]], most),
        )

    def leaf(self, box: Sides, data: list[Any]) -> None:
        """Nothing, if the box is empty; [row]; or [τ, row, weight, row, weight, …]."""
        if not data:
            need(empty(box), "it is not empty")
            return
        if len(data) == 1:
            row = self._rows[whole(data[0], 0, len(self._rows) - 1)]
            need(self._beyond(*row.tolist()), "no way-point is beyond its limit there")
            return
        self._waiting.append((box, data))
        if len(self._waiting) == self.batch:
            self.end()

    def _beyond(self, segment: int, joint: int, order: int, sign: int, place: int) -> bool:
        """Whether a way-point is there that is beyond a position limit."""
        declared, ends = self.problem.declaration, self.problem.position[(1 + sign) // 2][joint]
        virtual = [] if declared is None else declared.virtual
        at = segment + place // PLACES
        if order != 0 or place % PLACES != 0 or at in virtual or ends is None:
            return False
        angle = self.problem.waypoints[at - sum(b < at for b in virtual)][joint]
        return sign * angle > max(sign * x for x in ends)

    def alone(self) -> DeclaredCurve:
        """Its leaves wait for nobody else's."""
        own = copy(self)
        own._waiting = []
        return own

    def end(self) -> None:
        """Judge the leaves with limits that wait."""
        waiting, self._waiting = self._waiting, []
        if not waiting:
            return
        taus, leaves = [], []
        for _, (tau, *pairs) in waiting:
            taus.append(whole(tau, -MOST_WEIGHT if self._stretches else 0, MOST_WEIGHT))
            need(len(pairs) % 2 == 0, "a leaf misses a weight")
            need(len(pairs) <= 2 * MOST_LIMITS, "a leaf has too many rows")
            which = [whole(row, 0, len(self._rows) - 1) for row in pairs[::2]]
            leaves.append((which, [whole(weight, 0, MOST_WEIGHT) for weight in pairs[1::2]]))
        ids, weights = padded(leaves)
        sides = np.array([box for box, _ in waiting])
        with np.errstate(all="ignore"):  # what is not finite fails every comparison
            centre, tau = self.centre(sides), np.array(taus, np.float64)
            found = centre.least(tau, self._rows[ids], weights, float(PLACES))
        need(bool((found > 0.0).all()), "a leaf with limits is not proved")

    def centre(self, sides: Array) -> Centre:
        """Boxes as an array (box, least or largest, segment)."""
        return Centre(self.task, sides[:, 0], sides[:, 1])


def _single(node: Any) -> bool:
    """Whether a node is a leaf with one row alone."""
    return type(node) is list and len(node) == 2 and node[0] == LEAF


def empty(box: Sides) -> bool:
    """Whether no durations are in a box."""
    return any(a > b for a, b in zip(*box, strict=True))


def covered(problem: StatedProblem) -> Declaration:
    """The declaration of a problem, if this kind of proof speaks about it."""
    declared = problem.declaration
    need(declared is not None, "declaration not covered: no declared piecewise polynomial")
    assert declared is not None
    n = problem.segments
    need(n > 1 or not declared.at_rest, "one segment alone has no inner break")
    need(n <= MOST_DECLARED_SEGMENTS, f"more than {MOST_DECLARED_SEGMENTS} segments")
    return declared


def _power(size: Fraction) -> int:
    """Of a power of two within a factor 2 of a size; 0 for a size of 0."""
    return size.numerator.bit_length() - size.denominator.bit_length() if size else 0


def _cap(size: Bounds, unit: Fraction) -> float:
    """A limit in the proof's units; one that is 0, or of unusual size there, takes no part."""
    if size is None:
        return inf
    own = size[1] * unit
    return float(own) if SMALLEST_CAP < own < 1 / SMALLEST_CAP else inf
