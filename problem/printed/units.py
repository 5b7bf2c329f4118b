"""The one place where units are converted: printed units to radians, seconds and metres."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Literal, get_args

from ..errors import TrajgapError
from .rounded import Printed, down, up

Quantity = Literal["position", "velocity", "acceleration", "jerk", "snap", "time"]
AngleUnit = Literal["rad", "deg"]
LengthUnit = Literal["m", "cm", "mm"]
"""Of links, of positions of the end, and of joints that slide."""

_POSITIONS = (*get_args(AngleUnit), *get_args(LengthUnit))
"""Units of what a joint's variable may be."""
CHOICES = MappingProxyType(
    {
        "position": _POSITIONS,
        "velocity": (
            *("rad/s", "deg/s", "rpm", "deg/min", "rad/min"),
            *("m/s", "cm/s", "mm/s", "m/min", "cm/min", "mm/min"),
        ),
        "acceleration": tuple(f"{unit}/s^2" for unit in _POSITIONS),
        "jerk": tuple(f"{unit}/s^3" for unit in _POSITIONS),
        "snap": tuple(f"{unit}/s^4" for unit in _POSITIONS),
        "time": ("s", "ms", "min"),
    }
)
"""The units known for each quantity."""

_PI_DIGITS = "3.14159265358979323846264338327950288419716939937510"
"""π cut after 50 decimals."""
_PI = (Fraction(_PI_DIGITS), Fraction(_PI_DIGITS) + Fraction(1, 10**50))
"""Rational bounds of π, 1e-50 apart."""


@dataclass(frozen=True)
class Scale:
    """Exact factor ``rational · π**pi`` from a printed unit to radians, seconds and metres."""

    rational: Fraction
    pi: int = 0

    @property
    def bounds(self) -> tuple[Fraction, Fraction]:
        """Rational bounds of the factor, relative width below 1e-49 (0 without π)."""
        if not self.pi:
            return (self.rational, self.rational)
        return (self.rational * _PI[0], self.rational * _PI[1])


_SCALES = MappingProxyType(
    {
        "rad": Scale(Fraction(1)),
        "deg": Scale(Fraction(1, 180), 1),
        "m": Scale(Fraction(1)),
        "cm": Scale(Fraction(1, 100)),
        "mm": Scale(Fraction(1, 1000)),
        "rpm": Scale(Fraction(2, 60), 1),
        "s": Scale(Fraction(1)),
        "ms": Scale(Fraction(1, 1000)),
        "min": Scale(Fraction(60)),
    }
)
"""Factor of every unit before a slash to radians, metres and seconds; a turn is 2π rad."""
_WRITTEN = (
    (r"[·⋅*.\s]+", ""),
    (r"revolutionsperminute|rev(?:olution)?s?(?:/|per)min(?:ute)?|r/min|1/min", "rpm"),
    ("°|degrees?", "deg"),
    ("radians?", "rad"),
    ("millimet(?:er|re)s?", "mm"),
    ("centimet(?:er|re)s?", "cm"),
    ("met(?:er|re)s?", "m"),
    ("milliseconds?|msecs?", "ms"),
    ("seconds?|secs?", "s"),
    ("minutes?|mins", "min"),
    ("per", "/"),
    ("s(?:\\^?[-−]|⁻)(1|2|3|4|¹|²|³|⁴)", r"/s\1"),
    ("min(?:\\^?[-−]1|⁻¹)", "/min"),
    ("¹", "1"),
    ("²", "2"),
    ("³", "3"),
    ("⁴", "4"),
    (r"\^", ""),
    ("(?<=/s)1", ""),
    ("(?<=/s)([234])", r"^\1"),
)
"""What papers write for the units of case files, as patterns in the order in which each is
replaced."""


def is_linear(unit: str) -> bool:
    """Whether a unit of a joint's position or of a derivative is one of length."""
    return unit.split("/")[0] in get_args(LengthUnit)


def shown_unit(unit: str) -> str:
    """A unit of case files as a sentence or a page writes it, such as ``°/s²``."""
    return unit.replace("deg", "°").replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


@lru_cache(maxsize=64)
def scale(unit: str) -> Scale:
    """Exact factor from ``unit`` to radians, metres and seconds.

    Parameters
    ----------
    unit : str
        One of the units in `CHOICES`.

    Raises
    ------
    TrajgapError
        If the unit is not known.

    Examples
    --------
    >>> scale("deg/s")
    Scale(rational=Fraction(1, 180), pi=1)
    """
    known = [one for choices in CHOICES.values() for one in choices]
    if unit not in known:
        raise TrajgapError(f"unknown unit {unit!r}; use one of {', '.join(known)}")
    measured, _, per = unit.partition("/")
    found = _SCALES[measured]
    return Scale(found.rational / 60, found.pi) if per == "min" else found


def check_unit(unit: object, quantity: Quantity) -> str:
    """Return ``unit`` if it measures ``quantity``.

    Parameters
    ----------
    unit : str
        Unit as written.
    quantity : str
        What it should measure.

    Raises
    ------
    TrajgapError
        If the unit is unknown or measures something else.
    """
    choices = CHOICES[quantity]
    if unit in choices:
        return str(unit)
    meant = unit_meant(unit)
    if meant in choices:
        raise TrajgapError(f"unknown unit {unit!r} for {quantity}; write it as {meant!r}")
    fix = f"use one of {', '.join(choices)}"
    for other, units in CHOICES.items():
        if unit in units:
            raise TrajgapError(f"{unit!r} measures {other}, not {quantity}; {fix}")
    raise TrajgapError(f"unknown unit {unit!r} for {quantity}; {fix}")


def unit_meant(unit: object) -> str:
    """A unit as case files write it, where a paper's way of writing it is known."""
    written = str(unit).lower()
    for pattern, plain in _WRITTEN:
        written = re.sub(pattern, plain, written)
    return written


CUT_SLACK = 1.0 + 1e-9
"""Factor by which doubled half-digits are widened, far above their rounding to floats."""


@dataclass(frozen=True)
class Measured:
    """A printed number in radians or metres and seconds: its value and the interval it stands for.

    ``lower`` and ``upper`` are rounded outwards, so the interval contains every value that
    has these digits. All three agree for an exact number.
    """

    value: float
    lower: float
    upper: float

    def cut_off(self) -> Measured:
        """The interval widened by every value whose further digits were cut off, not rounded."""
        # A little more than one unit of the last digit, whose own value is rounded.
        down_to = self.value - 2.0 * (self.value - self.lower) * CUT_SLACK
        up_to = self.value + 2.0 * (self.upper - self.value) * CUT_SLACK
        return Measured(
            self.value,
            self.lower if self.value > 0 else min(self.lower, down_to),
            self.upper if self.value < 0 else max(self.upper, up_to),
        )


@lru_cache(maxsize=4096)
def to_si(number: Printed, unit: str) -> Measured:
    """Convert a printed number to radians or metres and seconds.

    Parameters
    ----------
    number : Printed
        Digits as printed.
    unit : str
        The unit they are printed in.

    Returns
    -------
    Measured
        ``value`` is the float nearest to the exact product.

    Raises
    ------
    TrajgapError
        If the unit is not known or the result is too large for a float.

    Examples
    --------
    >>> to_si(Printed("80", exact=True), "deg/s").value
    1.3962634015954636
    """
    factor = scale(unit).bounds
    exact = number.fraction * factor[0]
    # Above 1e300 outward rounding could still overflow.
    if abs(exact) > Fraction(10) ** 300:
        raise TrajgapError("the number is too large; at most 1e300 is read")
    value = float(exact)
    if number.exact:
        return Measured(value, value, value)
    ends = [end * bound for end in number.interval for bound in factor]
    return Measured(value, down(min(ends)), up(max(ends)))


def from_si(value: float, unit: str) -> float:
    """Express a number given in radians or metres and seconds in another unit, for display.

    Parameters
    ----------
    value : float
        Number in radians or metres and seconds; infinities stay.
    unit : str
        The unit to show it in.

    Raises
    ------
    TrajgapError
        If the unit is not known.
    """
    factor = scale(unit).bounds[0]
    if not math.isfinite(value):
        return value
    return float(Fraction(value) / factor)
