"""Two transcriptions of one paper compared, entry by entry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from .case import Case

ABSENT = "(absent)"
"""Stands for what one of two transcriptions does not have."""
WORDS = frozenset({
    "answer", "choice", "default_why", "not_checkable", "not_printed", "note", "open", "outcome",
    "text", "title", "transcription", "what", "where", "why",
})  # fmt: skip
"""Keys whose text is the transcriber's own: two of them choose other words for the same."""


@dataclass(frozen=True)
class Difference:
    """One place at which two transcriptions differ."""

    field: str
    """Where, such as ``claims.total.value`` or ``waypoints[1][0]``."""
    first: str
    second: str
    """What stands there in each; printed digits in quotes, `ABSENT` where there is nothing."""


def compare_transcriptions(first: Case, second: Case, words: bool = False) -> list[Difference]:
    """Compare the contents of two case files, regardless of layout.

    Digits are compared as printed: ``"0.66"``, ``"0.660"`` and a bare ``0.66`` are three things.
    Way-points by rows and by columns are the same table. Entries of lists are matched by their ids,
    which must therefore agree; their order does not count.

    Parameters
    ----------
    words : bool
        Whether titles, notes and places are compared too, which each transcriber words differently.
    """
    one, two = (_held(case) for case in (first, second))
    return list(_differences("", one, two, words))


def _held(case: Case) -> dict[str, Any]:
    """What a case file holds, with its way-points one row each."""
    found: dict[str, Any] = case.document.model_dump(mode="json")
    for block in (found, *found.get("problems", ()), *found.get("readings", ())):
        points = block.get("waypoints")
        if points and points.get("joint_rows") is not None:
            rows = points.pop("joint_rows")
            points["waypoint_rows"] = [list(row) for row in zip(*rows, strict=True)]
        elif points:
            points.pop("joint_rows", None)
    del found["id"]
    return found


def _differences(field: str, first: Any, second: Any, words: bool) -> Iterator[Difference]:
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        for key in dict.fromkeys((*first, *second)):
            if key in WORDS and not words:
                continue
            inner = f"{field}.{key}" if field else str(key)
            yield from _differences(inner, first.get(key), second.get(key), words)
    elif _listed(first) and _listed(second):
        yield from _of_lists(field, first, second, words)
    elif first != second or type(first) is not type(second):
        yield Difference(field, _shown(first), _shown(second))


def _listed(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _of_lists(
    field: str, first: Sequence[Any], second: Sequence[Any], words: bool
) -> Iterator[Difference]:
    one, two = _by_id(first), _by_id(second)
    if one is not None and two is not None:
        yield from _differences(field, one, two, words)
        return
    for k, (a, b) in enumerate(zip_longest(first, second)):
        yield from _differences(f"{field}[{k}]", a, b, words)


def _by_id(entries: Sequence[Any]) -> dict[str, Any] | None:
    if not all(isinstance(one, Mapping) and "id" in one for one in entries):
        return None
    return {one["id"]: {k: v for k, v in one.items() if k != "id"} for one in entries}


def _shown(value: Any) -> str:
    if value is None:
        return ABSENT
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{k} = {_shown(v)}" for k, v in value.items() if v) + "}"
    if _listed(value):
        return "[" + ", ".join(map(_shown, value)) + "]"
    return str(value)
