"""Best-first branch and bound for C2 cubic splines, below one cap."""

from __future__ import annotations

import heapq
import itertools
import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ....verify import TICKS
from ..crew import Common, ProofCrew, ProofPiece
from ..session import OutOfTime
from .guide import errors, peaks
from .proof import TOTAL, Target
from .relaxation import BoxProgram, Proposal, Relaxation
from .system import CubicRow, CubicSystem
from .tree import Prover, TickBox

_AHEAD = 8
"""Boxes that are taken up before what comes of the first is known: enough for four workers. Each
of them knows fewer rows than it could, which took 3 in 100 boxes more than one at a time."""
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

    crew: ProofCrew

    @property
    def searching(self) -> float:
        """Seconds that are left."""

    def clock(self) -> None:
        """While a box is worked on elsewhere, and after each."""

    def look(self, search: Search, under_way: int) -> None:
        """Before every box."""

    def improve(self, system: CubicSystem, point: NDArray[np.float64]) -> None:
        """At the optimum of a relaxation, in the free coordinates."""


@dataclass(frozen=True, eq=False)
class WorkedBox:
    """A box that was worked on.

    Attributes
    ----------
    box : TickBox
        The box itself, or a copy of it from another process.
    cut : int
        The coordinate to halve if it stays open, or −1.
    rows : tuple of CubicRow
        Velocities at peaks that turned up.
    points : tuple of ndarray
        Optima of the relaxations, in the free coordinates.
    late : bool
        Time was up: what is proved by then.
    """

    box: TickBox
    cut: int
    rows: tuple[CubicRow, ...]
    points: tuple[NDArray[np.float64], ...]
    late: bool = False


class Search:
    """One stage: raises the floor of the lowest box until it reaches the goal.

    `_AHEAD` boxes are under way at a time, on any number of workers: a box is worked on with the
    rows that were known when it was taken up, and what comes of the boxes is taken in the order in
    which they were taken up. So the tree does not depend on who worked on them.
    """

    def __init__(self, watch: Watch, prover: Prover, root: TickBox) -> None:
        self.watch, self.prover, self.root = watch, prover, root
        self.rows = prover.system.starting_rows()
        self._order = itertools.count()
        self.boxes = 0
        self._worked_before = sum(1 for _ in root.worked())
        self._common = Common(prover)
        self.heap = [(box.floor, next(self._order), box) for box in root.leaves()]
        heapq.heapify(self.heap)

    @property
    def lower(self) -> int:
        """What is proved, in ticks."""
        return min((box.floor for box in self.root.leaves()), default=self.prover.cap)

    @property
    def worked(self) -> int:
        """Boxes of the tree that something was done to."""
        return self._worked_before + self.boxes

    def until(self, goal: Callable[[], int], restart: int = 0) -> bool:
        """Search until ``goal()`` ticks are proved, or the goal fell below ``restart``.

        False if boxes are as small as they may be.
        """
        crew, finest = self.watch.crew, False
        under_way: deque[tuple[TickBox, ProofPiece]] = deque()
        try:
            while True:
                self.watch.look(self, len(under_way))
                while not finest and len(under_way) < _AHEAD and self._wanted(goal(), restart):
                    box = heapq.heappop(self.heap)[2]
                    until = time.time() + self.watch.searching
                    piece = crew.begin(work_on, self._common, box, tuple(self.rows), until)
                    under_way.append((box, piece))
                if not under_way:
                    return not finest
                box, piece = under_way[0]
                found = crew.value(piece, self.watch.clock)
                under_way.popleft()
                finest = not self._taken(box, found) or finest
        except OutOfTime:
            # They end at the same time: what they have proved by then is kept.
            for piece in crew.drop(piece for _, piece in under_way):
                box = next(box for box, own in under_way if own is piece)
                box.take(crew.value(piece).box)
            raise
        finally:
            crew.drop(piece for _, piece in under_way)

    def _wanted(self, goal: int, restart: int) -> bool:
        """Whether the lowest box is to be worked on."""
        return bool(self.heap) and goal >= restart and self.heap[0][0] < min(goal, self.prover.cap)

    def _taken(self, box: TickBox, found: WorkedBox) -> bool:
        """Take what came of a box, and halve it; False if it is as small as it may be."""
        box.take(found.box)
        for point in found.points:
            self.watch.improve(self.prover.system, point)
        self.rows += [row for row in found.rows if row not in self.rows]
        self.boxes += 1
        if found.late:
            self.watch.clock()
            heapq.heappush(self.heap, (box.floor, next(self._order), box))
            return True
        if box.closed:
            return True
        if found.cut < 0:
            return False
        for half in self.prover.halve(box, found.cut):
            if not half.closed:
                heapq.heappush(self.heap, (half.floor, next(self._order), half))
        return True


class _Late(Exception):
    """Time is up."""


def work_on(prover: Prover, box: TickBox, rows: tuple[CubicRow, ...], until: float) -> WorkedBox:
    """Narrow a box round after round.

    Parameters
    ----------
    prover : Prover
    box : TickBox
        Changed in place.
    rows : tuple of CubicRow
        Velocity conditions that are known.
    until : float
        When it ends, by `time.time`.

    Returns
    -------
    WorkedBox
        But for the clock, a function of prover, box and rows alone.
    """
    work = _BoxWork(prover, list(rows), until)
    try:
        cut, late = work.narrowed(box), False
    except _Late:
        cut, late = -1, True
    return WorkedBox(box, cut, tuple(work.rows[len(rows) :]), tuple(work.points), late)


class _BoxWork:
    """The linear programs of one box."""

    def __init__(self, prover: Prover, rows: list[CubicRow], until: float) -> None:
        self.prover, self.rows, self.until = prover, rows, until
        self.relaxation = Relaxation(prover.system, rows, prover.total)
        self.points: list[NDArray[np.float64]] = []

    def narrowed(self, box: TickBox) -> int:
        """The coordinate to halve if it stays open, or −1."""
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
            self.points.append(point)
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
                if time.time() > self.until:
                    raise _Late
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
