"""Text made safe to print, where whatever steers or hides is shown by its number; and lists."""

from __future__ import annotations

import re
from collections.abc import Sequence
from unicodedata import category as unicode_category

_SPACE = "Zs"
"""Unicode's category of spaces; those that Python does not print are wide or do not break."""


def visible(text: str, keep: str = "") -> str:
    """Text in which every character can be seen.

    Control characters move a cursor, bidirectional ones turn digits and file names around, and
    both are invisible themselves. Each character that is not printable is shown by its number,
    such as ``<U+202E>``; unusual spaces become plain ones.

    Parameters
    ----------
    keep : str
        Characters to leave alone, such as line feeds where lines have a meaning.

    Examples
    --------
    >>> visible("total 1.50" + chr(0x202E) + "s")
    'total 1.50<U+202E>s'
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in keep else _shown(c) for c in text)


def listed(words: Sequence[str]) -> str:
    """Words as a sentence lists them.

    Examples
    --------
    >>> listed(["one"]), listed(["one", "two", "three"])
    ('one', 'one, two and three')
    """
    return " and ".join(part for part in (", ".join(words[:-1]), *words[-1:]) if part)


def escaped(text: str) -> str:
    r"""JSON text in which every character can be seen, by JSON's own escapes.

    Parameters
    ----------
    text : str
        JSON; outside its strings it holds nothing but printable characters and line feeds.

    Returns
    -------
    str
        The same document; half a surrogate pair, which no file can hold, is escaped as well.
    """
    return _HIDDEN.sub(_escape, text)


_HIDDEN = re.compile(r"[^\n -~]")
"""Candidates for an escape; which of them are printable is asked one by one."""


def _escape(match: re.Match[str]) -> str:
    character = match[0]
    if character.isprintable() or unicode_category(character) == _SPACE:
        return character
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i : i + 2].hex()}" for i in range(0, len(units), 2))


def _shown(character: str) -> str:
    return " " if unicode_category(character) == _SPACE else f"<U+{ord(character):04X}>"
