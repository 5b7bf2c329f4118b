"""Branch and bound over boxes of durations, with the verifier's own arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ....problem import Array
from ....verify import LEAF
from .rows import NearLimits
from .simplex import best_weights

_WEIGHT = 2.0**12
"""Sum of the weights of a leaf, about: finer ones spare no box at 1e-8, 1 in 80 at 1e-9."""
_WIDEST = 1.2
"""Half-width of a logarithm from which on a box is cut without a look at its limits."""
_SAFE = 1e-12
"""Share of the weights by which a bound is positive, so that it is in other batches too."""
_NARROW = 1e-8
"""Width of a logarithm at which a box is as small as it may get: what second-order terms change in
it is below rounding."""

Box = tuple[list[float], list[float]]


class TooSmall(Exception):
    """Boxes are as small as they may get."""


@dataclass(eq=False)
class Found:
    """A tree of boxes: by node a cut and the first of both parts, or a leaf.

    A leaf has nothing, a row, or τ and rows with their weights.
    """

    cuts: dict[int, tuple[int, int]] = field(default_factory=dict)
    leaves: dict[int, tuple[Any, ...]] = field(default_factory=dict)

    def nodes(self) -> tuple[list[list[int]], list[Any]]:
        """Rows and tree of a document."""
        table: dict[tuple[int, ...], int] = {}
        tree: list[Any] = []
        waiting = [0]
        while waiting:
            node = waiting.pop()
            if node in self.cuts:
                coordinate, first = self.cuts[node]
                tree.append(coordinate)
                waiting += [first + 1, first]
                continue
            leaf: list[Any] = [LEAF]
            if len(self.leaves[node]) == 1:
                leaf.append(table.setdefault(self.leaves[node][0], len(table)))
            elif self.leaves[node]:
                tau, pairs = self.leaves[node]
                leaf.append(tau)
                for row, weight in pairs:
                    leaf += [table.setdefault(row, len(table)), weight]
            tree.append(leaf)
        return [list(row) for row in table], tree


def search(
    kind: Any,
    places: int,
    signed: bool,
    look: Callable[[Array], None],
    watch: Callable[[int, int], None],
) -> Found:
    """Exclude every box, or end by an exception of ``look`` or ``watch``.

    Parameters
    ----------
    kind : DeclaredCurve
        Of `trajgap.verify`, for the total to be proved and without rows.
    places : int
        Of a piece.
    signed : bool
        Whether τ may be negative.
    look : callable
        Called with the centres of boxes that may hold a shorter answer.
    watch : callable
        Called with the boxes left and those done.
    """
    limits = NearLimits(kind.task, places)
    found, waiting, made, done = Found(), [(0, kind.root())], 1, 0
    while waiting:
        batch, waiting = waiting[-kind.batch :], waiting[: -kind.batch]
        done += len(batch)
        full = []
        for node, box in batch:
            if any(a > b for a, b in zip(*box, strict=True)):
                found.leaves[node] = ()
            else:
                full.append((node, box))
        if full:
            sides = np.array([box for _, box in full])
            with np.errstate(all="ignore"):
                leaves, axes = _judged(kind, limits, sides, signed, look)
            for (node, box), leaf, axis in zip(full, leaves, axes, strict=True):
                if leaf is not None:
                    found.leaves[node] = leaf
                    continue
                found.cuts[node] = axis, made
                parts = kind.cut(box, axis, None)
                waiting += [(made, parts[0]), (made + 1, parts[1])]
                made += 2
        watch(len(waiting), done)
    return found


def _judged(
    kind: Any, limits: NearLimits, sides: Array, signed: bool, look: Callable[[Array], None]
) -> tuple[list[Any], list[int]]:
    """What excludes each box, or None and the segment across which it is to be cut."""
    low, high = sides[:, 0], sides[:, 1]
    width = np.log(high / low)
    if (width.max(axis=1) < _NARROW).any():
        raise TooSmall
    leaves: list[Any] = [None] * len(sides)
    axes = width.argmax(axis=1)
    narrow = width.max(axis=1) < 2.0 * _WIDEST
    if not narrow.any():
        return leaves, axes.tolist()
    centre = kind.centre(sides[narrow])
    own = limits.candidates(centre)
    e = centre.e
    most, weights, tau = best_weights(
        np.where(np.isfinite(own.values), own.values, -1e3),
        own.slopes * e[:, None, :],
        centre.h.sum(axis=1) / kind.task.total - 1.0,
        centre.h * e / kind.task.total,
        signed,
    )
    where = np.flatnonzero(narrow)
    change = np.abs(own.slopes) * e[:, None, :]
    top = np.where(np.isfinite(own.values), np.maximum(0.0, 1.0 + own.values), 0.0)
    lean = (weights[:, :, None] * change).sum(axis=1) + (top[:, :, None] * change).max(axis=1)
    axes[where] = (width[where] * (lean + 0.1)).argmax(axis=1)
    good = (most > 0.0) & centre.held
    # A stretch repairs every limit but those of positions.
    inside = np.where(own.rows[..., 2] == 0, own.values, -np.inf).max(axis=1) <= 0.0
    look(centre.h[(most <= 0.0) & inside])
    if not good.any():
        return leaves, axes.tolist()
    share, whole_tau = np.rint(weights[good] * _WEIGHT), np.rint(tau[good] * _WEIGHT)
    # Rows without weight take no part: the heaviest stand first, and the rest is cut off.
    order = np.argsort(-share, axis=1, kind="stable")[:, : 1 + int((share > 0.0).sum(axis=1).max())]
    share = np.take_along_axis(share, order, axis=1)
    rows = np.take_along_axis(own.rows[good], order[:, :, None], axis=1)
    bound = centre.pick(good).least(whole_tau, rows, share, float(limits.places))
    for at in np.flatnonzero(bound > _SAFE * _WEIGHT):
        pairs = [
            (tuple(row), int(weight))
            for row, weight in zip(rows[at].tolist(), share[at], strict=True)
            if weight > 0.0
        ]
        leaves[where[np.flatnonzero(good)[at]]] = (int(whole_tau[at]), pairs)
    return leaves, axes.tolist()
