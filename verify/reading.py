"""Strict reading: a file within bounds, then each value as the one type that it may have."""

from __future__ import annotations

import json
import os
import re
import stat
import time
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from .ranges import MOST_BYTES, MOST_DIGITS, MOST_TEXT

T = TypeVar("T")

_N = MOST_DIGITS
"""A short name for the pattern below."""
_NUMBER = re.compile(
    rf"-?\d{{1,{_N}}}(/[1-9]\d{{0,{_N - 1}}}|\.\d{{1,{_N}}})?(e-?\d{{1,2}})?", re.ASCII
)
"""An integer, a decimal or a quotient, perhaps with a power of ten; ASCII digits only."""
PACE = 3_000_000
"""Bytes of JSON that are read in a second: half of the slowest that was measured, millions of tiny
lists. Reading has no steps between which the clock could be looked at, so it is not begun where it
would end too late."""


class Refused(ValueError):
    """The file does not prove what it claims; the message says where."""


class OutOfTime(Exception):
    """The time limit has passed, and nothing is decided."""


class Clock:
    """The time that remains."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.end = time.monotonic() + seconds

    def __getstate__(self) -> tuple[float, float]:
        return self.seconds, self.left

    def __setstate__(self, state: tuple[float, float]) -> None:
        # Another machine counts from another moment: what was left when it was sent is left.
        self.seconds, left = state
        self.end = time.monotonic() + left

    def shorten(self, seconds: float) -> None:
        """Leave at most this many seconds from now on."""
        self.end = min(self.end, time.monotonic() + seconds)

    @property
    def left(self) -> float:
        """Seconds; negative once time is up."""
        return self.end - time.monotonic()

    def check(self, ahead: float = 0.0) -> None:
        """Stop if time is up, or if a stage of the given length would end later."""
        if time.monotonic() + ahead > self.end:
            raise OutOfTime

    def each(self, entries: Iterable[T]) -> Iterator[T]:
        """The entries one by one, with a look at the clock before each."""
        for entry in entries:
            self.check()
            yield entry


def need(condition: bool, reason: str) -> None:
    """Refuse the file unless a condition holds."""
    if not condition:
        raise Refused(reason)


def required(value: T | None, reason: str) -> T:
    """A value that must be there."""
    if value is None:
        raise Refused(reason)
    return value


# --- one value ------------------------------------------------------------------------------------


def fields(
    value: Any, what: str, names: Iterable[str], optional: Iterable[str] = ()
) -> dict[str, Any]:
    """An object with these keys, and no other."""
    need(type(value) is dict, f"malformed: {what} is not an object")
    missing = [key for key in names if key not in value]
    need(not missing, f"malformed: {what}: {', '.join(missing)}: missing")
    unknown = sorted(set(value) - {*names, *optional}, key=repr)
    need(not unknown, f"malformed: {what}: unknown key {shown(str(unknown[:1])[1:-1])}")
    return dict(value)


def listed(value: Any, what: str, most: int, least: int = 0) -> list[Any]:
    """A list with a bounded number of entries."""
    need(type(value) is list, f"malformed: {what}: no list")
    need(least <= len(value) <= most, f"malformed: {what}: not {least} to {most} entries")
    return list(value)


def exactly(value: Any, what: str, count: int, read: Callable[[Any], T]) -> list[T]:
    """A list with so many entries, each read by a function."""
    return [read(entry) for entry in listed(value, what, count, count)]


def text(value: Any, what: str) -> str:
    """A text of bounded length."""
    need(type(value) is str and len(value) <= MOST_TEXT, f"malformed: {what}: no text, or too long")
    return str(value)


def number(value: Any) -> Fraction:
    """A rational from its exact text: an integer, a decimal or a quotient."""
    if type(value) is not str or _NUMBER.fullmatch(value) is None:
        shape = f"no number of at most {MOST_DIGITS} digits"
        raise Refused(f"malformed: {shape}: {shown(repr(value))}")
    mantissa, _, exponent = value.partition("e")
    return Fraction(mantissa) * Fraction(10) ** int(exponent or 0)


def optional(value: Any) -> Fraction | None:
    """A rational, or nothing."""
    return None if value is None else number(value)


def whole(value: Any, low: int, high: int) -> int:
    """An integer within bounds; true and false are none."""
    if type(value) is not int or not low <= value <= high:
        raise Refused(f"malformed: no integer in {low}..{high}: {shown(repr(value))}")
    return value


def weights(value: Any, known: int, most: int) -> list[tuple[int, Any]]:
    """[row, weight, row, weight, …] as pairs: numbers of known rows, and weights as they stand."""
    flat = listed(value, "weights", 2 * most)
    need(len(flat) % 2 == 0, "malformed: weights come in pairs")
    return [(whole(row, 0, known - 1), w) for row, w in zip(flat[::2], flat[1::2], strict=True)]


def sign_of(value: Any) -> int:
    """1 or −1."""
    need(type(value) is int and value in (1, -1), "malformed: a sign is neither 1 nor -1")
    return int(value)


def shown(words: str, most: int = 80) -> str:
    """Text from a file for people: characters that could deceive are escaped, and it is short."""
    safe = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in words)
    return safe if len(safe) <= most else f"{safe[: most - 1]}…"


# --- the file -------------------------------------------------------------------------------------


def read_document(path: str | Path, clock: Clock | None = None) -> Any:
    """The JSON in a regular file of bounded size.

    Keys may not occur twice, and numbers are integers: readers could take either value of the
    one, and round the other.

    Parameters
    ----------
    path : str or Path
    clock : Clock, optional
        Without one there is no limit of time.

    Raises
    ------
    Refused
        In plain words.
    OutOfTime
        If a file of this size cannot be read in time.
    """
    try:
        content = _read(path, clock)
    except Refused:
        raise
    except OSError as error:
        raise Refused(f"cannot be read ({error.strerror}); check the path") from None
    except ValueError:
        raise Refused("cannot be read (no name of a file); check the path") from None
    try:
        return json.loads(
            content.decode(),
            object_pairs_hook=_once,
            parse_constant=_no_integer,
            parse_float=_no_integer,
        )
    except Refused:
        raise
    except (ValueError, RecursionError):
        raise Refused("no JSON; name a certificate") from None


def _read(path: str | Path, clock: Clock | None) -> bytes:
    # Without waiting, so a pipe that nobody writes to cannot hold us.
    number_ = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(number_, "rb") as file:
        about = os.fstat(number_)
        need(stat.S_ISREG(about.st_mode), "no regular file; name a certificate")
        need(about.st_size <= MOST_BYTES, f"larger than {MOST_BYTES} bytes; name a certificate")
        if clock is not None:
            clock.check(about.st_size / PACE)
        content = file.read(MOST_BYTES + 1)
    need(len(content) <= MOST_BYTES, f"larger than {MOST_BYTES} bytes; name a certificate")
    return content


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    need(len(found) == len(pairs), "the file names a key twice in one object")
    return found


def _no_integer(digits: str) -> NoReturn:
    raise Refused(f"malformed: {shown(digits)} is not an integer; other numbers are text")
