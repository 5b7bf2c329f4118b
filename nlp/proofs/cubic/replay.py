"""Reads the tree of a stopped run for C2 cubic splines, proving every step again."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....problem import TrajgapError
from ..exact import ExactProblem
from .proof import MIX, TOTAL, Target, Weights, multiplied
from .system import CubicSystem, Row, kind_of_ends, scaled
from .tree import ALPHABET, Box, Prover, Step

_LARGEST = 2**26


def replayed(exact: ExactProblem, document: dict[str, Any]) -> tuple[Prover, Box, int]:
    """The tree of a document, with what it proves in ticks.

    Parameters
    ----------
    exact : ExactProblem
    document : dict
        As `cubic_tree.proof_document` writes it; nothing in it is trusted.

    Returns
    -------
    prover : Prover
    root : Box
    lower : int

    Raises
    ------
    TrajgapError
        If a step is not proved.
    """
    ends = kind_of_ends(exact)
    _need(document["kind"] == "cubic" and ends is not None, "another kind of curve")
    assert ends is not None
    powers = [_whole(p, 60) for p in document["powers"]]
    _need(len(powers) == len(exact.joints), "powers")
    system = scaled(exact, ends, powers, _whole(document["second"], 60))
    cap = _whole(document["cap"], 2**28)
    _need(cap > 0, "cap")
    prover = Prover(system, cap)
    known = [_row(system, entry) for entry in document["rows"]]
    root = prover.root()
    stack = [(root, document["tree"])]
    while stack:
        box, steps = stack.pop()
        for step in steps:
            _need(not box.children, "a step after a split")
            if box.closed:
                break
            if step == "r":
                prover.narrow(box)
            elif step[0] == "s":
                k, at = _whole(step[1], system.free - 1), _whole(step[2], 2**28)
                _need(k >= 0, "a split of a side that is not there")
                stack += zip(prover.split(box, k, at), step[3:], strict=True)
            else:
                _again(prover, box, step, known)
    return prover, root, min((box.floor for box in root.leaves()), default=cap)


def _again(prover: Prover, box: Box, step: list[Any], known: list[Row]) -> None:
    kind, (held, equations, mix) = step[0], step[-3:]
    scale = 0 if kind == "e" else _whole(step[-4], _LARGEST)
    _need(scale > 0 or kind == "e", "weight of the target")
    weights = _weights(prover.system, scale, held, equations, mix, known)
    if kind == "e":
        _need(prover.clear(box, weights), "a box is not empty")
    elif kind == "f":
        value = _whole(step[1], 2**28)
        bound = prover.bound(box, TOTAL, weights)
        _need(bound is not None and bound >= value, "a floor is not proved")
        box.steps.append(Step("f", value=value, weights=weights))
        box.floor = max(box.floor, value)
        prover.trim(box)
    else:
        _need(kind == "t", "an unknown step")
        k, sign, value = _whole(step[1], prover.system.free - 1), step[2], _whole(step[3], 2**28)
        _need(k >= 0 and sign in (1, -1), "a side that is not there")
        bound = prover.bound(box, Target(k, sign), weights)
        _need(bound is not None and bound >= sign * value, "a side is not proved")
        prover.set(box, Step("t", k, sign, value, weights))


def _need(condition: bool, reason: str) -> None:
    if not condition:
        raise TrajgapError(f"resume: {reason}")


def _whole(value: Any, most: int) -> int:
    _need(type(value) is int and abs(value) <= most, f"no integer up to {most}: {value!r}")
    return int(value)


def _row(system: CubicSystem, entry: list[Any]) -> Row:
    row = Row(*entry)
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
    known: list[Row],
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
    weights.mix[which] = [ALPHABET.index(letter) for letter in mix]
    return weights


def _pairs(flat: list[Any]) -> list[tuple[Any, Any]]:
    _need(len(flat) % 2 == 0, "weights in pairs")
    return list(zip(flat[::2], flat[1::2], strict=True))


def _index(k: Any, known: list[Row]) -> int:
    number = _whole(k, len(known) - 1)
    _need(number >= 0, "a condition that is not there")
    return number
