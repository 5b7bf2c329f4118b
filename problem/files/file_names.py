"""Names of files and of places in a page, made of any texts: different texts, different names."""

from __future__ import annotations

import re
from base64 import b32encode
from hashlib import sha256

LONGEST_NAME = 100
"""Characters of the texts that a name keeps: with hash, another name before it and an ending it
stays far below the 255 bytes that file systems allow."""
_UNSAFE = re.compile(r"[^a-z0-9.-]+")
"""Capitals are unsafe too: some file systems do not distinguish them from lower-case letters."""


def file_name(*parts: str) -> str:
    """Name made of texts, without an ending: lower-case letters, digits, dots, dashes, "_".

    One text that is such a name already stays as it is, and so do two joined by a dash if the
    first has no dash. Whenever anything else was changed, joined or cut, an underscore and a hash
    of the texts follow. So names of equally many texts are never the same for different texts,
    on file systems that ignore case as well; nor are those of one text without a dash, of two
    texts of which the first has none, and of more texts.

    Parameters
    ----------
    *parts : str
        Texts of any length, with any characters.

    Returns
    -------
    str
        At most 117 characters, ASCII, never hidden, with a letter or a digit in front; fit for an
        ``id`` of HTML too.

    Examples
    --------
    >>> file_name("irb460-pso-353")
    'irb460-pso-353'
    >>> file_name("optimum", "six-joints")
    'optimum-six-joints'
    >>> file_name("waterfall", "a", "b-c") == file_name("waterfall", "a-b", "c")
    False
    """
    joined = "-".join(parts)
    kept = _UNSAFE.sub("-", joined.lower())[:LONGEST_NAME].strip("-.")
    plain = len(parts) == 1 or (len(parts) == 2 and "-" not in parts[0])
    if plain and kept == joined and kept:
        return kept
    # Lengths first: without them ("a", "b") and ("a\0b",) would be hashed alike.
    counted = "".join(f"{len(part)}:{part}" for part in parts)
    digest = sha256(counted.encode("utf-8", "surrogatepass")).digest()
    # 80 bits: nobody finds two texts with the same ones.
    return f"{kept or 'name'}_{b32encode(digest).decode().lower()[:16]}"
