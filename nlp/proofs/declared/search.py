"""Branch and bound over boxes of durations, with the verifier's own arithmetic."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....problem import Array
from ....verify import LEAF, MOST_DEPTH
from ...clock import time_up
from ..crew import Common
from ..driver import Branching
from .rows import Candidates, NearLimits
from .simplex import best_weights

_NARROW = 1e-8
"""Width of a logarithm at which a box is as small as it may get: what second-order terms change in
it is below rounding."""
_LOOKS = 3
"""Directions of a batch that are looked at for a better answer: the shortest ones."""

Sides = tuple[list[float], list[float]]
Leaf = tuple[Any, ...]
"""Nothing; a row; a window and its τ; or τ and rows with their weights."""
Cell = tuple[int, Sides]
"""A box and its number in the tree: the first is 1, those below number k are 2k and 2k + 1."""


class TooSmall(Exception):
    """Boxes are as small as they may get."""


class Middle(NamedTuple):
    """A curve at the centres of boxes.

    ``centre`` is the verifier's; ``h`` and ``e``, shape (box, segment), are durations and by how
    much their logarithms differ in a box; ``pieces`` and ``moved`` are those of `NearLimits`.
    """

    centre: Any
    h: Array
    e: Array
    pieces: Array
    moved: Array


class Curves(ABC):
    """What a kind of proof says of its boxes, by the arithmetic of its verifier.

    Parameters
    ----------
    kind : Boxes
        Of `trajgap.verify`, for the total to be proved and without rows.
    near : NearLimits
    """

    widest: ClassVar[float]
    """Width of a logarithm from which on a box is cut without a look at its limits."""
    evenly: ClassVar[bool] = False
    """Whether the widest side is cut where limits exclude a box but for what a series leaves."""
    part = 500
    """Boxes of a part: a tenth of a second, beside which handing it out costs nothing."""

    def __init__(self, kind: Any, near: NearLimits) -> None:
        self.kind, self.near = kind, near

    @abstractmethod
    def middle(self, sides: Array) -> Middle:
        """At the centres of boxes (box, least or largest, segment)."""

    @abstractmethod
    def proved(
        self, middle: Middle, rows: NDArray[np.int64], weights: Array, tau: Array
    ) -> tuple[NDArray[np.bool_], Array, Array, Array]:
        """Which boxes are excluded by rows of weights and τ; both as integers; and what to cut.

        The last array, shape (box, segment), is large where a side is to blame for what was lost.
        """

    def pick(self, centre: Any, which: NDArray[np.int64]) -> Any:
        """The verifier's curves at the centres of some of the boxes."""
        return centre.pick(which)

    def without_limits(self, low: Array, high: Array) -> list[Leaf | None]:
        """What excludes boxes whatever the curve."""
        return [None] * len(low)


@dataclass
class Found:
    """A tree of boxes by their numbers: across which segment one is cut, or what excludes it."""

    cuts: dict[int, int] = field(default_factory=dict)
    leaves: dict[int, Leaf] = field(default_factory=dict)

    @property
    def boxes(self) -> int:
        """How many were visited."""
        return len(self.cuts) + len(self.leaves)

    def document(self) -> dict[str, list[Any]]:
        """Rows, tree and, if there are any, windows.

        What is used most stands first in its table, so its number is short.
        """
        preorder = list(self._preorder())
        used = [self.leaves[node] for node in preorder if node in self.leaves]
        windows = _places(leaf[0] for leaf in used if len(leaf) == 3)
        rows = _places(row for leaf in used if len(leaf) < 3 for row in _rows(leaf))
        tree: list[Any] = []
        for node in preorder:
            if node in self.cuts:
                tree.append(self.cuts[node])
                continue
            leaf = self.leaves[node]
            if len(leaf) == 3:
                own = [windows[leaf[0]], repr(leaf[1]) if leaf[1] else "0"]
            elif len(leaf) == 2:
                own = [leaf[0], *(x for row, weight in leaf[1] for x in (rows[row], weight))]
            else:
                own = [rows[row] for row in leaf]
            tree.append([LEAF, *own])
        return {"windows": list(windows), "rows": [list(row) for row in rows], "tree": tree}

    def _preorder(self) -> Iterator[int]:
        waiting = [1]
        while waiting:
            node = waiting.pop()
            yield node
            if node in self.cuts:
                waiting += [2 * node + 1, 2 * node]


def _rows(leaf: Leaf) -> Iterable[Any]:
    return (row for row, _ in leaf[1]) if len(leaf) == 2 else leaf


def _places(used: Iterable[Any]) -> dict[Any, int]:
    """Where each entry stands in a table: by how often it is used, then by when first."""
    return {entry: k for k, (entry, _) in enumerate(Counter(used).most_common())}


@dataclass(frozen=True, eq=False)
class Part:
    """What was done below a bundle, the boxes that are left, and directions that may be shorter."""

    found: Found
    rest: list[Cell]
    directions: list[Array]


def search_part(curves: Curves, cells: list[Cell]) -> Part:
    """Exclude and cut boxes until none is left, a part's boxes are visited or time is up.

    Returns
    -------
    Part
        But for the clock, a function of its arguments alone.

    Raises
    ------
    TooSmall
    """
    kind, found, waiting = curves.kind, Found(), list(cells)
    directions: list[Array] = []
    while waiting and found.boxes < curves.part:
        batch, waiting = waiting[-kind.batch :], waiting[: -kind.batch]
        full = []
        for node, box in batch:
            if any(a > b for a, b in zip(*box, strict=True)):
                found.leaves[node] = ()
            else:
                full.append((node, box))
        if full:
            if max(full)[0].bit_length() > MOST_DEPTH:  # beside 0 no logarithm says so
                raise TooSmall
            with np.errstate(all="ignore"):
                sides = np.array([box for _, box in full])
                leaves, axes, shorter = _judged(curves, sides)
            directions.append(shorter)
            for (node, box), leaf, axis in zip(full, leaves, axes, strict=True):
                if leaf is not None:
                    found.leaves[node] = leaf
                    continue
                found.cuts[node] = axis
                parts = kind.cut(box, axis, None)
                waiting += [(2 * node, parts[0]), (2 * node + 1, parts[1])]
        if time_up():
            break
    return Part(found, waiting, directions)


def _judged(curves: Curves, sides: Array) -> tuple[list[Leaf | None], list[int], Array]:
    """What excludes each box, or None and the segment across which it is to be cut.

    Also the directions among them whose totals seem to be shortest.
    """
    low, high = sides[:, 0], sides[:, 1]
    width = np.log(high / np.maximum(low, 1e-6 * high))
    if (width.max(axis=1) < _NARROW).any():
        raise TooSmall
    leaves, axes = curves.without_limits(low, high), width.argmax(axis=1)
    open_ = np.array([leaf is None for leaf in leaves])
    where = np.flatnonzero(open_ & (width.max(axis=1) < curves.widest))
    if not where.size:
        return leaves, axes.tolist(), low[:0]
    middle = curves.middle(sides[where])
    own = curves.near.candidates(middle.h, middle.pieces, middle.moved)
    total = curves.kind.most
    change = np.abs(own.slopes) * middle.e[:, None, :]
    most, weights, tau = best_weights(
        np.where(np.isfinite(own.values), own.values, -1e3),
        own.slopes * middle.e[:, None, :],
        middle.h.sum(axis=1) / total - 1.0,
        middle.h * middle.e / total,
        curves.kind.stretches,
    )
    top = np.where(np.isfinite(own.values), np.maximum(0.0, 1.0 + own.values), 0.0)
    lean = (weights[:, :, None] * change).sum(axis=1) + (top[:, :, None] * change).max(axis=1)
    blame = np.ones_like(lean)
    for at, leaf in _excluded(curves, middle, own, most, weights, tau, blame):
        leaves[where[at]] = leaf
    if curves.evenly:
        lean[most > 0.0] = 1.0
    axes[where] = (width[where] * (lean + 0.1) * blame).argmax(axis=1)
    return leaves, axes.tolist(), _shortest(middle.h, own, most)


def _shortest(h: Array, own: Candidates, most: Array) -> Array:
    """Directions of least totals, stretched until limits are kept at the places looked at."""
    order = own.rows[..., 2]
    # A stretch repairs every limit but those of positions.
    fit = (most <= 0.0) & (np.where(order == 0, own.values, -np.inf).max(axis=1) <= 0.0)
    stretch = np.maximum(1.0 + own.values, 0.0) ** (1.0 / np.maximum(order, 1))
    totals = np.where(fit, h.sum(axis=1) * stretch.max(axis=1), np.inf)
    best = totals.argsort()[:_LOOKS]
    return np.asarray(h[best[np.isfinite(totals[best])]])


def _excluded(
    curves: Curves,
    middle: Middle,
    own: Candidates,
    most: Array,
    weights: Array,
    tau: Array,
    blame: Array,
) -> Iterator[tuple[int, Leaf]]:
    """Boxes that the verifier's bound excludes, each with its leaf; of others what is to blame."""
    good = np.flatnonzero(most > 0.0)
    if not good.size:
        return
    # Rows without weight take no part: the heaviest stand first, and the rest is cut off.
    order = np.argsort(-weights[good], axis=1, kind="stable")
    order = order[:, : 1 + int((weights[good] > 0.0).sum(axis=1).max())]
    rows = np.take_along_axis(own.rows[good], order[:, :, None], axis=1)
    share = np.take_along_axis(weights[good], order, axis=1)
    picked = Middle(curves.pick(middle.centre, good), *(x[good] for x in middle[1:]))
    excluded, taus, shares, blame[good] = curves.proved(picked, rows, share, tau[good])
    for at in np.flatnonzero(excluded):
        pairs = [
            (tuple(row), int(weight))
            for row, weight in zip(rows[at].tolist(), shares[at], strict=True)
            if weight > 0.0
        ]
        yield int(good[at]), (int(taus[at]), pairs)


class BoxSearch(Branching[list[Cell]]):
    """Search below boxes, part by part.

    Parameters
    ----------
    curves : Curves
    look : callable
        Called with directions that may hold a shorter answer; may raise.
    watch : callable
        Called with the boxes that wait and those done.

    Attributes
    ----------
    least : int
        Boxes that are worked on together, if there are as many: with fewer, calls cost more than
        what they compute.
    """

    ahead, least = 8, 256
    work = staticmethod(search_part)

    def __init__(
        self,
        curves: Curves,
        look: Callable[[Array], None],
        watch: Callable[[int, int], None],
    ) -> None:
        self.common, self._look, self._watch = Common(curves), look, watch
        self.found, self._left, self._begun, self._away = Found(), 1, 0, 1
        self._rest: list[Cell] = []

    def order(self, box: list[Cell]) -> int:
        """The last ones first: few wait."""
        self._begun -= 1
        return self._begun

    def wanted(self, box: list[Cell]) -> bool:
        """Every box is."""
        return True

    def given(self, box: list[Cell]) -> tuple[list[Cell]]:
        """The boxes."""
        return (box,)

    def taken(self, box: list[Cell], found: Part) -> Iterator[list[Cell]]:
        """What is left of a part, once its directions were looked at."""
        self._left += len(found.rest) - len(box)
        self.found.cuts.update(found.found.cuts)
        self.found.leaves.update(found.found.leaves)
        if found.directions:
            self._look(np.concatenate(found.directions))
        self._rest += found.rest
        self._away -= 1
        while len(self._rest) >= self.least or (self._rest and not self._away):
            self._away += 1
            yield self._rest[-self.least :]
            del self._rest[-self.least :]

    def look(self, waiting: int) -> None:
        """Report."""
        self._watch(self._left, self.found.boxes)
