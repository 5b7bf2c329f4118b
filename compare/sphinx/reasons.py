"""Why a claim has its word: the first reason, the others folded, each with all its readings."""

from __future__ import annotations

from typing import Any

from docutils import nodes

from ..documents import ClaimVerdict, Named, Said, grouped, in_full, sentences_of, with_readings
from .parts import folded, paragraph

_PLAIN = 2
"""Reasons that are shown as they are; of more, all but one are folded."""
_OPEN_WORDS = 60
"""Words of a reason that stand in the open: a verdict and its numbers have room, conditions of a
long one are a fold away."""


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
    named, computed = names(case), tuple(verdict["readings"])
    said = [
        Said(one["verdict"], one["message"], one["rule"], one["reading"])
        for one in case["findings"]
        if one["claim"] == verdict["claim"] and one["decides"]
    ]
    found = grouped(said, computed, named)
    summed = any(len(one.each) > 1 for one in found)
    if len(found) <= _PLAIN and not summed:
        whole = verdict["why"]
        cut = opened(whole)
        more = folded("The whole reason", paragraph(whole)) if cut != whole else []
        return [paragraph(cut), *more]
    depends = verdict["verdict"] == ClaimVerdict.DEPENDS
    first = with_readings(found[0], computed, named, word=depends)
    every = summed or opened(first) != first
    rest = [
        line
        for one in (found if every else found[1:])
        for line in in_full(one, computed, named, word=depends)
    ]
    opening = f"All {len(rest)} reasons" if every else f"{len(rest)} more reasons"
    return [paragraph(opened(first)), *folded(opening, *map(paragraph, rest))]


def opened(text: str) -> str:
    """The sentences of a reason that stand in the open: as many as have room, at least one."""
    first, *others = sentences_of(text)
    shown, room = [first], _OPEN_WORDS - len(first.split())
    for sentence in others:
        room -= len(sentence.split())
        if room < 0:
            break
        shown.append(sentence)
    return " ".join(shown)


def names(case: dict[str, Any]) -> Named:
    """What the readings of a result are called."""
    said = case["readings"] or {}
    return Named(said.get("labels", {}), said.get("implausible", {}), said.get("default", ""))
