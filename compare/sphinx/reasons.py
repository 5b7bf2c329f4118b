"""Why a claim has its word: the first reason, the others folded, each with all its readings."""

from __future__ import annotations

from typing import Any

from docutils import nodes

from ..documents import ClaimVerdict, Named, Said, grouped, in_full
from .parts import folded, paragraph

_PLAIN = 2
"""Reasons that are shown as they are; of more, all but one are folded."""


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
        Said(one["verdict"], one["rule"], one["kind"], (one["message"],), one["reading"])
        for one in case["findings"]
        if one["claim"] == verdict["claim"] and one["decides"]
    ]
    found = grouped(said, computed, named)
    whole, depends = verdict["why"], verdict["verdict"] == ClaimVerdict.DEPENDS
    opening = paragraph(verdict.get("opening", whole))
    if len(found) > _PLAIN or any(len(one.each) > 1 for one in found):
        every = [line for one in found for line in in_full(one, computed, named, word=depends)]
        return [opening, *folded(f"All {len(every)} reasons", *map(paragraph, every))]
    cut = "opening" in verdict
    return [opening, *(folded("The whole reason", paragraph(whole)) if cut else [])]


def names(case: dict[str, Any]) -> Named:
    """What the readings of a result are called."""
    said = case["readings"] or {}
    return Named(said.get("labels", {}), said.get("implausible", {}), said.get("default", ""))
