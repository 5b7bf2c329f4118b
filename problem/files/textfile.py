"""Text files handed in by a user, read with one clear line when they cannot be."""

from __future__ import annotations

import tomllib
from decimal import Decimal
from hashlib import sha256
from pathlib import Path
from typing import Any

from ..errors import CaseError
from .atomic import read_regular
from .sizes import MOST


def read_text(path: Path) -> str:
    """Read a small UTF-8 text file.

    Returns
    -------
    str
        Its text, without a byte order mark, lines ended by a newline.

    Raises
    ------
    CaseError
        If the file is missing, not a regular file, larger than 5 MB, empty, or not UTF-8 text.
    """
    return read_hashed(path)[0]


def read_hashed(path: Path) -> tuple[str, str]:
    """As `read_text`, with the SHA-256 of the file's bytes.

    Returns
    -------
    text, digest : str

    Raises
    ------
    CaseError
        As `read_text`.
    """
    name = str(path)
    data = read_regular(path, MOST.case_bytes, "keep only the case itself")
    text = decoded(data, name, "a UTF-8 text file is needed")
    if not text.strip():
        raise CaseError(name, "", "is empty; `trajgap new` writes a file to start from")
    return text.replace("\r\n", "\n").replace("\r", "\n"), sha256(data).hexdigest()


def decoded(data: bytes, name: str, wanted: str) -> str:
    """Text of a file without a byte order mark.

    Parameters
    ----------
    wanted : str
        What to give instead of a binary file, for the message.

    Raises
    ------
    CaseError
        If it is a binary file or not UTF-8.
    """
    if b"\0" in data:
        raise CaseError(name, "", f"is a binary file; {wanted}")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise CaseError(name, f"line {line}", "is not UTF-8 text; save the file as UTF-8") from None


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """Parse TOML, numbers with a point as Decimal.

    Parameters
    ----------
    file : str
        Name for error messages.

    Raises
    ------
    CaseError
        If the text is not TOML, is nested too deeply, or contains a number out of range.
    """
    try:
        return tomllib.loads(text, parse_float=Decimal)
    except tomllib.TOMLDecodeError as error:
        what, _, place = str(error).partition(" (at ")
        reason = f"not valid TOML, {what[:1].lower()}{what[1:]}"
        raise CaseError(file, place.rstrip(")"), f"{reason}; correct the syntax") from None
    except RecursionError:
        raise CaseError(file, "", "is nested too deeply; flatten it") from None
    except (ArithmeticError, ValueError):
        raise CaseError(file, "", "holds a number that is out of range; shorten it") from None
