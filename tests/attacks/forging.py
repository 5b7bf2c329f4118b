"""Certificates and states altered, grafted and forged, their hashes made right again."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from attacks.cases import Rng
from attacks.mutations import places


def _hash(part: Any) -> str:
    words = json.dumps(part, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(words.encode()).hexdigest()


def sealed(document: dict[str, Any]) -> dict[str, Any]:
    """The document with both hashes made right."""
    own = {**document, "problem_hash": _hash(document.get("problem"))}
    own.pop("seal", None)
    return {**own, "seal": _hash(own)}


_NUMBERS = ("9" * 120, "0", "-1", "1e99", "-1e99", "1e-99", "1/3", "1/0", "٣", " 1", "1_0", "nan")
"""Numbers as text that a reader may take for others."""


def altered(rng: Rng, document: dict[str, Any], other: dict[str, Any] | None) -> str:
    """Alter a certificate in place in one way; what was done."""
    ways: tuple[Callable[[], str], ...] = (
        lambda: one_number(rng, document),
        lambda: one_number(rng, document["proof"]),
        lambda: one_number(rng, document["problem"]),
        lambda: claim_more(rng, document),
        lambda: claim_more(rng, document),
        lambda: claim_more(rng, document),
        lambda: _structure(rng, document),
        lambda: _tree(rng, document),
        lambda: _graft(rng, document, other),
        lambda: _easier(rng, document),
        lambda: _infeasible(document),
    )
    return ways[rng.integers(len(ways))]()


def _leaf_places(value: Any) -> list[tuple[Any, ...]]:
    return [p for p in places(value) if not isinstance(_at(value, p), dict | list)]


def _at(value: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        value = value[key]
    return value


def _put(value: Any, place: tuple[Any, ...], new: Any) -> None:
    _at(value, place[:-1])[place[-1]] = new


def one_number(rng: Rng, part: Any) -> str:
    every = _leaf_places(part) if isinstance(part, dict) else []
    if not every:
        return "nothing"
    place = every[rng.integers(len(every))]
    before = _at(part, place)
    _put(part, place, _other(rng, before))
    return f"{'.'.join(map(str, place))}: {str(before)[:40]} is {str(_at(part, place))[:40]}"


def _other(rng: Rng, value: Any) -> Any:
    draw = rng.random()
    if draw < 0.1:
        return [None, True, [], {}, "x", 0, -1, 2**53, 2**70, 1.5][rng.integers(10)]
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        near = [value + 1, value - 1, -value, 0, 2 * value, int(rng.integers(-9, 2**20))]
        return near[rng.integers(len(near))]
    try:
        number = Fraction(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return _NUMBERS[rng.integers(len(_NUMBERS))]
    if draw < 0.2:
        return _NUMBERS[rng.integers(len(_NUMBERS))]
    if draw < 0.3:
        return as_text(-number)
    factor = 1 + Fraction(int(rng.integers(-99, 100)), 10 ** int(rng.integers(1, 13)))
    return as_text(number * factor)


def as_text(number: Fraction) -> str:
    return f"{number.numerator}/{number.denominator}" if number.denominator > 1 else str(number)


def claim_more(rng: Rng, document: dict[str, Any]) -> str:
    """More than is proved: bounds raised together, or an answer shortened."""
    claim, proof = document["claim"], document["proof"]
    up = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(2, 7)))
    what = int(rng.integers(6))
    if what == 5 and claim["durations"]:
        claim["durations"] = [as_text(Fraction(x) / up) for x in claim["durations"]]
        claim["upper"] = as_text(Fraction(claim["upper"]) / up)
        return f"answer shorter by {float(up)}"
    claim["lower"] = as_text(Fraction(claim["lower"]) * up)
    if what > 0 and proof:
        proof["total"] = as_text(Fraction(proof["total"]) * up)
        if "cap" in proof:
            proof["cap"] = as_text(Fraction(proof["cap"]) * up)
    if what > 1:
        claim["upper"] = claim["durations"] = claim["speeds"] = None
    return f"lower bound higher by {float(up)}"


def _structure(rng: Rng, document: dict[str, Any]) -> str:
    every = places(document)
    place = every[rng.integers(len(every))]
    parent, key = _at(document, place[:-1]), place[-1]
    name = ".".join(map(str, place))
    match int(rng.integers(4)):
        case 0:
            del parent[key]
            return f"{name} left out"
        case 1 if isinstance(parent, list):
            parent.insert(key, copy.deepcopy(parent[int(rng.integers(len(parent)))]))
            return f"{name} put in"
        case 2:
            other = every[rng.integers(len(every))]
            value = copy.deepcopy(_at(document, other))
            _put(document, place, value)
            return f"{name} from {'.'.join(map(str, other))}"
    if isinstance(parent, dict):
        parent[f"{key} "] = 1
        return "a key more"
    parent.reverse()
    return f"around {name} turned round"


def _tree(rng: Rng, document: dict[str, Any]) -> str:
    """Nodes left out, doubled, exchanged, or a part replaced by a leaf from elsewhere."""
    proof = document["proof"]
    if not proof or not isinstance(proof.get("tree"), list) or len(proof["tree"]) < 2:
        return "no tree"
    tree = proof["tree"]
    i, j = (int(x) for x in rng.integers(0, len(tree), 2))
    match int(rng.integers(4)):
        case 0:
            del tree[i]
        case 1:
            tree.insert(i, copy.deepcopy(tree[j]))
        case 2:
            tree[i], tree[j] = tree[j], tree[i]
        case _:
            leaves = [n for n in tree if isinstance(n, list) and n and n[0] == "."]
            del tree[i : i + int(rng.integers(1, 6))]
            tree.insert(i, copy.deepcopy(leaves[rng.integers(len(leaves))]) if leaves else ["."])
    return f"tree at {i}, {j}"


def _graft(rng: Rng, document: dict[str, Any], other: dict[str, Any] | None) -> str:
    """The problem of one certificate with the proof of another."""
    if other is None:
        return "nothing to graft"
    key = str(rng.choice(["proof", "problem", "claim"]))
    document[key] = copy.deepcopy(other[key])
    return f"{key} of another"


def _easier(rng: Rng, document: dict[str, Any]) -> str:
    """Limits higher, ways shorter or bounds wider: the bound that is proved no longer holds."""
    problem = document["problem"]
    factor = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(1, 8)))

    def times(value: Any, by: Fraction) -> Any:
        if isinstance(value, dict):
            return {**value, "value": as_text(Fraction(value["value"]) * by)}
        return None if value is None else as_text(Fraction(value) * by)

    match int(rng.integers(3)):
        case 0:
            j = int(rng.integers(len(problem["limits"])))
            problem["limits"][j] = [times(x, factor) for x in problem["limits"][j]]
        case 1:
            problem["waypoints"] = [[times(x, 1 / factor) for x in r] for r in problem["waypoints"]]
        case _:
            problem["duration_lower"] = [times(x, 1 / factor) for x in problem["duration_lower"]]
            problem["duration_upper"] = [None] * len(problem["duration_upper"])
    return f"easier by {float(factor)}"


def _infeasible(document: dict[str, Any]) -> str:
    claim = document["claim"]
    claim["infeasible"] = True
    claim["upper"] = claim["durations"] = claim["speeds"] = None
    return "called infeasible"


def forge_tables(rng: Rng, proof: dict[str, Any]) -> None:
    """Leaves from a pool of the proof's own numbers, in another tree, or of few large weights."""
    tree = proof["tree"]
    leaves = [n for n in tree if isinstance(n, list) and n and n[0] == "."]
    cuts = [n for n in tree if n not in leaves]
    if not leaves:
        return
    depth = int(rng.integers(0, 6))
    forged_tree: list[Any] = []

    def grow(level: int) -> None:
        if level and cuts and rng.random() < 0.8:
            forged_tree.append(copy.deepcopy(cuts[rng.integers(len(cuts))]))
            if isinstance(forged_tree[-1], int) or forged_tree[-1][0] == "/":
                grow(level - 1)
            grow(level - 1)
            return
        leaf = copy.deepcopy(leaves[rng.integers(len(leaves))])
        if rng.random() < 0.5:
            one_number(rng, {"leaf": leaf})
        forged_tree.append(leaf)

    grow(depth)
    proof["tree"] = forged_tree
    for key in ("rows", "windows"):
        if proof.get(key) and rng.random() < 0.5:
            for _ in range(int(rng.integers(1, 4))):
                one_number(rng, {key: proof[key]})
