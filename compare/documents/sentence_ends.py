"""Where the sentences of a reason end: the stop of "p. 108" ends none."""

from __future__ import annotations

import re

_SHORT = ("p", "pp", "Fig", "Figs", "Eq", "Eqs", "Sec", "Tab", "No", "no", "vol", "al", "cf", "vs")
"""Abbreviations that papers put before a number or a name, and places repeat."""
_END = re.compile("".join(rf"(?<!\b{short})" for short in _SHORT) + r"\. ")
"""The end of a sentence with others behind it."""


def sentences_of(text: str) -> list[str]:
    """The sentences of a text, each with its stop.

    Parameters
    ----------
    text : str

    Returns
    -------
    list of str
    """
    *most, last = _END.split(text)
    return [*(f"{part}." for part in most), last]


def first_sentence(text: str) -> str:
    """The first sentence of a text, without its stop."""
    return sentences_of(text)[0].rstrip(".")
