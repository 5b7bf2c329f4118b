"""The bisection tree of a proof as JSON, and back again with every box proved anew."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ....problem import TrajgapError
from ...verify_problem import number
from ..exact import ExactProblem, decimal
from .boxes import Boxes, Proof
from .rows import PLACES, TOTAL, Prover, Row, shape_for

_DEEPEST = 60


@dataclass(frozen=True, eq=False)
class State:
    """Boxes that together cover the unit square of directions, with proofs for ``target``.

    A box without a proof is open.
    """

    target: Fraction
    boxes: Boxes
    proofs: tuple[Proof | None, ...]


def tree_document(state: State) -> dict[str, Any]:
    """Total, rows, tree and leaves as docs/certificates.md describes them; null: an open leaf."""
    tree, order = _tree(state)
    rows: dict[Row, int] = {}
    leaves: list[list[int | str] | None] = []
    for n in order:
        proof = state.proofs[n]
        if proof is None:
            leaves.append(None)
            continue
        leaf: list[int | str] = []
        for row, weight in zip(*proof, strict=True):
            leaf += [rows.setdefault(row, len(rows)), _weight(weight)]
        leaves.append(leaf)
    return {
        "total": decimal(state.target),
        "rows": [[r.kind, r.joint, r.order, r.sign, r.place, r.cap] for r in rows],
        "tree": tree,
        "leaves": leaves,
    }


def tree_state(problem: ExactProblem, document: dict[str, Any], proof: bool) -> State:
    """Read a tree of unknown origin.

    Parameters
    ----------
    problem : ExactProblem
    document : dict
        From `tree_document`.
    proof : bool
        Whether every box must be proved, which is checked; otherwise its proofs are proposals.

    Returns
    -------
    State

    Raises
    ------
    TrajgapError
        If it is malformed or does not prove its total.
    """
    target = number(document["total"])
    rows = [_row(problem, entry) for entry in document["rows"]]
    boxes = _boxes(str(document["tree"]))
    leaves = document["leaves"]
    if len(leaves) != len(boxes) or not target >= 0:
        raise TrajgapError("resume: leaves and tree differ in number, or the total is negative")
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
    if proof:
        prover = Prover(problem, target)
        for n, found in enumerate(proofs):
            if found is None or not prover.proves(*found, *boxes.sides(n)):
                raise TrajgapError(f"resume: the state does not prove its lower bound (box {n})")
    return State(target, boxes, tuple(proofs))


def _whole(value: Any, low: int, high: int) -> int:
    if type(value) is not int or not low <= value <= high:
        raise TrajgapError(f"resume: no integer in {low}..{high}: {value!r}")
    return value


def _row(problem: ExactProblem, entry: Any) -> Row:
    kind, joint, order, sign, place, cap = entry
    shape = shape_for(problem)
    places = [piece.kind for piece in shape.pieces]
    joints = 3 if kind == "lower" else len(problem.joints)
    row = Row(
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
        limit = problem.limits[row.joint][row.order - 1]
        there = limit is not None and limit.high > 0
    known = (kind == "lower" or kind in shape.kinds) and sign != 0
    if not (known and there and held and (kind != "mean" or order == 1)):
        raise TrajgapError(f"resume: no such row for this problem: {entry!r}")
    return row


def _boxes(tree: str) -> Boxes:
    stack, found = [((0, 0), (0, 0))], []
    for letter in tree:
        if not stack:
            raise TrajgapError("resume: the tree has too many letters")
        level, index = stack.pop()
        if letter == ".":
            found.append((level, index))
            continue
        axis = "ab".index(letter)
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
    return Boxes(level_array, np.array([index for _, index in found], np.int64).reshape(-1, 2))


def _weight(weight: Fraction) -> str:
    text = decimal(weight)
    short = f"{float(weight):.4g}"
    return short if len(short) < len(text) and Fraction(short) == weight else text


def _tree(state: State) -> tuple[str, list[int]]:
    """Bisection tree in preorder, and the leaves in its order."""
    letters: list[str] = []
    order: list[int] = []
    boxes = [(*state.boxes.level[n], *state.boxes.index[n]) for n in range(len(state.boxes))]
    stack = [((0, 0), (0, 0), list(range(len(boxes))))]
    while stack:
        level, index, members = stack.pop()
        if len(members) == 1:
            letters.append(".")
            order.append(members[0])
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
        letters.append("ab"[axis])
    return "".join(letters), order
