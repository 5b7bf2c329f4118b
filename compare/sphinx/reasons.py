"""What a page says of claims: which are wanted, and why each has its word."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from docutils import nodes

from ...problem import TrajgapError
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


def wanted_words(option: str) -> list[str]:
    """The verdicts that an option names, separated by commas, in their order.

    Raises
    ------
    TrajgapError
        If one is not a verdict on a claim: such a list would be empty whatever the case says.
    """
    words = [" ".join(word.split()) for word in option.split(",") if word.strip()]
    for word in words:
        if word not in tuple(ClaimVerdict):
            known = ", ".join(ClaimVerdict)
            raise TrajgapError(
                f":verdict: {word!r} is not a verdict on a claim; use some of: {known}"
            )
    return words


def none_said(wanted: Sequence[str]) -> str:
    """A sentence instead of an empty list of claims."""
    if not wanted:
        return "No claim was audited."
    *others, last = (f"“{word}”" for word in wanted)
    said = f"{', '.join(others)} or {last}" if others else last
    return f"No claim has the verdict {said}."
