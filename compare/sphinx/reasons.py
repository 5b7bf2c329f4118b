"""Why a claim has its word: the first reason, the others folded, each with all its readings."""

from __future__ import annotations

from typing import Any

from docutils import nodes

from ..documents import ClaimVerdict, Named, Said, grouped, in_full, told
from .parts import paragraph

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
    named, computed = names(case), tuple(verdict["readings"])
    said = [
        Said(one["verdict"], one["message"], one["rule"], one["reading"])
        for one in case["findings"]
        if one["claim"] == verdict["claim"] and one["decides"]
    ]
    found = grouped(said, computed, named)
    summed = any(len(one.each) > 1 for one in found)
    if len(found) <= _PLAIN and not summed:
        return [paragraph(verdict["why"])]
    depends = verdict["verdict"] == ClaimVerdict.DEPENDS
    first = told(found[0], computed, named, word=depends)
    rest = [
        line
        for one in (found if summed else found[1:])
        for line in in_full(one, computed, named, word=depends)
    ]
    folded = nodes.container(classes=["trajgap-folded"])
    folded += [paragraph(one) for one in rest]
    opening = f"All {len(rest)} reasons" if summed else f"{len(rest)} more reasons"
    return [
        paragraph(first),
        nodes.raw("", f"<details><summary>{opening}</summary>", format="html"),
        folded,
        nodes.raw("", "</details>", format="html"),
    ]


def names(case: dict[str, Any]) -> Named:
    """What the readings of a result are called."""
    said = case["readings"] or {}
    return Named(said.get("labels", {}), said.get("implausible", {}), said.get("default", ""))
