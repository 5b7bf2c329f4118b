"""The tree of a quintic proof: arrays that the search writes, and their JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....verify import LEAF, WINDOW_UNIT
from .search import EMPTY, WINDOW
from .windows import Windows

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Leaves:
    """Letters in preorder and, leaf by leaf, what excludes it; the last array counts all three.

    Letter 0 is a leaf, k + 1 a cut of duration k.
    """

    tree: NDArray[np.int8]
    kinds: NDArray[np.int8]
    starts: NDArray[np.int64]
    ids: NDArray[np.int16]
    share: NDArray[np.float64]
    tau: NDArray[np.float64]
    sizes: NDArray[np.int64]

    @classmethod
    def empty(cls, room: tuple[int, int, int] = (1 << 12, 1 << 12, 1 << 13)) -> Leaves:
        """Arrays with room for letters, leaves and rows: 0.3 MB, and doubled when full."""
        letters, leaves, rows = room
        return cls(
            np.zeros(letters, np.int8),
            np.zeros(leaves, np.int8),
            np.zeros(leaves + 1, np.int64),
            np.zeros((rows, 5), np.int16),
            np.zeros(rows),
            np.zeros(leaves),
            np.zeros(3, np.int64),
        )

    @classmethod
    def of_nothing(cls) -> Leaves:
        """The tree of a single box that is empty."""
        one = cls.empty((1, 1, 0))
        one.kinds[0] = EMPTY
        one.sizes[:2] = 1
        return one

    @property
    def arrays(self) -> tuple[NDArray[Any], ...]:
        """In the order of `search`."""
        return self.tree, self.kinds, self.starts, self.ids, self.share, self.tau, self.sizes

    def larger(self) -> Leaves:
        """The same with twice the room."""

        def grown(part: NDArray[Any]) -> NDArray[Any]:
            return np.concatenate([part, np.zeros_like(part)])

        *parts, sizes = self.arrays
        tree, kinds, starts, ids, share, tau = map(grown, parts)
        return Leaves(tree, kinds, starts, ids, share, tau, sizes)

    def trimmed(self) -> Leaves:
        """The same without room for more."""
        letters, leaves, rows = self.sizes.tolist()
        return Leaves(
            self.tree[:letters].copy(),
            self.kinds[:leaves].copy(),
            self.starts[: leaves + 1].copy(),
            self.ids[:rows].copy(),
            self.share[:rows].copy(),
            self.tau[:leaves].copy(),
            self.sizes,
        )

    @classmethod
    def joined(cls, parts: list[Leaves]) -> Leaves:
        """Parts of one tree, given in preorder and trimmed, as one."""
        before = np.cumsum([0, *(part.sizes[2] for part in parts)])
        starts = [part.starts[:-1] + b for part, b in zip(parts, before[:-1], strict=True)]
        return cls(
            np.concatenate([part.tree for part in parts]),
            np.concatenate([part.kinds for part in parts]),
            np.concatenate([*starts, before[-1:]]),
            np.concatenate([part.ids for part in parts]),
            np.concatenate([part.share for part in parts]),
            np.concatenate([part.tau for part in parts]),
            np.sum([part.sizes for part in parts], axis=0),
        )

    def document(self, windows: Windows) -> dict[str, Any]:
        """Tables of windows and rows that are used, and the tree.

        What is used most stands first in its table, so that its number is short.
        """
        leaves = int(self.sizes[1])
        ids, share = list(map(tuple, self.ids.tolist())), self.share.tolist()
        parts = list(pairwise(self.starts[: leaves + 1].tolist()))
        kinds = self.kinds[:leaves].tolist()
        of_windows = _places(
            ids[a][0] for (a, _), kind in zip(parts, kinds, strict=True) if kind == WINDOW
        )
        of_rows = _places(
            row
            for (a, b), kind in zip(parts, kinds, strict=True)
            if kind not in (WINDOW, EMPTY)
            for row in ids[a:b]
        )
        found: list[list[Any]] = []
        for (a, b), kind, tau in zip(parts, kinds, self.tau.tolist(), strict=True):
            leaf: list[Any] = [LEAF]
            if kind == WINDOW:
                leaf += [of_windows[ids[a][0]], repr(tau) if tau else "0"]
            elif kind != EMPTY:
                leaf.append(int(tau))
                for row, weight in zip(ids[a:b], share[a:b], strict=True):
                    leaf += [of_rows[row], int(weight)]
            found.append(leaf)
        leaf_by_leaf = iter(found)
        letters = self.tree[: int(self.sizes[0])].tolist()
        return {
            "windows": [
                [
                    int(windows.joint[w]),
                    *(int(x) for x in windows.psi[w] * WINDOW_UNIT),
                    *(int(x) for x in windows.weights[w] * WINDOW_UNIT),
                ]
                for w in of_windows
            ],
            "rows": [list(row) for row in of_rows],
            "tree": [k - 1 if k else next(leaf_by_leaf) for k in letters],
        }


def _places(used: Iterable[T]) -> dict[T, int]:
    """Where each entry stands in a table: by how often it is used, then by when first."""
    return {entry: k for k, (entry, _) in enumerate(Counter(used).most_common())}
