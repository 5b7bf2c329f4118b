"""Damage: seeded mutations of the values, the structure and the text of files."""

import copy
from collections.abc import Callable
from typing import Any

from support.toml_text import Bare, toml_text

from attacks.cases import Rng

Place = tuple[Any, ...]
"""Keys and positions from the top of a document."""

NUMBERS = (
    "0", "-0", "-0.0", "-1", "1e-300", "1e300", "1e-13", "1e13", "1e999", "9" * 70, "0." + "0" * 80,
    "nan", "inf", "-inf", "+1", "0x1f", "1_000", "1e12", "1e-12", "5e-324", "99999999999999999999",
    "1e+308", "0.1e-299", "1e1000000000", "123456789012345678901234567890123456789012345678901234",
)  # fmt: skip
"""Numbers at and beyond what floats and the format hold."""
ODD = ("0", "-0.0", "1e-12", "1e12", "1e-300", "1e300", "0.000", "1", "1e6", "1e-6", "99999")
"""Numbers that the format allows in many places, and that computing may stumble over."""
STRINGS = (
    "", " ", "\t", "\n", "\x00", "\x1b[31mred\x1b[0m", "\u202egnirts", "\u2066x\u2069", "\ufeff",
    "é" * 300, "x" * 5000, "../../etc", "a/b", ".", "..", "CON", "<script>alert(1)</script>",
    "{{ 7*7 }}", "%s%n", "|`*_[x](y)", "𝟘", "٣.٥", "\uff11", "−1", "1,5", "1 2", "0.660 ", "nan",
    "Inf", "True", "null", "__class__", "$(x)", "'; --", "é\u0301",
)  # fmt: skip
"""Texts that steer terminals, pages, file names and number readers."""
KEYS = ("", "x", "format", "id", "__proto__", "a b", "é", "\u202e", "k" * 400, "joint_rows")
"""Keys that a block does not know, or knows elsewhere."""


def places(value: object, at: Place = ()) -> list[Place]:
    """Every place in a document, the whole of it left out."""
    found: list[Place] = []
    items: Any = ()
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    for key, below in items:
        found.append((*at, key))
        found += places(below, (*at, key))
    return found


def _parent(document: Any, place: Place) -> Any:
    for key in place[:-1]:
        document = document[key]
    return document


def _other_type(rng: Rng) -> Any:
    kinds: tuple[Callable[[], Any], ...] = (
        lambda: Bare(rng.choice(NUMBERS)),
        lambda: str(rng.choice(NUMBERS)),
        lambda: str(STRINGS[rng.integers(len(STRINGS))]),
        lambda: bool(rng.random() < 0.5),
        list,
        lambda: [[]],
        lambda: [1, "2", True],
        lambda: {"x": 1},
        dict,
        lambda: [{}],
        lambda: Bare("1979-05-27T07:32:00Z"),
        lambda: Bare("07:32:00"),
    )
    return kinds[rng.integers(len(kinds))]()


def damaged(rng: Rng, raw: dict[str, Any]) -> tuple[str, str]:
    """Text of a case file with one to three faults, and what was done to it."""
    document, done = copy.deepcopy(raw), []
    if rng.random() < 0.4:
        for _ in range(int(rng.integers(1, 3))):
            done.append(_odd_number(rng, document))
        return toml_text(document), ", ".join(done)
    for _ in range(int(rng.integers(1, 4))):
        done.append(structural(rng, document))
    try:
        text = toml_text(document)
    except TypeError:
        text = toml_text(raw)
    if rng.random() < 0.25:
        text, what = textual(rng, text)
        done.append(what)
    return text, ", ".join(done)


def _odd_number(rng: Rng, document: dict[str, Any]) -> str:
    """A number of the problem replaced by another that is no fault by itself, but odd."""
    parts = ("waypoints", "limits", "durations", "claims", "interpolant", "problems", "readings")
    every = [p for p in places(document) if p[0] in parts and len(p) > 2]
    numbers = [p for p in every if _is_number(_parent(document, p)[p[-1]])]
    if not numbers:
        return "no number"
    place = numbers[rng.integers(len(numbers))]
    parent, before = _parent(document, place), str(_parent(document, place)[place[-1]])
    new = str(rng.choice(ODD)) if rng.random() < 0.6 else f"{_scaled(rng, before)}"
    parent[place[-1]] = Bare(new) if isinstance(parent[place[-1]], Bare) else new
    return f"{'.'.join(map(str, place))} is {new}"


def _is_number(value: Any) -> bool:
    try:
        float(value)
    except (TypeError, ValueError):
        return False
    return isinstance(value, str)


def _scaled(rng: Rng, text: str) -> str:
    value = float(text) * 10.0 ** float(rng.integers(-9, 10))
    return f"{value:.6g}" if abs(value) < 1e300 else "1e300"


def structural(rng: Rng, document: dict[str, Any]) -> str:
    """Something left out, doubled, of another type or from elsewhere; what was done."""
    every = places(document)
    if not every:
        return "nothing left"
    place = every[rng.integers(len(every))]
    parent, key = _parent(document, place), place[-1]
    name = ".".join(map(str, place))
    match int(rng.integers(9)):
        case 0:
            del parent[key]
            return f"{name} left out"
        case 1 | 2:
            parent[key] = _other_type(rng)
            return f"{name} is {str(parent[key])[:30]!r}"
        case 3 if isinstance(parent, list):
            parent.insert(key, copy.deepcopy(parent[key]))
            return f"{name} twice"
        case 3 | 4 if isinstance(parent, dict):
            parent[KEYS[rng.integers(len(KEYS))]] = copy.deepcopy(parent[key])
            return f"{name} under another key"
        case 5 if isinstance(parent[key], str):
            parent[key] = _bent(rng, parent[key])
            return f"{name} is {parent[key][:30]!r}"
        case 6 if isinstance(parent[key], list):
            parent[key] = parent[key] * int(rng.integers(2, 40))
            return f"{name} repeated"
        case 7:
            other = every[rng.integers(len(every))]
            try:
                parent[key] = copy.deepcopy(_parent(document, other)[other[-1]])
            except (KeyError, IndexError, TypeError):
                return f"{name} kept"
            return f"{name} is what stands at {'.'.join(map(str, other))}"
    parent[key] = Bare(rng.choice(NUMBERS))
    return f"{name} is {parent[key][:30]}"


def _bent(rng: Rng, text: str) -> str:
    """A text a few characters away from what it was; digits stay a bare token."""
    where = int(rng.integers(len(text) + 1))
    extra = STRINGS[rng.integers(len(STRINGS))][:20]
    match int(rng.integers(4)):
        case 0:
            bent = text[:where] + extra + text[where:]
        case 1:
            bent = text[:where] + text[where + 1 :]
        case 2:
            bent = text + text
        case _:
            bent = text.swapcase() or "x"
    return Bare(bent) if isinstance(text, Bare) and bent.isascii() and bent.isprintable() else bent


def textual(rng: Rng, text: str) -> tuple[str, str]:
    """One fault of the lines, the signs or the nesting of any text, and what it is."""
    lines = text.split("\n")
    where = int(rng.integers(len(lines)))
    at = int(rng.integers(len(text) + 1))
    match int(rng.integers(11)):
        case 0:
            return "\n".join(lines[:where] + lines[where + 1 :]), "a line left out"
        case 1:
            return "\n".join([*lines[:where], lines[where], *lines[where:]]), "a line twice"
        case 2:
            return text[:at], "cut off"
        case 3:
            depth = int(rng.integers(10, 3000))
            return f"{text}\nz = {'[' * depth}{']' * depth}\n", f"{depth} nested lists"
        case 4:
            depth = int(rng.integers(10, 600))
            return f"{text}\n[{'.'.join(['a'] * depth)}]\n", f"{depth} nested tables"
        case 5:
            return "\ufeff" + text.replace("\n", "\r\n"), "another line end"
        case 6:
            return text[:at] + chr(int(rng.integers(1, 0x2FF))) + text[at:], "a character put in"
        case 7:
            digits = [k for k, c in enumerate(text) if c.isdigit()] or [0]
            k, word = int(rng.choice(digits)), (*NUMBERS, *STRINGS)[rng.integers(40)]
            return text[:k] + word + text[k + 1 :], f"{word[:20]!r} in a number"
        case 8:
            sign = str(rng.choice(list(",;:[]{}<>&*!#\"'|%@\t\x07\u202e- ")))
            return text[:at] + sign + text[at:], f"{sign!r} put in"
        case 9:
            deep = str(rng.choice(["[", "{", "<a>", "- ", "(", "&a [*a, "]))
            depth = int(rng.choice([1, 50, 5000]))
            return text[:at] + deep * depth + text[at:], f"{depth} times {deep}"
    sign = "\n[" if "\n[" in text else "\n"
    blocks = text.split(sign)
    order = rng.permutation(len(blocks) - 1) + 1 if len(blocks) > 1 else []
    return sign.join([blocks[0], *(blocks[i] for i in order)]), "parts in another order"
