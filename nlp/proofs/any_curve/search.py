"""Branch and bound over boxes of durations: linear programs propose, rational numbers prove."""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import Clock, OutOfTime, proof_kind
from ...clock import time_up
from ..crew import Common
from ..driver import Branching
from ..exact import decimal
from .program import least_total, lower
from .question import FreeQuestion
from .tangents import (
    BRAKE,
    CHANGE,
    KINDS,
    REACH,
    Ints,
    brake_rows,
    change_rows,
    floats,
    matrix,
    reach_rows,
)

Sides = list[tuple[Fraction, Fraction]]
"""A box: bounds of every duration, s."""


Weighted = tuple[list[Any], str]
"""A row as a certificate has it, and its weight."""


@dataclass(frozen=True)
class CutEffort:
    """How much work a box is worth; what is proved does not depend on it.

    Attributes
    ----------
    tolerance : float
        Excess, scaled, above which a tangent is added: that of the linear program.
    rounds : int
        Linear programs for one box at most: a guard, because they end where tangents gain little.
    stall : int
        Rounds in which a bound must gain a tenth of what it lacks: fewer could be one unlucky
        vertex.
    near : float
        Rows this close to being active are handed on to the halves of a box.
    margin : float
        A box is never cut closer to its sides than this share of its width.
    trials : int
        Cuts tried for one box: each costs the bounds of two halves.
    faint : float
        Share of the largest score below which cutting a segment cannot pay.
    narrowest : float
        Relative width below which a side is not cut: some digits more, and no float is inside.
    doubtful : float
        Excess, scaled, below which durations look feasible enough for the local solver.
    looks : int
        Times that the local solver tries such durations.
    """

    tolerance: float = 1e-10
    rounds: int = 60
    stall: int = 4
    near: float = 1e-3
    margin: float = 0.1
    trials: int = 5
    faint: float = 0.01
    narrowest: float = 1e-12
    doubtful: float = 1e-6
    looks: int = 8


@dataclass(eq=False)
class Node:
    """A box, the weights that bound the total in it, and where to cut it.

    Attributes
    ----------
    box : Sides
    rows, weights : ndarray
        What bounds the total; weights belong to scaled rows.
    lower : float
        The bound, s.
    carried : ndarray
        Rows for its halves to begin with.
    cuts : tuple of (int, Fraction)
        Where it may be cut, the most promising first.
    durations : ndarray or None
        Of the least total over the rows, scaled.
    excess : float
        By how much they break the true conditions, scaled.
    segment, at, parts : int, Fraction, tuple of Node
        Where it is cut, and its halves; none yet.
    """

    box: Sides
    rows: Ints
    weights: Array
    lower: float
    carried: Ints
    cuts: tuple[tuple[int, Fraction], ...] = ()
    durations: Array | None = None
    excess: float = np.inf
    segment: int = -1
    at: Fraction = Fraction(0)
    parts: tuple[Node, ...] = ()

    @property
    def leaves(self) -> list[Node]:
        """Boxes that are not cut, in preorder."""
        return [leaf for part in self.parts for leaf in part.leaves] if self.parts else [self]


class Search:
    """Bounds the boxes of one question.

    Parameters
    ----------
    asked : FreeQuestion
    cap : Fraction
        Only totals below it are searched, s.

    Attributes
    ----------
    kind : AnyCurve
        The verifier's own kind of proof, without rows.
    nodes : int
        Boxes that were bounded.
    """

    effort = CutEffort()

    def __init__(self, asked: FreeQuestion, cap: Fraction) -> None:
        self.asked, self.cap, self.nodes = asked, cap, 0
        make: Any = proof_kind("any-curve")
        self.kind = make(asked.stated, {"cap": decimal(cap), "rows": []}, cap, Clock(math.inf))
        speeds = [self.kind.speeds[j] for j in asked.joints]
        self.scaled = floats(asked, speeds, float(cap) / len(asked.steps))

    @property
    def beyond(self) -> Node:
        """A box without durations."""
        nothing = np.empty((0, 7), dtype=np.int64)
        return Node([], nothing, np.empty(0), np.inf, nothing)

    def node(self, box: Sides, carried: Ints, target: float, inherited: Node | None) -> Node:
        """Bound the total in a box by a linear program, refined by tangents until it is enough.

        Parameters
        ----------
        box : Sides
        carried : ndarray, shape (rows, 7)
            Rows to begin with.
        target : float
            Bound that is enough, s.
        inherited : Node or None
            The box that this one is a part of: its weights serve if no better ones are found.
        """
        if time_up():
            raise OutOfTime
        self.nodes += 1
        scaled, unit = self.scaled, self.scaled.time
        carried = carried[[box[k][0] > 0 or kind != BRAKE for kind, k in carried[:, :2]]]
        low = np.array([float(a) for a, _ in box]) / unit
        high = np.array([float(b) for _, b in box]) / unit
        best = Node(box, carried[:0], np.empty(0), float(low.sum()) * unit, carried)
        if inherited is not None:
            again = lower(scaled, inherited.rows, inherited.weights, low, high) * unit
            if again > best.lower:
                best = Node(box, inherited.rows, inherited.weights, again, carried)
        best.cuts = self._cuts(low, high, (high - low,), (low + high) / 2)
        rows, past = carried, [best.lower]
        for _ in range(self.effort.rounds):
            if best.lower >= target:
                break
            answer = least_total(scaled, rows, low, high, target / unit)
            if answer is None:
                break
            x, weights = answer
            proved = lower(scaled, rows, weights, low, high) * unit
            h, v = x[: len(box)], x[len(box) :].reshape(len(box) + 1, -1)
            new_reach = reach_rows(scaled, h, v, self.effort.tolerance)
            new_brake, excess = brake_rows(scaled, h, v, low, high, self.effort.tolerance)
            new = np.concatenate([new_reach, new_brake])
            if proved >= best.lower:
                used = weights > 0
                near = self._near(rows, low, high, x)
                best = Node(
                    box,
                    rows[used],
                    weights[used],
                    proved,
                    np.concatenate([rows[near | used], new]),
                    durations=h,
                    excess=float(excess.max()),
                )
                stress = self._stress(best, h, low, high)
                doubt = np.maximum(0.0, excess).max(axis=1)
                enough = unit * stress.sum() > (target - proved) / 4
                best.cuts = self._cuts(low, high, (stress, doubt), h)
            else:
                enough = True
            past.append(proved)
            stalled = len(past) > self.effort.stall and past[-1] - past[
                -self.effort.stall
            ] < 0.1 * (target - past[-1])
            if not len(new) or (stalled and enough):
                break
            rows = np.unique(np.concatenate([rows, new]), axis=0)
        return best

    def _near(self, rows: Ints, low: Array, high: Array, x: Array) -> NDArray[np.bool_]:
        left, right, _ = matrix(self.scaled, rows, low, high)
        return np.asarray((left @ x - right < self.effort.near) | (rows[:, 0] == CHANGE))

    def _stress(self, node: Node, h: Array, low: Array, high: Array) -> Array:
        """What the chords in a box cost in each segment: weight times their distance.

        A brake's chord lies d(1/l + 1/u − h/lu − 1/h) above d/h.
        """
        braking = node.rows[:, 0] == BRAKE
        k, j = node.rows[braking, 1], node.rows[braking, 2]
        a, b, c = low[k], high[k], h[k]
        lost = self.scaled.ways[k, j] * (1 / a + 1 / b - c / (a * b) - 1 / c)
        cost: Array = np.bincount(k, node.weights[braking] * lost, minlength=len(h)).astype(float)
        return cost

    def _cuts(
        self, low: Array, high: Array, scores: tuple[Array, ...], h: Array
    ) -> tuple[tuple[int, Fraction], ...]:
        """Segments with large scores, taken from each list in turn, and the places to cut them."""
        width = high - low
        ranks = [np.argsort(-score) for score in scores]
        wide = width > self.effort.narrowest * high
        turns = [
            int(rank[n])
            for n in range(len(low))
            for score, rank in zip(scores, ranks, strict=True)
            if wide[rank[n]] and score[rank[n]] > self.effort.faint * score.max()
        ]
        cuts = []
        for k in list(dict.fromkeys(turns))[: self.effort.trials]:
            margin = self.effort.margin * width[k]
            place = min(max(h[k], low[k] + margin), high[k] - margin) * self.scaled.time
            digits = 2 - int(np.floor(np.log10(width[k] * self.scaled.time)))
            cuts.append((k, Fraction(round(Fraction(place), digits))))
        return tuple(cuts)

    def halves(self, node: Node, segment: int, at: Fraction, target: float) -> tuple[Node, ...]:
        """Cut a box; its halves are bounded as `node` does it.

        Raises
        ------
        ValueError
            If the cut lies outside the box.
        """
        node.parts = self.parts(node, segment, at, target)
        node.segment, node.at = segment, at
        return node.parts

    def parts(self, node: Node, segment: int, at: Fraction, target: float) -> tuple[Node, ...]:
        """The halves of a box, which is not changed."""
        pair = self.kind.cut(node.box, segment, decimal(at))
        return tuple(self.node(box, node.carried, target, node) for box in pair)

    def best_cut(self, node: Node, target: float) -> Halves:
        """Try several cuts of a box and keep the one whose worse half is bounded best."""

        def worth(parts: tuple[Node, ...]) -> tuple[float, float]:
            ends = sorted(min(part.lower, target) for part in parts)
            return ends[0], ends[1]

        tried = []
        for segment, at in node.cuts:
            parts = self.parts(node, segment, at, target)
            tried.append((worth(parts), segment, at, parts))
            if worth(parts)[0] >= target:
                break
        _, segment, at, parts = max(tried, key=lambda found: found[0])
        return Halves(segment, at, parts, self.nodes)

    def root(self, durations: Array, speeds: Array, target: float) -> Node:
        """The undivided box, bounded with tangents at a known motion.

        Parameters
        ----------
        durations : ndarray, shape (segments,)
            s.
        speeds : ndarray, shape (way-points, joints)
        target : float
            Bound that is enough, s.
        """
        box = self.kind.root()
        if any(low > high for low, high in box):
            return self.beyond
        return self.node(box, self._touching(durations, speeds), target, None)

    def at_once(self, durations: Array, speeds: Array) -> Fraction:
        """What one linear program with tangents at a known motion proves of all durations, s.

        Parameters
        ----------
        durations : ndarray, shape (segments,)
            s.
        speeds : ndarray, shape (way-points, joints)
        """
        box, unit = self.kind.root(), self.scaled.time
        if any(low > high for low, high in box):
            return self.cap
        low, high = np.array([[float(x) for x in side] for side in box]).T / unit
        rows = self._touching(durations, speeds)
        found = least_total(self.scaled, rows, low, high, float(self.cap) / unit)
        weights = np.zeros(len(rows)) if found is None else found[1]
        used = weights > 0
        leaf = Node(box, rows[used], weights[used], -np.inf, rows[:0])
        return min(self.exact(leaf, 12)[0], self.cap)

    def _touching(self, durations: Array, speeds: Array) -> Ints:
        """Limits of the change of speeds, and tangents at a known motion."""
        scaled = self.scaled
        v = np.nan_to_num(speeds) * scaled.time / scaled.angle
        tangents = reach_rows(scaled, durations / scaled.time, v, -np.inf)
        return np.concatenate([change_rows(scaled), tangents])

    def exact(self, leaf: Node, digits: int) -> tuple[Fraction, list[Weighted]]:
        """What a leaf's weights, rounded to this many digits, prove; and its weighted rows."""
        if not leaf.box:
            return self.cap, []
        scaled = self.scaled
        rates = scaled.time**2 / scaled.angle[leaf.rows[:, 2]]
        weights = leaf.weights * np.where(leaf.rows[:, 0] == REACH, 1.0, rates)
        stated = [
            ([KINDS[kind], k, self.asked.joints[j], *rest], f"{w:.{digits}g}".replace("e+", "e"))
            for (kind, k, j, *rest), w in zip(leaf.rows.tolist(), weights, strict=True)
        ]
        weighted = [(self.kind.row(row), Fraction(weight)) for row, weight in stated]
        return self.kind.least_total(leaf.box, weighted), stated


class Halves(NamedTuple):
    """Where a box is cut, both parts, and how many boxes were bounded for them."""

    segment: int
    at: Fraction
    parts: tuple[Node, ...]
    nodes: int


def cut_box(search: Search, node: Node, target: float) -> Halves | None:
    """The best cut of a box; None if it cannot be cut.

    Raises
    ------
    OutOfTime
        When time is up.
    """
    if not node.cuts:
        return None
    own = copy(search)
    own.nodes = 0
    return own.best_cut(node, target)


class Cutting(Branching[Node]):
    """Cuts boxes until every bound is enough, the one with the least bound first.

    Parameters
    ----------
    search : Search
    target : float
        s.
    watch : callable
        Given the boxes that wait and the least bound.
    improve : callable
        Given durations that look feasible and too short, s; may raise.

    Attributes
    ----------
    stuck : bool
        Whether there is a box that cannot be cut.
    """

    ahead = 4
    work = staticmethod(cut_box)

    def __init__(
        self,
        search: Search,
        target: float,
        watch: Callable[[int, float], None],
        improve: Callable[[Array], None],
    ) -> None:
        self.search, self.target, self.stuck = search, target, False
        self.common, self._watch, self._improve = Common(search), watch, improve
        self._lowest = 0.0

    def order(self, box: Node) -> float:
        """The least bound first."""
        return box.lower

    def wanted(self, box: Node) -> bool:
        """Whether its bound is too low."""
        return box.lower < self.target

    def given(self, box: Node) -> tuple[Node, float]:
        """The box, once its durations were looked at."""
        self._lowest = box.lower
        if box.durations is not None and box.excess < self.search.effort.doubtful:
            self._improve(box.durations * self.search.scaled.time)
        return box, self.target

    def taken(self, box: Node, found: Halves | None) -> tuple[Node, ...]:
        """Both halves, where they are not bounded well enough."""
        if found is None:
            self.stuck = True
            return ()
        box.segment, box.at, box.parts = found.segment, found.at, found.parts
        self.search.nodes += found.nodes
        return tuple(part for part in box.parts if part.lower < self.target)

    def look(self, waiting: int) -> None:
        """Report."""
        self._watch(waiting, self._lowest)
