"""The boxes of a search as the proof in a certificate, and back from it to go on."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import TrajgapError
from ...verify_problem import number
from ..exact import decimal
from .rows import KINDS, Row
from .search import Node, Search

KIND = "family-free"
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
    tree, leaves : tuple of list
    speeds : tuple of tuple of Fraction, or None
        Of the answer, [way-point][joint].
    """

    total: Fraction
    cap: Fraction
    rows: tuple[list[int | str], ...]
    tree: tuple[list[int | str] | int, ...]
    leaves: tuple[list[int | str], ...]
    speeds: tuple[tuple[Fraction, ...], ...] | None

    def document(self) -> dict[str, Any]:
        """Kind "family-free" of docs/certificates-family-free.md."""
        shown = self.speeds
        return {
            "kind": KIND,
            "total": decimal(self.total),
            "cap": decimal(self.cap),
            "rows": [list(row) for row in self.rows],
            "tree": [entry if isinstance(entry, int) else list(entry) for entry in self.tree],
            "leaves": [list(leaf) for leaf in self.leaves],
            "speeds": None if shown is None else [[decimal(v) for v in row] for row in shown],
        }


def free_bound(
    search: Search,
    root: Node,
    total: Fraction,
    speeds: tuple[tuple[Fraction, ...], ...] | None,
) -> FreeBound:
    """Write down what the boxes of a search prove.

    Parameters
    ----------
    search : Search
    root : Node
    total : Fraction
        At most what every leaf proves with all digits, s.
    speeds : tuple of tuple of Fraction, or None
        Of the answer.
    """
    known: dict[Row, int] = {}
    leaves: list[list[int | str]] = []
    for node in root.leaves:
        found = (search.exact(node, digits) for digits in DIGITS)
        weighted = next(texts for proved, texts in found if proved >= total)
        pairs = [(known.setdefault(row, len(known)), weight) for row, weight in weighted]
        leaves.append([entry for pair in pairs for entry in pair])
    joints = search.asked.joints
    rows: tuple[list[int | str], ...] = tuple(
        [KINDS[r.kind], r.segment, joints[r.joint], *r[3:]] for r in known
    )
    tree: list[list[int | str] | int] = []
    stack = [root]
    while stack:
        node = stack.pop()
        tree.append([node.segment, decimal(node.at)] if node.parts else 0)
        stack += reversed(node.parts)
    return FreeBound(total, search.cap, rows, tuple(tree), tuple(leaves), speeds)


def restored(search: Search, document: dict[str, Any], target: float) -> Node:
    """The boxes of a stopped run, bounded anew; of its rows only the parameters are used.

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
        stack = [root]
        for entry in document["tree"]:
            node = stack.pop()
            if entry != 0:
                cut = (int(entry[0]), number(entry[1]))
                stack += reversed(search.halves(node, *cut, -np.inf))
        leaves = root.leaves
        for leaf, own in zip(leaves, document["leaves"], strict=True):
            used = rows.reshape(-1, 7)[[int(n) for n in own[::2]]]
            leaf.carried = np.unique(np.concatenate([leaf.carried, used]), axis=0)
        if stack:
            raise ValueError("the tree leaves a part open")
    except (KeyError, IndexError, TypeError, ValueError, OverflowError, ZeroDivisionError) as error:
        raise TrajgapError(f"certify: the state cannot be resumed: {error}") from None
    for leaf in leaves:
        if leaf.box:
            vars(leaf).update(vars(search.node(leaf.box, leaf.carried, target, None)))
    return root


def _row(search: Search, row: Any) -> Row:
    kind, segment, joint, sign = KINDS.index(row[0]), int(row[1]), int(row[2]), int(row[3])
    numbers = [int(x) for x in row[4:]]
    own = search.asked.joints.index(joint)
    if sign not in (1, -1) or len(numbers) != 3 or segment < 0:
        raise ValueError("a row is malformed")
    if search.asked.loose[own][1] is None or sign * search.asked.steps[segment][own] < 0:
        raise ValueError("a row does not fit the problem")
    return Row(kind, segment, own, sign, *numbers)
