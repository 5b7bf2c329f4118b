"""The boxes of a search as the proof in a certificate, and back from it to go on."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from ....verify import CUT, LEAF, number
from ..driver import regrow
from ..exact import decimal
from ..outcome import WrittenProof
from .search import Node, Search
from .tangents import KINDS

DIGITS = (4, 6, 8, 12)
"""Of the weights: as few as prove the bound."""


def free_bound(search: Search, root: Node, total: Fraction) -> WrittenProof:
    """Write down what the boxes of a search prove.

    It is kind "any-curve" of docs/explanation/certificates-any-curve.md.

    Parameters
    ----------
    search : Search
    root : Node
    total : Fraction
        At most what every leaf proves with all digits, s.
    """
    known: dict[tuple[int | str, ...], int] = {}
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
            leaf += [known.setdefault(tuple(row), len(known)), weight]
        tree.append(leaf)
    return WrittenProof(
        {
            "kind": "any-curve",
            "total": decimal(total),
            "cap": decimal(search.cap),
            "rows": [list(row) for row in known],
            "tree": tree,
        }
    )


def regrown(search: Search, document: dict[str, Any], target: float) -> Node:
    """The boxes of a stopped run, bounded anew; of its rows only the parameters are used.

    Under a lower cap the sides of the boxes end earlier: a part beyond them is left out.
    """
    rows = np.array([_row(search, row) for row in document["rows"]], dtype=np.int64).reshape(-1, 7)
    fallen = search.cap < number(document["cap"])
    beyond = search.beyond
    divided: list[Node] = []

    def cut(node: Node, segment: int, place: str) -> tuple[Node, ...]:
        if node is beyond:
            return beyond, beyond
        if fallen and number(place) >= node.box[segment][1]:
            return node, beyond
        divided.append(node)
        return search.halves(node, segment, number(place), -np.inf)

    def leaf(node: Node, data: list[Any]) -> None:
        if node is not beyond:
            used = rows[[int(n) for n in data[::2]]]
            node.carried = np.unique(np.concatenate([node.carried, used]), axis=0)

    def step(node: Node, tag: str, data: list[Any]) -> None:
        raise ValueError(f"a step {tag}")

    durations = np.ones(len(search.asked.steps))
    speeds = np.zeros((len(durations) + 1, len(search.asked.joints)))
    root = search.root(durations, speeds, -np.inf)
    regrow(document["tree"], root, cut, step, leaf)

    def bounded(node: Node) -> Node:
        open_leaf = node.box and not node.parts
        return search.node(node.box, node.carried, target, None) if open_leaf else node

    for node in divided:
        node.parts = tuple(map(bounded, node.parts))
    return bounded(root)


def _row(search: Search, row: Any) -> list[int]:
    """A row in floats' terms: only what fits the problem is taken up."""
    own = search.kind.row(row)
    joint = search.asked.joints.index(own.joint)
    if search.asked.acceleration[joint] is None:
        raise ValueError("a row does not fit the problem")
    if own.kind != "change" and own.sign * search.asked.steps[own.span][joint] < 0:
        raise ValueError("a row does not fit the problem")
    return [KINDS.index(own.kind), own.span, joint, own.sign, own.m0, own.m1, own.n]
