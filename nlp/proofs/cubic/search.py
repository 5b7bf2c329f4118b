"""Best-first branch and bound for C2 cubic splines, below one cap."""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ....verify import TICKS
from .guide import errors, peaks
from .proof import TOTAL, Target
from .relaxation import BoxProgram, Proposal, Relaxation
from .system import CubicSystem
from .tree import Prover, TickBox

_ROUNDS = 4
"""On one box at most: a guard, since they end where one shrinks it by less than `_AGAIN`."""
_WORTH = 0.05
"""A side is moved if it gains this share of the width."""
_NEAR = 0.1
"""A side is not tried if the point that is lowest in total is this near to it."""
_AGAIN = 0.5
"""Another round if the volume fell to this share."""
_FINEST = 64
"""Width in ticks of boxes that are not halved further."""


class Watch(Protocol):
    """Who is asked between the steps; stops the search by raising."""

    def clock(self) -> None:
        """After every linear program."""

    def look(self, search: Search) -> None:
        """Before every box."""

    def improve(self, system: CubicSystem, point: NDArray[np.float64]) -> None:
        """At the optimum of a relaxation, in the free coordinates."""


class Search:
    """One stage: raises the floor of the lowest box until it reaches the goal."""

    def __init__(self, watch: Watch, prover: Prover, root: TickBox) -> None:
        self.watch, self.prover, self.root = watch, prover, root
        self.rows = prover.system.starting_rows()
        self.relaxation = Relaxation(prover.system, self.rows, prover.total)
        self._order = itertools.count()
        self.boxes = 0
        self._given = sum(1 for _ in root.worked())
        self.heap = [(box.floor, next(self._order), box) for box in root.leaves()]
        heapq.heapify(self.heap)

    @property
    def lower(self) -> int:
        """What is proved, in ticks."""
        return min((box.floor for box in self.root.leaves()), default=self.prover.cap)

    @property
    def worked(self) -> int:
        """Boxes of the tree that something was done to."""
        return self._given + self.boxes

    def until(self, goal: Callable[[], int], restart: int = 0) -> bool:
        """Search until ``goal()`` ticks are proved, or the goal fell below ``restart``.

        False if boxes are as small as they may be.
        """
        while self.heap and self.heap[0][0] < min(goal(), self.prover.cap):
            if goal() < restart:
                return True
            self.watch.look(self)
            box = self.heap[0][2]
            if not box.closed and not box.children:
                cut = self._work(box)
                if not box.closed:
                    if cut < 0:
                        return False
                    self.prover.halve(box, cut)
            heapq.heappop(self.heap)
            for half in box.children:
                if not half.closed:
                    heapq.heappush(self.heap, (half.floor, next(self._order), half))
            self.boxes += 1
        return True

    def _work(self, box: TickBox) -> int:
        """Narrow a box round after round; the coordinate to halve if it stays open, or −1."""
        prover, best = self.prover, None
        for _ in range(_ROUNDS):
            if not prover.narrow(box):
                return -1
            program = self.relaxation.over(prover.side(box), box.ranges)
            program, found = self._total(program, box)
            if found is None or box.closed:
                break
            best = errors(program, found)
            before = self._volume(box)
            self._sides(program, box, found)
            if box.closed or self._volume(box) > _AGAIN * before:
                break
        widths = np.array(box.high) - np.array(box.low)
        if box.closed or widths.max() < _FINEST:
            return -1
        score = widths / widths.max()
        if best is not None and best.max() > 0:
            score = best / best.max() + 0.01 * score
        score[widths < _FINEST] = -1.0
        return int(np.argmax(score))

    def _volume(self, box: TickBox) -> float:
        return float(np.prod(np.subtract(box.high, box.low, dtype=np.float64)))

    def _total(self, program: BoxProgram, box: TickBox) -> tuple[BoxProgram, Proposal | None]:
        """Raise the floor by the bound of the total, with velocities at the peaks found so far.

        Returns the program with those velocities in it, and its answer.
        """
        prover = self.prover
        found = program.bound(TOTAL, capped=False)
        if found is not None:
            point = found.point[: prover.system.free]
            self.watch.improve(prover.system, point)
            new = [row for row in peaks(prover.system, point) if row not in self.rows]
            if new:
                self.rows += new
                self.relaxation = Relaxation(prover.system, self.rows, prover.total)
                program = self.relaxation.over(program.side, box.ranges)
                found = program.bound(TOTAL, capped=False)
        if found is None:
            empty = program.emptiness()
            if empty is not None:
                prover.clear(box, empty.weights)
            return program, None
        prover.lift(box, found.weights)
        return program, found

    def _sides(self, program: BoxProgram, box: TickBox, found: Proposal) -> None:
        """Move the sides inward."""
        for k in range(self.prover.system.free):
            for sign in (1, -1):
                self.watch.clock()
                width = box.high[k] - box.low[k]
                place = float(found.point[k]) * TICKS
                distance = place - box.low[k] if sign > 0 else box.high[k] - place
                if distance <= _NEAR * width:
                    continue
                moved = program.bound(Target(k, sign))
                if moved is not None:
                    least = max(1, math.ceil(_WORTH * width))
                    self.prover.tighten(box, k, sign, moved.weights, least)
                    if box.closed:
                        return
