"""Boxes of durations and leaves with weighted limits, of the proofs computed in floats."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from copy import copy
from itertools import permutations
from math import perm
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from .ranges import MOST_LIMITS, MOST_ROWS, MOST_WEIGHT
from .reading import listed, need, sign_of, weights, whole
from .tree import ProofKind

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
Sides = tuple[list[float], list[float]]
"""Least and largest durations, in the proof's unit of time."""

_NUMBERS = 2_000_000
"""In the largest array of a batch: 16 MB, beyond which numpy is no faster."""
_LEAVES = 512
"""In a batch at most: from there on numpy's own work outweighs the calls."""
np.empty(2 * _NUMBERS)  # freed at once: glibc then reuses such memory; page faults took a quarter
SLACK = 1e-12
"""Of the sides of a box: far more than the rounding of the sums that shrink it."""


class Boxes(ProofKind[Sides]):
    """Boxes that hold every answer of a total, or of a smaller one; a kind judges their leaves.

    Where answers may be stretched in time, one with a smaller total is stretched to this one, which
    keeps the limits: boxes are then those of the simplex of durations whose sum is the total, and
    its multiplier τ may have either sign.

    """

    apart = 500  # a batch of leaves
    centres: ClassVar[Callable[..., Any]]
    """Given the task and sides of boxes: the curves at their centres, with the bound of leaves."""
    most: float
    """The total, in the proof's unit of time."""
    shortest: list[float]
    longest: list[float]
    """Sides of the box that holds all answers."""
    stretches = True
    rows: Rows
    """Segment, joint, order, sign and place of limits that leaves lean on."""
    batch: int
    """Leaves that are judged together."""
    task: Any
    """Its ``cap`` is the limit of each row."""

    def read(self, proof: dict[str, Any]) -> None:
        """A kind reads the proof; no leaf waits."""
        self._waiting: list[tuple[Sides, list[Any]]] = []

    def read_rows(self, stated: Any, first: int, places: int) -> Rows:
        """Rows of orders from the first one on, whose places count in 1/places of a piece."""
        last = self.problem.segments - 1, self.problem.joints - 1
        entries = (listed(row, "a row", 5, 5) for row in listed(stated, "rows", MOST_ROWS))
        found = [
            [
                whole(segment, 0, last[0]),
                whole(joint, 0, last[1]),
                whole(order, first, 3),
                sign_of(sign),
                whole(place, 0, places),
            ]
            for segment, joint, order, sign, place in self.clock.each(entries)
        ]
        rows = np.array(found, np.int64).reshape(-1, 5)
        limited = np.isfinite(self.task.cap(rows)).all()
        need(bool(limited), "a row leans on a limit that is not there")
        return rows

    def together(self, size: int) -> None:
        """Judge as many leaves at a time as arrays allow, the largest of which has a size each."""
        self.batch = max(1, min(_LEAVES, _NUMBERS // max(1, size)))

    def root(self) -> Sides:
        """From the least durations, which are proved, to the total or the upper bounds."""
        return self.shrunk(self.shortest, self.longest)

    def shrunk(self, low: list[float], high: list[float]) -> Sides:
        """Part of a box whose durations can add up to the total, with something to spare."""
        total, below, above = self.most, sum(low), sum(high)
        slack = SLACK * (above + total)
        least, sides = low, list(zip(low, high, strict=True))
        if self.stretches:
            least = [x if (x := total - (above - b) - slack) > a else a for a, b in sides]
        most = [x if (x := total - (below - a) + slack) < b else b for a, b in sides]
        return least, most

    @staticmethod
    @abstractmethod
    def middle(low: float, high: float) -> float:
        """Where a side is cut."""

    def cut(self, box: Sides, coordinate: int, place: Any) -> tuple[Sides, Sides]:
        """In the middle of a side; where the parts overlap or leave the box they still cover it."""
        need(place is None, "the place of a cut is not stated in this kind of proof")
        low, high = box
        k = whole(coordinate, 0, len(low) - 1)
        middle = self.middle(low[k], high[k])
        return (
            self.shrunk(low, [*high[:k], middle, *high[k + 1 :]]),
            self.shrunk([*low[:k], middle, *low[k + 1 :]], high),
        )

    def leaf(self, box: Sides, data: list[Any]) -> None:
        """Nothing, if the box is empty; or [τ, row, weight, row, weight, …]."""
        if not data:
            need(any(a > b for a, b in zip(*box, strict=True)), "it is not empty")
            return
        self._waiting.append((box, data))
        if len(self._waiting) == self.batch:
            self.end()

    def alone(self) -> Self:
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
        for _, (tau, *stated) in waiting:
            taus.append(whole(tau, -MOST_WEIGHT if self.stretches else 0, MOST_WEIGHT))
            pairs = weights(stated, len(self.rows), MOST_LIMITS)
            leaves.append([(row, whole(weight, 0, MOST_WEIGHT)) for row, weight in pairs])
        most = max(map(len, leaves))
        ids, shares = np.zeros((len(leaves), most), np.int64), np.zeros((len(leaves), most))
        for at, pairs in enumerate(leaves):
            for place, (row, weight) in enumerate(pairs):
                ids[at, place], shares[at, place] = row, weight
        sides = np.array([box for box, _ in waiting])
        with np.errstate(all="ignore"):  # what is not finite fails every comparison
            centre = self.centre(sides)
            found = centre.least(np.array(taus, np.float64), self.rows[ids], shares)
        need(bool((found > 0.0).all()), "a leaf with limits is not proved")

    def centre(self, sides: Array) -> Any:
        """The curves at the centres of boxes (box, least or largest, segment)."""
        return self.centres(self.task, sides[:, 0], sides[:, 1])


def shapes(rows: Rows, powers: int, places: int) -> Array:
    """Sign times the derivative of each power of s at a row's place: (..., power)."""
    s, order = rows[..., 4] / places, rows[..., 2]
    factors = np.array([[perm(p, r) for p in range(powers)] for r in range(4)], np.float64)
    power = np.ones((*s.shape, powers))
    for p in range(1, powers):
        # The power of s that is left of sᵖ.
        power[..., p] = np.where(p > order, power[..., p - 1] * s, 1.0)
    return np.asarray(rows[..., 3, None] * factors[order] * power)


def least_of_quadratic(gradient: Array, bend: Array, e: Array) -> Array:
    """At most gᵀδ + ½ δᵀBδ for all |δ_k| ≤ e_k, box by box.

    In x = δ/e, b x_k x_m ≥ −½|b|(x_k² + x_m²): products of two take from the squares. If they are
    positive at the corner s of the least linear part, |b|(s_k x_k + s_m x_m − 1) is below them too.
    A share of it instead raises the least value, as long as that is taken in this corner.
    """
    each = np.arange(e.shape[1])
    bend = bend * e[:, :, None] * e[:, None, :]
    own = bend[:, each, each]
    bend[:, each, each] = 0.0
    own = own - np.abs(bend).sum(axis=2)
    lean, vertex = np.abs(gradient) * e, np.where(gradient > 0.0, -1.0, 1.0)
    spare = np.clip(0.5 * (lean - own), 0.0, lean)
    alike = np.maximum(bend * vertex[:, :, None] * vertex[:, None, :], 0.0)
    given = np.minimum(spare / np.maximum(alike.sum(axis=2), 1e-300), 1.0)
    lent = (alike * np.minimum(given[:, :, None], given[:, None, :])).sum(axis=2)
    inside = lean < own
    turn = -0.5 * lean * lean / np.where(inside, own, 1.0)
    return np.asarray((np.where(inside, turn, 0.5 * own - lean) + lent).sum(axis=1))


def most_of_cubes(cubes: Array) -> Array:
    """At least |Σ c_kmp x_k x_m x_p| for all |x| ≤ 1: what one product has in all its orders."""
    alike = sum(np.transpose(cubes, (0, *order)) for order in permutations((1, 2, 3)))
    return np.asarray(np.abs(alike).sum(axis=(1, 2, 3)) / 6.0)
