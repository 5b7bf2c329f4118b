"""Checks of algorithm settings at the door: types, ranges, nearest names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from enum import StrEnum

import numpy as np

from ..problem import TrajgapError

Reader = Callable[[object], object]
"""Returns the clean value of one setting, or raises with what was expected."""


def nearest(word: str, known: Iterable[str]) -> str:
    """Mend for an unknown word: the known one that is spelt most like it."""
    choices = list(known)
    close = get_close_matches(word, choices, n=1, cutoff=0.0)
    return f"did you mean {close[0]!r}?"


def _shown(value: object) -> str:
    return repr(str(value) if isinstance(value, str) else value)


def whole(least: int) -> Callable[[object], int]:
    """Reader of whole numbers from ``least`` on."""

    def read(value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise TrajgapError(f"expected a whole number of {least} or more, got {_shown(value)}")
        return int(value)

    return read


def _as_float(value: object) -> float:
    """Float of a number; NaN of anything else, and of an integer beyond the range of floats."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.nan


def number(*, positive: bool = False, infinite: bool = False) -> Reader:
    """Reader of numbers of 0 or more, or above 0; infinite only if allowed."""
    wanted = "a positive number" if positive else "a number of 0 or more"

    def read(value: object) -> float:
        clean = _as_float(value)
        if not (clean > 0 if positive else clean >= 0) or (math.isinf(clean) and not infinite):
            raise TrajgapError(f"expected {wanted}, got {_shown(value)}")
        return clean

    return read


def above(bound: float) -> Reader:
    """Reader of finite numbers above a bound."""

    def read(value: object) -> float:
        clean = _as_float(value)
        if not (clean > bound and math.isfinite(clean)):
            raise TrajgapError(f"expected a number above {bound:g}, got {_shown(value)}")
        return clean

    return read


def share(*, ends: bool = True) -> Reader:
    """Reader of numbers from 0 to 1, the ends included or not."""
    wanted = "a number from 0 to 1" if ends else "a number between 0 and 1"

    def read(value: object) -> float:
        clean = _as_float(value)
        if not (0 <= clean <= 1 if ends else 0 < clean < 1):
            raise TrajgapError(f"expected {wanted}, got {_shown(value)}")
        return clean

    return read


def interval() -> Reader:
    """Reader of two finite numbers in ascending order."""

    def read(value: object) -> tuple[float, float]:
        if isinstance(value, list | tuple) and len(value) == 2:
            low, high = map(_as_float, value)
            if math.isfinite(low) and math.isfinite(high) and low <= high:
                return low, high
        raise TrajgapError(f"expected two numbers, the smaller first, got {_shown(value)}")

    return read


def choice(options: type[StrEnum]) -> Reader:
    """Reader of one of the words of an enumeration."""

    def read(value: object) -> StrEnum:
        words = [str(option) for option in options]
        if not isinstance(value, str):
            raise TrajgapError(f"expected one of {', '.join(words)}, got {_shown(value)}")
        if value not in words:
            raise TrajgapError(f"{_shown(value)} is unknown; {nearest(value, words)}")
        return options(value)

    return read


def clean(settings: object, kind: str, readers: Mapping[str, Reader]) -> None:
    """Replace the fields of a frozen record by their clean values.

    Raises
    ------
    TrajgapError
        One line: the algorithm's kind, the field, what was expected and what came.
    """
    for name, read in readers.items():
        try:
            value = read(getattr(settings, name))
        except TrajgapError as error:
            raise TrajgapError(f"{kind}: {name}: {error}") from None
        object.__setattr__(settings, name, value)


def reject(kind: str, name: str, reason: str) -> TrajgapError:
    """Error for a field whose value contradicts another one."""
    return TrajgapError(f"{kind}: {name}: {reason}")
