"""Places of the numbers in a JSON document, and random changes of them."""

from fractions import Fraction
from typing import Any

import numpy as np

Path_ = tuple[str | int, ...]


def places(node: Any, path: Path_ = ()) -> list[Path_]:
    """Path of every number, printed ones too, cuts of the tree included."""
    if isinstance(node, dict):
        return [p for key, x in node.items() for p in places(x, (*path, key))]
    if isinstance(node, list):
        return [p for i, x in enumerate(node) for p in places(x, (*path, i))]
    if isinstance(node, bool) or node is None:
        return []
    if isinstance(node, int):
        return [path]
    numeric = path[0] in ("problem", "claim", "proof") and any(c.isdigit() for c in node)
    return [path] if numeric else []


def changed(value: Any, rng: np.random.Generator) -> Any:
    if rng.random() < 0.1:
        # Not the type that it has: a leaf that is cut, a number that is none.
        return [["."], 0, 1, ["?"], True, "0", None, []][int(rng.integers(0, 8))]
    if isinstance(value, int):
        return int(rng.choice([value + 1, value - 1, -value, int(rng.integers(0, 20_000)), 0]))
    try:
        number = Fraction(value)
    except ValueError:
        return value
    factor = 1 + Fraction(float(rng.choice([1, -1]) * 10 ** rng.uniform(-9, 0.5)))
    changed = rng.choice(5)
    if changed == 0:
        number = -number
    elif changed == 1:
        number = number + Fraction(float(rng.normal()))
    elif changed == 2:
        number = Fraction(0)
    else:
        number = number * factor
    return f"{number.numerator}/{number.denominator}" if len(str(number)) < 300 else "7"


def put(data: dict[str, Any], path: Path_, value: Any) -> None:
    node: Any = data
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value


def get(data: dict[str, Any], path: Path_) -> Any:
    node: Any = data
    for key in path:
        node = node[key]
    return node


def field(path: Path_) -> str:
    """Name of the field that a number belongs to; columns of a table are fields of their own."""
    names = [key for key in path if isinstance(key, str)]
    if names[-1] == "rows":
        return f"proof.rows column {path[-1]}"
    if names[-1] == "tree":
        # A cut, a row or its weight in a leaf, or a column of the bounds in closed form.
        return ("cut", f"entry {int(path[-1]) % 2}", f"column {path[-1]}")[len(path) - 3]
    return ".".join(names)


def fields(data: dict[str, Any]) -> dict[str, list[Path_]]:
    """Places of the numbers of every field."""
    found: dict[str, list[Path_]] = {}
    for path in places(data):
        found.setdefault(field(path), []).append(path)
    return found
