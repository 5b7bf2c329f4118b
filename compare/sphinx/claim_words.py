"""The words by which a page keeps to some claims, and what it says where there are none."""

from __future__ import annotations

from collections.abc import Sequence

from ...problem import TrajgapError
from ..documents import ClaimVerdict


def wanted_words(option: str) -> list[str]:
    """The verdicts that an option names, separated by commas, in their order.

    Raises
    ------
    TrajgapError
        If one is no verdict on a claim: such a list would be empty whatever the case says.
    """
    words = [" ".join(word.split()) for word in option.split(",") if word.strip()]
    for word in words:
        if word not in tuple(ClaimVerdict):
            known = ", ".join(ClaimVerdict)
            raise TrajgapError(f":verdict: {word!r} is no verdict on a claim; use some of: {known}")
    return words


def none_said(wanted: Sequence[str]) -> str:
    """A sentence in place of an empty list of claims."""
    if not wanted:
        return "No claim was audited."
    *others, last = (f"“{word}”" for word in wanted)
    said = f"{', '.join(others)} or {last}" if others else last
    return f"No claim has the verdict {said}."
