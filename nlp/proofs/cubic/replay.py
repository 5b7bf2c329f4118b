"""Reads the tree of a stopped run for C2 cubic splines, proving every step again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ....problem import TrajgapError
from ....verify import CUT, LEAF, MIX_DIGITS, MOST_INTEGER, MOST_POWER, OPEN
from ..exact import ExactProblem
from .proof import MIX, TOTAL, Target, Weights, multiplied
from .system import CubicRow, CubicSystem, kind_of_ends, scaled
from .tree import BoxStep, Prover, TickBox

_LARGEST = 2**26
"""Of the integer weights in a state: up to there `proof.lagrangian` adds them up exactly."""


def replayed(
    exact: ExactProblem, document: dict[str, Any], clock: Callable[[], None]
) -> tuple[Prover, TickBox, int]:
    """The tree of a document, with what it proves in ticks.

    Parameters
    ----------
    exact : ExactProblem
    document : dict
        As `cubic_tree.proof_document` writes it; nothing in it is trusted.
    clock : callable
        Called before every step; ends the replay by raising.

    Returns
    -------
    prover : Prover
    root : TickBox
    lower : int

    Raises
    ------
    TrajgapError
        If a step is not proved.
    """
    ends = kind_of_ends(exact)
    _need(document["kind"] == "cubic" and ends is not None, "another kind of curve")
    assert ends is not None
    powers = [_whole(p, MOST_POWER) for p in document["powers"]]
    _need(len(powers) == len(exact.joints), "powers")
    system = scaled(exact, ends, powers, _whole(document["second"], MOST_POWER))
    cap = _whole(document["cap"], MOST_INTEGER)
    _need(cap > 0, "cap")
    prover = Prover(system, cap)
    known = [_row(system, entry) for entry in document["rows"]]
    root = prover.root()
    stack = [root]
    for node in document["tree"]:
        clock()
        _need(bool(stack) and isinstance(node, list) and bool(node), "the tree")
        box, tag = stack.pop(), node[0]
        if box.closed:
            # Whatever was done to it once is not needed.
            stack += [box] * (2 if tag == CUT else 0 if tag in (LEAF, OPEN) else 1)
        elif tag == CUT:
            k, at = _whole(node[1], system.free - 1), _whole(node[2], MOST_INTEGER)
            _need(k >= 0, "a split of a side that is not there")
            stack += reversed(prover.split(box, k, at))
        elif tag == "r":
            prover.narrow(box)
            stack.append(box)
        elif tag == LEAF and len(node) > 1:
            _again(prover, box, node, known)
        elif tag not in (LEAF, OPEN):
            _again(prover, box, node, known)
            stack.append(box)
    _need(not stack, "the tree leaves a part open")
    return prover, root, min((box.floor for box in root.leaves()), default=cap)


def _again(prover: Prover, box: TickBox, step: list[Any], known: list[CubicRow]) -> None:
    kind, (held, equations, mix) = step[0], step[-3:]
    scale = 0 if kind == LEAF else _whole(step[-4], _LARGEST)
    _need(scale > 0 or kind == LEAF, "weight of the target")
    weights = _weights(prover.system, scale, held, equations, mix, known)
    if kind == LEAF:
        _need(prover.clear(box, weights), "a box is not empty")
    elif kind == "f":
        value = _whole(step[1], MOST_INTEGER)
        bound = prover.bound(box, TOTAL, weights)
        _need(bound is not None and bound >= value, "a floor is not proved")
        box.steps.append(BoxStep("f", value=value, weights=weights))
        box.floor = max(box.floor, value)
        prover.trim(box)
    else:
        _need(kind == "t", "an unknown step")
        k, sign, value = (
            _whole(step[1], prover.system.free - 1),
            step[2],
            _whole(step[3], MOST_INTEGER),
        )
        _need(k >= 0 and sign in (1, -1), "a side that is not there")
        bound = prover.bound(box, Target(k, sign), weights)
        _need(bound is not None and bound >= sign * value, "a side is not proved")
        prover.set(box, BoxStep("t", k, sign, value, weights))


def _need(condition: bool, reason: str) -> None:
    if not condition:
        raise TrajgapError(f"resume: {reason}")


def _whole(value: Any, most: int) -> int:
    _need(type(value) is int and abs(value) <= most, f"no integer up to {most}: {value!r}")
    return int(value)


def _row(system: CubicSystem, entry: list[Any]) -> CubicRow:
    row = CubicRow(*entry)
    _need(row.sign in (1, -1), "sign of a condition")
    if row.kind in ("jerk", "velocity"):
        _need(0 <= row.joint < system.joints, "joint of a condition")
        order = 3 if row.kind == "jerk" else 1
        _need(system.limits[row.joint][order - 1] is not None, "a limit that is not there")
    else:
        _need(row.joint == -1, "joint of a condition")
    count = system.spans if row.kind == "velocity" else system.pieces
    _need(type(row.index) is int and 0 <= row.index < count, "place of a condition")
    _need(row.kind in ("jerk", "velocity", "lower", "upper", "total"), "kind of a condition")
    _need(row.kind != "upper" or system.longest[row.index] is not None, "a bound that is not there")
    _need(type(row.place) is int and 0 <= row.place <= 64, "place of a condition")
    return row


def _weights(
    system: CubicSystem,
    scale: int,
    held: list[Any],
    equations: list[Any],
    mix: str,
    known: list[CubicRow],
) -> Weights:
    rows = {known[_index(k, known)]: _whole(w, _LARGEST) for k, w in _pairs(held)}
    _need(all(w >= 0 for w in rows.values()), "a negative weight")
    size = system.unknowns
    found = {}
    for k, w in _pairs(equations):
        number = _whole(k, size * system.joints - 1)
        _need(number >= 0, "an equation that is not there")
        found[number // size, number % size] = _whole(w, _LARGEST)
    shape = (system.joints, system.coordinates, size)
    weights = Weights(scale, rows, found, np.full(shape, MIX // 2))
    which = multiplied(system, weights)
    _need(len(mix) == int(which.sum()), "shares of the products")
    weights.mix[which] = [MIX_DIGITS.index(letter) for letter in mix]
    return weights


def _pairs(flat: list[Any]) -> list[tuple[Any, Any]]:
    _need(len(flat) % 2 == 0, "weights in pairs")
    return list(zip(flat[::2], flat[1::2], strict=True))


def _index(k: Any, known: list[CubicRow]) -> int:
    number = _whole(k, len(known) - 1)
    _need(number >= 0, "a condition that is not there")
    return number
