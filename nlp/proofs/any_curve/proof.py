"""The boxes of a search as the proof in a certificate, and back from it to go on."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import TrajgapError
from ....verify import CUT, LEAF, number
from ..exact import decimal
from .rows import KINDS, ReachRow
from .search import Node, Search

KIND = "any-curve"
"""Of the proof, as `trajgap.verify` knows it."""
DIGITS = (4, 6, 8, 12)
"""Of the weights: as few as prove the bound."""


@dataclass(frozen=True)
class FreeBound:
    """Boxes of durations, each with rows and weights, as the proof of a certificate.

    Attributes
    ----------
    total, cap : Fraction
        The bound; all boxes lie below the cap, s.
    rows : tuple of list
    tree : tuple of list
        Nodes in preorder.
    """

    total: Fraction
    cap: Fraction
    rows: tuple[list[int | str], ...]
    tree: tuple[list[int | str], ...]

    def document(self) -> dict[str, Any]:
        """Kind "any-curve" of docs/explanation/certificates-any-curve.md."""
        return {
            "kind": KIND,
            "total": decimal(self.total),
            "cap": decimal(self.cap),
            "rows": [list(row) for row in self.rows],
            "tree": [list(node) for node in self.tree],
        }


def free_bound(search: Search, root: Node, total: Fraction) -> FreeBound:
    """Write down what the boxes of a search prove.

    Parameters
    ----------
    search : Search
    root : Node
    total : Fraction
        At most what every leaf proves with all digits, s.
    """
    known: dict[ReachRow, int] = {}
    tree: list[list[int | str]] = []
    stack = [root]
    while stack:
        node = stack.pop()
        stack += reversed(node.parts)
        if node.parts:
            tree.append([CUT, node.segment, decimal(node.at)])
            continue
        found = (search.exact(node, digits) for digits in DIGITS)
        weighted = next(texts for proved, texts in found if proved >= total)
        leaf: list[int | str] = [LEAF]
        for row, weight in weighted:
            leaf += [known.setdefault(row, len(known)), weight]
        tree.append(leaf)
    joints = search.asked.joints
    rows: tuple[list[int | str], ...] = tuple(
        [KINDS[r.kind], r.segment, joints[r.joint], *r[3:]] for r in known
    )
    return FreeBound(total, search.cap, rows, tuple(tree))


def restored(search: Search, document: dict[str, Any], target: float) -> Node:
    """The boxes of a stopped run, bounded anew; of its rows only the parameters are used.

    Under a lower cap the sides of the boxes end earlier: a part beyond them is left out.

    Raises
    ------
    TrajgapError
        If the document is malformed.
    """
    durations = np.ones(len(search.asked.steps))
    speeds = np.zeros((len(durations) + 1, len(search.asked.joints)))
    try:
        rows = np.array([_row(search, row) for row in document["rows"]], dtype=np.int64)
        root = search.root(durations, speeds, -np.inf)
        stack: list[Node | None] = [root]
        divided: list[Node] = []
        fallen = search.cap < number(document["cap"])
        for tag, *data in document["tree"]:
            node = stack.pop()
            if tag == CUT:
                k, at = int(data[0]), number(data[1])
                if not 0 <= k < len(durations):
                    raise ValueError("a cut of a segment that is not there")
                if node is None:
                    stack += [None, None]
                elif fallen and at >= node.box[k][1]:
                    stack += [None, node]
                else:
                    stack += reversed(search.halves(node, k, at, -np.inf))
                    divided.append(node)
                continue
            if node is None:
                continue
            used = rows.reshape(-1, 7)[[int(n) for n in data[::2]]]
            node.carried = np.unique(np.concatenate([node.carried, used]), axis=0)
        if stack:
            raise ValueError("the tree leaves a part open")
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, ZeroDivisionError) as error:
        raise TrajgapError(f"certify: the state cannot be resumed: {error}") from None

    def bounded(node: Node) -> Node:
        open_leaf = node.box and not node.parts
        return search.node(node.box, node.carried, target, None) if open_leaf else node

    for node in divided:
        node.parts = tuple(map(bounded, node.parts))
    return bounded(root)


def _row(search: Search, row: Any) -> ReachRow:
    kind, segment, joint, sign = KINDS.index(row[0]), int(row[1]), int(row[2]), int(row[3])
    numbers = [int(x) for x in row[4:]]
    own = search.asked.joints.index(joint)
    if sign not in (1, -1) or len(numbers) != 3 or segment < 0:
        raise ValueError("a row is malformed")
    if search.asked.loose[own][1] is None or sign * search.asked.steps[segment][own] < 0:
        raise ValueError("a row does not fit the problem")
    return ReachRow(kind, segment, own, sign, *numbers)
