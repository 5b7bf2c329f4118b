"""Why a claim has its word: the first reason, the others folded, each with all its readings."""

from __future__ import annotations

from typing import Any

from docutils import nodes

from ..documents import ClaimVerdict, Named, Said, grouped, in_full
from .parts import folded, paragraph


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
    every = [line for one in found for line in in_full(one, computed, named, word=depends)]
    if "opening" not in verdict and len(every) == len(found):
        return [opening]
    if len(every) < 2:
        return [opening, *folded("The whole reason", paragraph(whole))]
    return [opening, *folded(f"All {len(every)} reasons", *map(paragraph, every))]


def names(case: dict[str, Any]) -> Named:
    """What the readings of a result are called."""
    said = case["readings"] or {}
    return Named(said.get("labels", {}), said.get("implausible", {}), said.get("default", ""))
