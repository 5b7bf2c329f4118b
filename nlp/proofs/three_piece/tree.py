"""The bisection tree of a proof as JSON, and back again as proposals."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import TrajgapError
from ....verify import LEAF, OPEN, number
from ..exact import ExactProblem, decimal
from .boxes import Boxes, Proof
from .rows import PLACES, TOTAL, PieceRow, limit_of, shape_for

_DEEPEST = 60
"""Halvings of a side in a tree that is read: an index of 64 bits holds them."""


@dataclass(frozen=True, eq=False)
class Cover:
    """Boxes that together cover the unit square of directions, with proofs for ``target``.

    A box without a proof is open.
    """

    target: Fraction
    boxes: Boxes
    proofs: tuple[Proof | None, ...]


def tree_document(kind: str, state: Cover) -> dict[str, Any]:
    """Total, rows and tree as docs/explanation/certificates.md describes them."""
    rows: dict[PieceRow, int] = {}
    nodes: list[Any] = []
    for n in _preorder(state):
        if isinstance(n, str):
            nodes.append("ab".index(n))
            continue
        proof = state.proofs[n]
        if proof is None:
            nodes.append([OPEN])
            continue
        leaf: list[int | str] = [LEAF]
        for row, weight in zip(*proof, strict=True):
            leaf += [rows.setdefault(row, len(rows)), _weight(weight)]
        nodes.append(leaf)
    return {
        "kind": kind,
        "total": decimal(state.target),
        "rows": [[r.kind, r.joint, r.order, r.sign, r.place, r.cap] for r in rows],
        "tree": nodes,
    }


def proposed(problem: ExactProblem, document: dict[str, Any]) -> Cover:
    """Read a tree of unknown origin, whose proofs are proposals.

    Parameters
    ----------
    problem : ExactProblem
    document : dict
        From `tree_document`; leaves may be open.

    Returns
    -------
    Cover

    Raises
    ------
    TrajgapError
        If it is malformed.
    """
    target = number(document["total"])
    rows = [_row(problem, entry) for entry in document["rows"]]
    boxes, leaves = _boxes(document["tree"])
    if not target >= 0:
        raise TrajgapError("resume: the total is negative")
    proofs: list[Proof | None] = []
    for leaf in leaves:
        if leaf is None:
            proofs.append(None)
            continue
        which = tuple(rows[_whole(k, 0, len(rows) - 1)] for k in leaf[::2])
        weights = tuple(number(x) for x in leaf[1::2])
        if len(which) != len(weights) or not which:
            raise TrajgapError("resume: a leaf without weights")
        proofs.append((which, weights))
    return Cover(target, boxes, tuple(proofs))


def _whole(value: Any, low: int, high: int) -> int:
    if type(value) is not int or not low <= value <= high:
        raise TrajgapError(f"resume: no integer in {low}..{high}: {value!r}")
    return value


def _row(problem: ExactProblem, entry: Any) -> PieceRow:
    kind, joint, order, sign, place, cap = entry
    shape = shape_for(problem)
    places = [piece.kind for piece in shape.pieces]
    joints = 3 if kind == "lower" else len(problem.joints)
    row = PieceRow(
        str(kind),
        _whole(joint, 0, joints - 1),
        _whole(order, 0 if kind in places else 1, 3),
        _whole(sign, -1, 1),
        _whole(place, 0, PLACES),
        _whole(cap, TOTAL, 2),
    )
    held = cap == TOTAL or problem.duration_upper[row.cap] is not None
    if kind == "lower":
        there = True
    elif order == 0:
        side = problem.position_upper if sign > 0 else problem.position_lower
        there = side[row.joint] is not None
    else:
        limit = limit_of(problem, row)
        there = limit is not None and limit.high > 0
    known = (kind == "lower" or kind in shape.kinds) and sign != 0
    if not (known and there and held and (kind != "mean" or order == 1)):
        raise TrajgapError(f"resume: no such row for this problem: {entry!r}")
    return row


def _boxes(tree: list[Any]) -> tuple[Boxes, list[list[Any] | None]]:
    """Leaves of a tree in preorder; None stands for an open one."""
    stack, found, leaves = [((0, 0), (0, 0))], [], []
    for node in tree:
        if not stack:
            raise TrajgapError("resume: the tree has too many nodes")
        level, index = stack.pop()
        if isinstance(node, list):
            if node[:1] not in ([LEAF], [OPEN]):
                raise TrajgapError("resume: the tree has an unknown tag")
            found.append((level, index))
            leaves.append(node[1:] if node[0] == LEAF else None)
            continue
        axis = _whole(node, 0, 1)
        if level[axis] >= _DEEPEST:
            raise TrajgapError("resume: the tree is too deep")
        for side in (1, 0):
            depth, where = list(level), list(index)
            depth[axis] += 1
            where[axis] = 2 * index[axis] + side
            stack.append(((depth[0], depth[1]), (where[0], where[1])))
    if stack:
        raise TrajgapError("resume: the tree leaves a part of the square open")
    level_array = np.array([level for level, _ in found], np.int64).reshape(-1, 2)
    index_array = np.array([index for _, index in found], np.int64).reshape(-1, 2)
    return Boxes(level_array, index_array), leaves


def _weight(weight: Fraction) -> str:
    text = decimal(weight)
    short = f"{float(weight):.4g}"
    return short if len(short) < len(text) and Fraction(short) == weight else text


def _preorder(state: Cover) -> list[str | int]:
    """Bisection tree in preorder: the letter of a cut, or the number of a box."""
    nodes: list[str | int] = []
    boxes = [(*state.boxes.level[n], *state.boxes.index[n]) for n in range(len(state.boxes))]
    stack = [((0, 0), (0, 0), list(range(len(boxes))))]
    while stack:
        level, index, members = stack.pop()
        if len(members) == 1:
            nodes.append(members[0])
            continue
        axis = next(x for x in (0, 1) if all(boxes[n][x] > level[x] for n in members))
        halves: tuple[list[int], list[int]] = ([], [])
        deeper = level[axis] + 1
        for n in members:
            halves[(boxes[n][2 + axis] >> (boxes[n][axis] - deeper)) & 1].append(n)
        for side in (1, 0):
            where = list(index)
            where[axis] = 2 * index[axis] + side
            depth = (deeper, level[1]) if axis == 0 else (level[0], deeper)
            stack.append((depth, (where[0], where[1]), halves[side]))
        nodes.append("ab"[axis])
    return nodes
