"""Branch and bound over boxes of durations: linear programs propose, rational numbers prove."""

from __future__ import annotations

import heapq
import itertools
import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ..crew import Common, ProofCrew, ProofPiece
from ..session import OutOfTime
from .exact import FreeQuestion
from .program import least_total, lower
from .rows import BRAKE, CHANGE, REACH, ReachRow, Sides, bound
from .tangents import (
    Floats,
    Ints,
    brake_rows,
    change_rows,
    floats,
    matrix,
    reach_rows,
)

_TOLERANCE = 1e-10
"""Excess, scaled, above which a tangent is added: the tolerance of the linear program."""
_ROUNDS = 60
"""Linear programs for one box at most: a guard, since they end where tangents gain little."""
_STALL = 4
"""Rounds in which a bound must gain a tenth of what it lacks: fewer could be one unlucky vertex."""
_NEAR = 1e-3
"""Rows this close to being active are handed on to the halves of a box."""
_MARGIN = 0.1
"""A box is never cut closer to its sides than this share of its width."""
_AHEAD = 2
"""Trials under way for each worker: the next one is there when one ends."""
_LOWEST = 64
"""Boxes whose first trials may begin before their turn: enough for many workers."""
_TRIALS = 5
"""Cuts tried for one box: each costs the bounds of two halves."""
_FAINT = 0.01
"""Share of the largest score below which cutting a segment cannot pay."""
_NARROWEST = 1e-12
"""Relative width below which a side is not cut: some digits more, and no float is inside."""
_DOUBTFUL = 1e-6
"""Excess, scaled, below which durations look feasible enough for the local solver to try them."""


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


class Trials:
    """Trials of cuts that were begun, by box.

    All boxes whose bound is below the target are cut, in whatever order: those of the lowest ones
    may begin before it is their turn.
    """

    def __init__(self, crew: ProofCrew) -> None:
        self.crew, self.most = crew, _AHEAD * crew.workers if crew.shared else 1
        self._begun: dict[Node, list[ProofPiece]] = {}

    def take(
        self, number: int, lowest: list[Node], begun: Callable[[Node, int], ProofPiece]
    ) -> ProofPiece:
        """A trial of the lowest box, while others are under way.

        What is sure to be needed comes first: the first trial of each box. Others of the lowest box
        follow where boxes are few.
        """
        mine = self._begun.setdefault(lowest[0], [])
        while len(mine) <= number:
            mine.append(begun(lowest[0], len(mine)))
        for node in lowest[1:]:
            if node not in self._begun and node.cuts and self._room:
                self._begun[node] = [begun(node, 0)]
        while len(mine) < len(lowest[0].cuts) and self._room:
            mine.append(begun(lowest[0], len(mine)))
        return mine[number]

    @property
    def _room(self) -> bool:
        """Whether fewer are under way than would keep everybody at work."""
        every = (piece for pieces in self._begun.values() for piece in pieces)
        return sum(not piece.finished for piece in every) < self.most

    def end(self, node: Node) -> None:
        """Give up the trials of a box that are not needed."""
        self.crew.drop(self._begun.pop(node))

    def drop(self) -> None:
        """Give up what is left."""
        for every in self._begun.values():
            self.crew.drop(every)


@dataclass(eq=False)
class Search:
    """The tree of boxes for one question.

    Attributes
    ----------
    asked : FreeQuestion
    cap : Fraction
        Totals below it are looked at, s.
    clock : callable
        Called before every box; stops the search by raising.
    searching : callable
        Seconds that are left.
    crew : ProofCrew
        Who tries the cuts. The tree does not depend on it: what a trial finds is a function of the
        box, and trials count in the order of `Node.cuts`, the box with the least bound first.
    """

    asked: FreeQuestion
    cap: Fraction
    nodes: int = 0
    looks: int = 8
    clock: Callable[[], None] = lambda: None
    searching: Callable[[], float] = lambda: np.inf
    crew: ProofCrew = field(default_factory=ProofCrew)
    until: float = np.inf
    speeds: tuple[Fraction, ...] = field(init=False)
    scaled: Floats = field(init=False)

    def __post_init__(self) -> None:
        joints = range(len(self.asked.joints))
        self.speeds = tuple(self.asked.speed(j, self.cap) for j in joints)
        self._common = Common(self)
        self.scaled = floats(self.asked, self.speeds, float(self.cap) / len(self.asked.steps))

    def __getstate__(self) -> dict[str, Any]:
        """All that another process, or a trial, needs to bound a box."""
        own = {"clock", "searching", "crew", "_common", "nodes", "looks"}
        return {key: value for key, value in vars(self).items() if key not in own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        rest = {"clock": lambda: None, "searching": lambda: np.inf, "crew": ProofCrew()}
        vars(self).update(state, **rest, nodes=0, looks=0)

    def whole(self) -> Sides | None:
        """The box of all durations with a total below the cap; None if it is empty."""
        floor = [self.asked.floor(k) for k in range(len(self.asked.steps))]
        spare = self.cap - sum(floor)
        box = tuple(
            (low, low + spare if top is None else min(top, low + spare))
            for low, top in zip(floor, self.asked.longest, strict=True)
        )
        return None if any(low > high for low, high in box) else box

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
        self.clock()
        if time.time() > self.until:
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
        for _ in range(_ROUNDS):
            if best.lower >= target:
                break
            answer = least_total(scaled, rows, low, high, target / unit)
            if answer is None:
                break
            x, weights = answer
            proved = lower(scaled, rows, weights, low, high) * unit
            h, v = x[: len(box)], x[len(box) :].reshape(len(box) + 1, -1)
            new_reach = reach_rows(scaled, h, v, _TOLERANCE)
            new_brake, excess = brake_rows(scaled, h, v, low, high, _TOLERANCE)
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
            stalled = len(past) > _STALL and past[-1] - past[-_STALL] < 0.1 * (target - past[-1])
            if not len(new) or (stalled and enough):
                break
            rows = np.unique(np.concatenate([rows, new]), axis=0)
        return best

    def _near(self, rows: Ints, low: Array, high: Array, x: Array) -> NDArray[np.bool_]:
        left, right, _ = matrix(self.scaled, rows, low, high)
        return np.asarray((left @ x - right < _NEAR) | (rows[:, 0] == CHANGE))

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
        wide = width > _NARROWEST * high
        turns = [
            int(rank[n])
            for n in range(len(low))
            for score, rank in zip(scores, ranks, strict=True)
            if wide[rank[n]] and score[rank[n]] > _FAINT * score.max()
        ]
        cuts = []
        for k in list(dict.fromkeys(turns))[:_TRIALS]:
            margin = _MARGIN * width[k]
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
        low, high = node.box[segment]
        if not low < at < high:
            raise ValueError("a cut lies outside its box")
        before, after = node.box[:segment], node.box[segment + 1 :]
        return tuple(
            self.node((*before, side, *after), node.carried, target, node)
            for side in ((low, at), (at, high))
        )

    def _best_cut(self, lowest: list[Node], target: float, trials: Trials) -> tuple[Node, ...]:
        """Try several cuts of the lowest box and keep the one whose worse half is bounded best."""
        node, begun = lowest[0], self._trial(target)

        def worth(parts: tuple[Node, ...]) -> tuple[float, float]:
            ends = sorted(min(part.lower, target) for part in parts)
            return ends[0], ends[1]

        tried = []
        for number, (segment, at) in enumerate(node.cuts):
            piece = trials.take(number, lowest, begun)
            parts, nodes = self.crew.value(piece, self.clock)
            self.nodes += nodes
            tried.append((worth(parts), segment, at, parts))
            if worth(parts)[0] >= target:
                break
        trials.end(node)
        _, node.segment, node.at, node.parts = max(tried, key=lambda found: found[0])
        return node.parts

    def grow(
        self,
        root: Node,
        target: float,
        watch: Callable[[float, int], None],
        improve: Callable[[Array], bool],
    ) -> bool:
        """Cut boxes, the one with the least bound first, until every bound is enough.

        Parameters
        ----------
        root : Node
            Changed in place.
        target : float
            s.
        watch : callable
            Called with the least bound and the number of open boxes; stops the search by raising.
        improve : callable
            Called with durations that look feasible and too short, s; true ends the search.

        Returns
        -------
        bool
            Whether it was completed; otherwise a better motion turned up or nothing can be cut.
        """
        count = itertools.count()
        heap = [(leaf.lower, next(count), leaf) for leaf in root.leaves if leaf.lower < target]
        heapq.heapify(heap)
        stuck, trials = False, Trials(self.crew)
        try:
            while heap:
                watch(heap[0][0], len(heap))
                node = heap[0][2]
                if node.durations is not None and node.excess < _DOUBTFUL and self.looks > 0:
                    self.looks -= 1
                    if improve(node.durations * self.scaled.time):
                        return False
                if not node.cuts:
                    heapq.heappop(heap)
                    stuck = True
                    continue
                lowest = [one for _, _, one in heapq.nsmallest(_LOWEST, heap)]
                parts = self._best_cut(lowest, target, trials)
                heapq.heappop(heap)
                for part in parts:
                    if part.lower < target:
                        heapq.heappush(heap, (part.lower, next(count), part))
        finally:
            trials.drop()
        return not stuck

    def _trial(self, target: float) -> Callable[[Node, int], ProofPiece]:
        """What begins the trial of a cut of a node."""
        until = time.time() + self.searching()
        return lambda node, cut: self.crew.begin(
            trial, self._common, node, *node.cuts[cut], target, until
        )

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
        box, scaled = self.whole(), self.scaled
        nothing = np.empty((0, 7), dtype=np.int64)
        if box is None:
            return Node((), nothing, np.empty(0), np.inf, nothing)
        v = np.nan_to_num(speeds) * scaled.time / scaled.angle
        tangents = reach_rows(scaled, durations / scaled.time, v, -np.inf)
        return self.node(box, np.concatenate([change_rows(scaled), tangents]), target, None)

    def exact(self, leaf: Node, digits: int) -> tuple[Fraction, list[tuple[ReachRow, str]]]:
        """What the weights of a leaf, rounded to so many digits, prove: s, and them as text."""
        if not leaf.box:
            return self.cap, []
        scaled = self.scaled
        rates = scaled.time**2 / scaled.angle[leaf.rows[:, 2]]
        weights = leaf.weights * np.where(leaf.rows[:, 0] == REACH, 1.0, rates)
        texts = [
            (ReachRow(*map(int, row)), f"{weight:.{digits}g}".replace("e+", "e"))
            for row, weight in zip(leaf.rows, weights, strict=True)
        ]
        weighted = ((row, Fraction(text)) for row, text in texts)
        return bound(self.asked, self.speeds, leaf.box, weighted), texts


def trial(
    search: Search, node: Node, segment: int, at: Fraction, target: float, until: float
) -> tuple[tuple[Node, ...], int]:
    """Halves of a box, and how many boxes were bounded for them.

    Raises
    ------
    OutOfTime
        If it would take longer than until then, by `time.time`.
    """
    own = copy(search)
    own.until = until
    return own.parts(node, segment, at, target), own.nodes
