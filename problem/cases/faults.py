"""One clear line for whatever a validated case file gets wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from ..fields import UNION_TAGS, describe, nearest
from .claim import QUANTITY_KINDS

_ONE_OR_EACH = (
    "velocity",
    "acceleration",
    "jerk",
    "position_lower",
    "position_upper",
    "lower",
    "upper",
)
"""Fields that take one number or a list: pydantic puts the union's tag into their path."""
_EXPECTED = {
    "string_type": ("a string", "put it in quotes"),
    "tuple_type": ("a list", "write it in [ ]"),
    "int_type": ("a whole number", "write one"),
    "bool_type": ("true or false", "write one of them"),
    "dict_type": ("a table of keys", "write it as a table"),
}
"""Pydantic's error type to what was wanted, and how to give it in TOML."""


def first_fault(error: ValidationError) -> tuple[str, str]:
    """Field path and reason of the fault to fix first.

    Parameters
    ----------
    error : ValidationError
        What pydantic found.

    Returns
    -------
    field : str
        Path such as ``claims[3].durations[1]``.
    reason : str
        What is wrong and how to fix it; one line, with the number of further faults.
    """
    details = error.errors(include_url=False)
    # A misspelt key is also a missing one; the spelling is what to fix.
    details.sort(key=lambda detail: detail["type"] != "unknown_key")
    field, reason = _read(details[0])
    more = len(details) - 1
    return field, reason + (f" (and {more} more)" if more else "")


def _read(detail: Mapping[str, Any]) -> tuple[str, str]:
    context = detail.get("ctx", {})
    kind, raw = detail["type"], detail["input"]
    path = _path(detail["loc"])
    if kind in ("fault", "unknown_key"):
        return (path + context["path"]).removeprefix("."), context["reason"]
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        given = raw.get("quantity") if isinstance(raw, dict) else None
        if given is None:
            return f"{path}.quantity", f"is missing; add one of {', '.join(QUANTITY_KINDS)}"
        fix = nearest(str(given), QUANTITY_KINDS)
        return f"{path}.quantity", f"{_short(given)} is no quantity of a claim; {fix}"
    return path, _reason(kind, raw, context, detail["msg"])


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
        before = location[position - 1] if position else None
        if part in UNION_TAGS and before in _ONE_OR_EACH:
            continue
        if position == 2 and location[0] == "claims" and part in QUANTITY_KINDS:
            continue
        path += f"[{part}]" if isinstance(part, int) else f".{part}"
    return path.removeprefix(".")


def _short(raw: object) -> str:
    text = repr(raw) if isinstance(raw, str) else str(raw)
    return text if len(text) <= 40 else text[:37] + "..."
