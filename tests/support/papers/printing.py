"""Numbers to digits as papers print them, digits back to numbers, and a draft to a case file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import ROUND_CEILING, ROUND_DOWN, ROUND_HALF_EVEN, Decimal
from math import floor, log10, pi
from typing import Any

ROUNDINGS = {"round": ROUND_HALF_EVEN, "cut": ROUND_DOWN, "up": ROUND_CEILING}
"""How a printer may leave digits out."""
ANGLES = {"deg": pi / 180, "rad": 1.0}
"""Units of angles in radians."""
TIMES = {"s": 1.0, "ms": 1e-3}
"""Units of time in seconds."""
ORDERS = ("position", "velocity", "acceleration", "jerk")
"""Quantities by the order of the derivative."""


def printed(number: float, places: int, how: str = "round") -> str:
    """A number with so many decimals."""
    unit = Decimal(1).scaleb(-places)
    digits = Decimal(repr(float(number))).quantize(unit, rounding=ROUNDINGS[how])
    return format(digits if digits else abs(digits), "f")


def last_place(text: str) -> float:
    """One unit of the last digit."""
    return float(Decimal(1).scaleb(int(Decimal(text).as_tuple().exponent)))


def places_for(number: float, significant: int) -> int:
    """Decimals that show so many significant digits."""
    return 0 if number == 0 else max(0, significant - 1 - floor(log10(abs(number))))


def moved(text: str, steps: int) -> str:
    """The digits so many units of the last place further."""
    number = Decimal(text)
    return format(number + steps * Decimal(1).scaleb(int(number.as_tuple().exponent)), "f")


def numbers(texts: Iterable[str]) -> list[float]:
    """What digits say."""
    return [float(text) for text in texts]


def toml_value(value: Any) -> str:
    """A value of a case file."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + value.replace('"', "'") + '"'
    if isinstance(value, Bare):
        return value.text
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{k} = {toml_value(v)}" for k, v in value.items()) + " }"
    return repr(value)


class Bare:
    """A number that is meant exactly: it stands without quotes."""

    def __init__(self, text: str) -> None:
        self.text = text


def block(head: str, entries: dict[str, Any]) -> str:
    """A table of a case file."""
    return "\n".join([head, *(f"{k} = {toml_value(v)}" for k, v in entries.items())])
