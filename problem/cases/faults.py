"""One clear line for all that a case file gets wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from pydantic import ValidationError

from ..errors import CaseError
from ..printed import UNION_TAGS, describe, spelling_hint
from .claim import QUANTITY_KINDS
from .clue import CLUE_KINDS

_OF_SEVERAL_KINDS = {
    "claims": ("quantity", QUANTITY_KINDS, "quantity of a claim"),
    "clues": ("kind", CLUE_KINDS, "kind of clue"),
}
"""Lists whose entries are of several kinds: the key that tells them apart, its values, its name."""
_FREE = ("turns", "settings", "chosen")
"""Tables with keys of any name, which a union's tag may have too."""
_EXPECTED = {
    "string_type": ("a string", "put it in quotes"),
    "tuple_type": ("a list", "write it in [ ]"),
    "int_type": ("a whole number", "write one"),
    "bool_type": ("true or false", "write one of them"),
    "dict_type": ("a table of keys", "write it as a table"),
}
"""Pydantic's error type to what was wanted, and how to give it in TOML."""


class Faults:
    """Faults of one file, gathered so that one refusal tells all of them."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.found: list[tuple[str, str]] = []

    def add(self, field: str, reason: str) -> None:
        """Note a fault; only the first at each field, because others may follow from it."""
        if all(field != known for known, _ in self.found):
            self.found.append((field, reason))

    @contextmanager
    def noted(self) -> Iterator[None]:
        """Go on after whatever is refused inside."""
        try:
            yield
        except CaseError as error:
            for field, reason in error.faults:
                self.add(field, reason)

    def refuse(self) -> None:
        """Raise a CaseError that tells all faults, if there are any."""
        if self.found:
            raise refusal(self.file, self.found)


def refusal(file: str, faults: Sequence[tuple[str, str]]) -> CaseError:
    """The error that tells all faults, at least one, the first to be fixed first."""
    (field, reason), *others = faults
    return CaseError(file, field, reason, others)


def all_faults(error: ValidationError) -> list[tuple[str, str]]:
    """Field path and reason of every fault, the one to fix first in front.

    Returns
    -------
    list of (str, str)
        A path such as ``claims[3].durations[1]``, and what is wrong and how to fix it.
    """
    details = error.errors(include_url=False)
    # A list is also called too short for the entries that have faults of their own.
    inside = {one["loc"][:k] for one in details for k in range(len(one["loc"]))}
    details = [one for one in details if one["type"] != "too_short" or one["loc"] not in inside]
    # A misspelt key is also a missing one; the spelling is what to fix.
    details.sort(key=lambda detail: detail["type"] != "unknown_key")
    found = Faults("")
    for detail in details:
        for field, reason in _read(detail):
            found.add(field, reason)
    return found.found


_MISSING = {
    "iterations": 'is missing; give the printed number. If the paper says "converges to the '
    'optimum" without a number, use quantity = "statement" with checks = "optimal"',
}
"""How to fix a missing key that the paper may not print."""


def _read(detail: Mapping[str, Any]) -> list[tuple[str, str]]:
    context = detail.get("ctx", {})
    kind, raw = detail["type"], detail["input"]
    path = _path(detail["loc"])
    if kind in ("fault", "unknown_key"):
        found = [(context["path"], context["reason"]), *context.get("others", ())]
        return [((path + at).removeprefix("."), reason) for at, reason in found]
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        key, kinds, name = _OF_SEVERAL_KINDS[detail["loc"][0]]
        given = raw.get(key) if isinstance(raw, dict) else None
        if given is None:
            return [(f"{path}.{key}", f"is missing; add one of {', '.join(kinds)}")]
        fix = spelling_hint(str(given), kinds)
        return [(f"{path}.{key}", f"{_short(given)} is not a {name}; {fix}")]
    if kind == "missing" and detail["loc"][-1] in _MISSING:
        return [(path, _MISSING[detail["loc"][-1]])]
    if kind == "string_too_short" and detail["loc"][-1] == "where":
        return [(path, 'is empty; state where it is printed, such as "Table 2"')]
    return [(path, _reason(kind, raw, context, detail["msg"]))]


def _reason(kind: str, raw: object, context: Mapping[str, Any], message: str) -> str:
    if kind == "value_error":
        return str(context["error"])
    if kind == "missing":
        return "is missing; add it"
    if kind in ("literal_error", "enum"):
        return f"{_short(raw)} is not allowed; use {context['expected']}"
    if kind == "string_pattern_mismatch":
        return f"{_short(raw)} is not an id; use lower-case letters, digits, dots and dashes"
    if kind in ("string_too_short", "too_short"):
        return "is empty; fill it in or leave the key out"
    if kind == "too_long":
        return f"has more than {context['max_length']:,} entries; leave some out"
    if kind in ("greater_than_equal", "less_than_equal"):
        word, bound = ("least", "ge") if kind.startswith("greater") else ("most", "le")
        return f"{_short(raw)} is out of range; give at {word} {context[bound]}"
    if kind in _EXPECTED:
        wanted, fix = _EXPECTED[kind]
        return f"expected {wanted}, got {describe(raw)}; {fix}"
    return f"{message}, got {_short(raw)}; see the schema of case files"


def _path(location: tuple[str | int, ...]) -> str:
    path = ""
    for position, part in enumerate(location):
        # Where one number or a list is taken, pydantic puts the union's tag into the path.
        if part in UNION_TAGS and location[position - 1] not in _FREE:
            continue
        if (
            position == 2
            and location[0] in _OF_SEVERAL_KINDS
            and part in _OF_SEVERAL_KINDS[location[0]][1]
        ):
            continue
        path += f"[{part}]" if isinstance(part, int) else f".{part}"
    return path.removeprefix(".")


def _short(raw: object) -> str:
    text = repr(raw) if isinstance(raw, str) else str(raw)
    return text if len(text) <= 40 else text[:37] + "..."
