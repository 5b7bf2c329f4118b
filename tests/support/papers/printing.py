"""Numbers to digits as papers print them, and digits back to numbers."""

from decimal import ROUND_CEILING, ROUND_DOWN, ROUND_HALF_EVEN, Decimal
from math import floor, log10, pi

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
