"""The tree of a quintic proof as one text: a letter for a cut, some numbers for a leaf."""

from __future__ import annotations

import re
from typing import Any

from .ranges import MOST_NODES, USUAL_WEIGHT
from .reading import Clock, need
from .tree import LEAF

_CUTS = "abcdefghijklmnopqrstuvwxyz"
"""A letter for each of the segments that a proof may have."""
_TOKEN = re.compile(
    r"([a-z])"
    r"|#(\d{1,16})(?:\(([^()]{1,300})\))?"
    r"|\.(?:(-?\d{1,16})((?: \d{1,16}(?::\d{1,16})?)+))?",
    re.ASCII,
)
"""A cut; a leaf with a window, and τ where it is not 0; a leaf with τ and rows, each with its
weight unless that is the usual one; or a leaf that is empty. 16 digits hold all integers that may
stand there; τ of a window is any number."""


def read_tree(words: str, clock: Clock) -> list[Any]:
    """The nodes in the grammar that all kinds of proof share.

    Parameters
    ----------
    words : str
    clock : Clock

    Returns
    -------
    list

    Raises
    ------
    Refused
        At the first character that belongs to no node.
    """
    nodes: list[Any] = []
    end = 0
    for found in clock.each(_TOKEN.finditer(words)):
        need(found.start() == end, f"malformed: the tree at character {end}")
        need(len(nodes) < MOST_NODES, "the tree has too many nodes")
        end = found.end()
        cut, window, tau, weighted, rows = found.groups()
        if cut is not None:
            nodes.append(_CUTS.index(cut))
        elif window is not None:
            nodes.append([LEAF, int(window), "0" if tau is None else tau])
        elif weighted is not None:
            leaf = [LEAF, int(weighted)]
            for row, _, weight in (one.partition(":") for one in rows.split()):
                leaf += [int(row), int(weight) if weight else USUAL_WEIGHT]
            nodes.append(leaf)
        else:
            nodes.append([LEAF])
    need(end == len(words), f"malformed: the tree at character {end}")
    return nodes
