"""Branch and bound for C2 cubic splines, below one cap: linear programs narrow box after box."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ....problem import Array
from ....verify import TICKS, OutOfTime
from ...clock import time_up
from ..crew import Common
from ..driver import Branching
from .guide import errors, peaks
from .relaxation import BoxProgram, Proposal, Relaxation
from .system import CubicRow, CubicSystem
from .tree import Prover, TickBox, Tree


class WorkedBox(NamedTuple):
    """A box that was worked on.

    ``box`` is the box itself, or a copy of it from another process; ``cut`` the coordinate to halve
    if it stays open, or −1; ``rows`` are velocities at peaks that turned up, and ``points`` optima
    of the relaxations, in the free coordinates.
    """

    box: TickBox
    cut: int
    rows: tuple[CubicRow, ...]
    points: tuple[Array, ...]


@dataclass(frozen=True)
class NarrowingEffort:
    """How much work a box is worth; what is proved does not depend on it.

    Attributes
    ----------
    rounds : int
        On one box at most: a guard, because they end where one shrinks it by less than ``again``.
    worth : float
        A side is moved if it gains this share of the width.
    near : float
        A side is not tried if the point that is lowest in total is this near to it.
    again : float
        Another round if the volume fell to this share.
    finest : int
        Width in ticks of boxes that are not halved further.
    """

    rounds: int = 4
    worth: float = 0.05
    near: float = 0.1
    again: float = 0.5
    finest: int = 64


def work_on(prover: Prover, box: TickBox, rows: tuple[CubicRow, ...]) -> WorkedBox:
    """Narrow a box round after round.

    Parameters
    ----------
    prover : Prover
    box : TickBox
        Changed in place.
    rows : tuple of CubicRow
        Velocity conditions that are known.

    Returns
    -------
    WorkedBox
        A function of prover, box and rows alone.

    Raises
    ------
    OutOfTime
        When time is up; what was done to the box by then stands.
    """
    work = _BoxWork(prover, list(rows), NarrowingEffort())
    cut = work.narrowed(box)
    return WorkedBox(box, cut, tuple(work.rows[len(rows) :]), tuple(work.points))


class CubicStage(Branching[TickBox]):
    """Raises the floor of the lowest box until it reaches the goal.

    Each box knows the rows that were known when it was taken up, fewer than it could: that took 3
    in 100 boxes more than one at a time.

    Parameters
    ----------
    tree : Tree
        To work on.
    target : Fraction
        The total to prove, s.
    improve : callable
        Given a system and a point of its relaxation, from which there may be a better answer.
    watch : callable
        Given a tree, the boxes that wait, and those that were worked on.
    """

    ahead = 8
    work = staticmethod(work_on)

    def __init__(
        self,
        tree: Tree,
        target: Fraction,
        improve: Callable[[CubicSystem, Array], None],
        watch: Callable[[Tree, int, int], None],
    ) -> None:
        self._tree, self.prover = tree, tree.prover
        self._goal = min(math.ceil(target / self.prover.system.unit), self.prover.system.cap)
        self._improve, self._watch = improve, watch
        self.rows = self.prover.system.starting_rows()
        self.common = Common(self.prover)
        self.boxes, self.finest = 0, False

    @property
    def tree(self) -> Tree:
        """What is proved."""
        return self._tree.grown

    def order(self, box: TickBox) -> int:
        """The lowest floor first."""
        return box.own.floor

    def wanted(self, box: TickBox) -> bool:
        """Whether its floor is below the goal."""
        return box.own.floor < self._goal and not self.finest

    def given(self, box: TickBox) -> tuple[TickBox, tuple[CubicRow, ...]]:
        """The box, and the rows that are known."""
        return box, tuple(self.rows)

    def taken(self, box: TickBox, found: WorkedBox) -> tuple[TickBox, ...]:
        """Take what came of a box, and halve it, unless it is as small as it may be."""
        # An interrupt in between leaves more steps than the box itself knows of.
        box.steps = found.box.steps
        box.own = found.box.own
        for point in found.points:
            self._improve(self.prover.system, point)
        self.rows += [row for row in found.rows if row not in self.rows]
        self.boxes += 1
        if box.closed:
            return ()
        if found.cut < 0:
            self.finest = True
            return ()
        return tuple(half for half in self.prover.halve(box, found.cut) if not half.closed)

    def look(self, waiting: int) -> None:
        """Report."""
        self._watch(self.tree, waiting, self.boxes)


class _BoxWork:
    """The linear programs of one box."""

    def __init__(self, prover: Prover, rows: list[CubicRow], effort: NarrowingEffort) -> None:
        self.prover, self.rows, self.effort = prover, rows, effort
        self.relaxation = Relaxation(prover.system, rows)
        self.points: list[Array] = []

    def narrowed(self, box: TickBox) -> int:
        """The coordinate to halve if it stays open, or −1."""
        prover, best = self.prover, None
        for _ in range(self.effort.rounds):
            prover.narrow(box)
            if box.closed:
                return -1
            program = BoxProgram(self.relaxation, box.own)
            program, found = self._total(program, box)
            if found is None or box.closed:
                break
            best = errors(program, found)
            before = self._volume(box)
            self._sides(program, box, found)
            if box.closed or self._volume(box) > self.effort.again * before:
                break
        widths = np.subtract(box.own.high, box.own.low)
        if box.closed or widths.max() < self.effort.finest:
            return -1
        score = widths / widths.max()
        if best is not None and best.max() > 0:
            score = best / best.max() + 0.01 * score
        score[widths < self.effort.finest] = -1.0
        return int(np.argmax(score))

    def _volume(self, box: TickBox) -> float:
        return float(np.prod(np.subtract(box.own.high, box.own.low, dtype=np.float64)))

    def _total(self, program: BoxProgram, box: TickBox) -> tuple[BoxProgram, Proposal | None]:
        """Raise the floor by the bound of the total, with velocities at the peaks found so far.

        Returns the program with those velocities in it, and its answer.
        """
        prover, total = self.prover, self.prover.system.total
        found = program.bound(total, capped=False)
        if found is not None:
            point = found.point[: prover.exact.free]
            self.points.append(point)
            new = [row for row in peaks(prover.system, point) if row not in self.rows]
            if new:
                self.rows += new
                self.relaxation = Relaxation(prover.system, self.rows)
                program = BoxProgram(self.relaxation, box.own)
                found = program.bound(total, capped=False)
        if found is None:
            empty = program.emptiness()
            if empty is not None:
                prover.clear(box, empty)
            return program, None
        prover.lift(box, found)
        return program, found

    def _sides(self, program: BoxProgram, box: TickBox, found: Proposal) -> None:
        """Move the sides inward."""
        for k in range(self.prover.exact.free):
            for sign in (1, -1):
                if time_up():
                    raise OutOfTime
                low, high = box.own.low[k], box.own.high[k]
                width, place = high - low, float(found.point[k]) * TICKS
                distance = place - low if sign > 0 else high - place
                if distance <= self.effort.near * width:
                    continue
                moved = program.bound({k: sign})
                if moved is not None:
                    least = max(1, math.ceil(self.effort.worth * width))
                    self.prover.tighten(box, k, sign, moved, least)
                    if box.closed:
                        return
