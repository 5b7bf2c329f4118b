"""Why a claim has its word: what the default reading says, and the other readings folded."""

from __future__ import annotations

from typing import Any

from docutils import nodes

from ..documents import ClaimVerdict
from .parts import paragraph

_STRONGEST = tuple(
    map(str, (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED))
)
"""Words that decide, in the order in which reasons are told."""
_PLAIN = 2
"""Reasons that are told as they are; of more, all but one are folded."""


def reasons(case: dict[str, Any], verdict: dict[str, Any]) -> list[nodes.Node]:
    """The reasons of a verdict as paragraphs.

    Parameters
    ----------
    case : dict
        Of a result.
    verdict : dict
        One of its verdicts.

    Returns
    -------
    list of nodes
    """
    told = _by_message(case, verdict)
    if len(told) <= _PLAIN:
        return [paragraph(verdict["why"])]
    default = (case["readings"] or {}).get("default")
    first = next((i for i, (_, _, under) in enumerate(told) if {None, default} & set(under)), 0)
    said = [f"{_where(word, under, verdict)}: {message}" for word, message, under in told]
    rest = [one for i, one in enumerate(said) if i != first]
    folded = nodes.container(classes=["trajgap-folded"])
    folded += [paragraph(one) for one in rest]
    return [
        paragraph(said[first]),
        nodes.raw("", f"<details><summary>{len(rest)} more reasons</summary>", format="html"),
        folded,
        nodes.raw("", "</details>", format="html"),
    ]


def _by_message(
    case: dict[str, Any], verdict: dict[str, Any]
) -> list[tuple[str, str, list[str | None]]]:
    """Word, message and readings of what decides, each message once, the strongest word first."""
    found: dict[tuple[str, str], list[str | None]] = {}
    for one in case["findings"]:
        if one["claim"] == verdict["claim"] and one["decides"] and one["verdict"] in _STRONGEST:
            under = found.setdefault((one["verdict"], one["message"]), [])
            under += [one["reading"]] if one["reading"] not in under else []
    told = sorted(found.items(), key=lambda item: _STRONGEST.index(item[0][0]))
    return [(word, message, under) for (word, message), under in told]


def _where(word: str, under: list[str | None], verdict: dict[str, Any]) -> str:
    names = [name for name in under if name is not None]
    if None in under or len(names) == len(verdict["readings"]):
        return f"{word.capitalize()} under every reading"
    which = f"reading {names[0]}" if len(names) == 1 else f"readings {', '.join(names)}"
    return f"{word.capitalize()} under {which}"
