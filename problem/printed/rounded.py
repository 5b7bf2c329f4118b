"""Numbers as a paper prints them: digits that stand for an interval."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from ..errors import TrajgapError
from ..files import MOST

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
"""One decimal number; group 2 is the exponent."""
MINUS_SIGNS = str.maketrans({"\u2212": "-", "\u2013": "-", "\ufe63": "-", "\uff0d": "-"})
"""Minus signs that are printed or extracted, to the ASCII one."""
_INFINITE = ("inf", "+inf", "-inf", "infinity", "+infinity", "-infinity")
"""Words for what has no bound, as Python reads them."""


class Interval(NamedTuple):
    """Closed interval of exact rational numbers."""

    lower: Fraction
    upper: Fraction


def read_float(text: str) -> float:
    """Read a decimal number, or ``inf``, as float64.

    Parameters
    ----------
    text : str
        Digits as `Printed` reads them; or ``inf``, ``+inf``, ``-inf`` in upper or lower case.

    Raises
    ------
    TrajgapError
        If it is not a number, or so large that it would silently become infinite.

    Examples
    --------
    >>> read_float("-1.5e3"), read_float("inf")
    (-1500.0, inf)
    """
    word = _short(text)
    if word.lower() in _INFINITE:
        return float(word)
    if _NUMBER.fullmatch(word) is None:
        raise TrajgapError(f"{text[:40]!r} is not a number")
    found = float(word)
    if math.isinf(found):
        raise TrajgapError(f"{text[:40]!r} is beyond the range of float64")
    return found


def _short(text: str) -> str:
    """The characters of a number, of bounded length, with an ASCII minus sign."""
    word = text.strip().translate(MINUS_SIGNS)
    if len(word) > MOST.digits:
        raise TrajgapError(f"a number of {len(word)} characters; at most {MOST.digits} are read")
    return word


def down(number: Fraction) -> float:
    """Largest float that is not above ``number``."""
    nearest = float(number)
    return nearest if Fraction(nearest) <= number else math.nextafter(nearest, -math.inf)


def up(number: Fraction) -> float:
    """Smallest float that is not below ``number``."""
    return -down(-number)


@dataclass(frozen=True)
class Printed:
    """A number as printed.

    Raises
    ------
    TrajgapError
        If the text is not one finite decimal number.

    Examples
    --------
    >>> Printed("0.660").interval
    Interval(lower=Fraction(1319, 2000), upper=Fraction(1321, 2000))
    >>> Printed("0.66").upper
    0.665
    """

    text: str
    """The digits, for example ``"0.660"`` or ``"−1.6336"`` (any minus sign). The text is kept, with
    an ASCII minus sign."""
    exact: bool = False
    """Whether the number is exact. A printed number is not: it stands for every value that rounds
    to its digits."""

    def __post_init__(self) -> None:
        if not isinstance(self.text, str):
            raise TrajgapError(f"{self.text!r} is not text; printed digits are a string")
        text = _short(self.text)
        if not text:
            raise TrajgapError('is empty; write the printed digits, such as "0.660"')
        match = _NUMBER.fullmatch(text)
        if match is None:
            raise TrajgapError(
                f"{self.text!r} is not a finite decimal number; write the printed digits alone, "
                'such as "0.660"'
            )
        exponent = int(match[2][1:]) if match[2] else 0
        if abs(exponent) > MOST.exponent or Decimal(text).adjusted() > MOST.exponent:
            raise TrajgapError(
                f"{self.text!r} is out of range; magnitudes from 1e-{MOST.exponent} to "
                f"1e{MOST.exponent} are read"
            )
        object.__setattr__(self, "text", text)

    @classmethod
    def number(cls, number: int | Decimal) -> Printed:
        """Make an exact number with the digits as written.

        Raises
        ------
        TrajgapError
            If the number is not finite or out of range.
        """
        if isinstance(number, int) and number.bit_length() > 1000:
            raise TrajgapError("an integer of more than 300 digits is out of range")
        return cls(str(number), exact=True)

    @cached_property
    def decimal(self) -> Decimal:
        """The digits as a decimal number."""
        return Decimal(self.text)

    @property
    def value(self) -> float:
        """The printed number as a float."""
        return float(self.fraction)

    @cached_property
    def fraction(self) -> Fraction:
        """The printed number, exactly."""
        return Fraction(self.decimal)

    @cached_property
    def unit(self) -> Fraction:
        """One unit in the last printed place; 0 for an exact number."""
        if self.exact:
            return Fraction(0)
        return Fraction(10) ** int(self.decimal.as_tuple().exponent)

    @property
    def places(self) -> int:
        """Digits after the decimal point (negative if the last digit stands before it)."""
        return -int(self.decimal.as_tuple().exponent)

    @cached_property
    def interval(self) -> Interval:
        """Every value that rounds to the digits: half a unit of the last place either side.

        Both ends belong to it, because ties may round either way.
        """
        return Interval(self.fraction - self.unit / 2, self.fraction + self.unit / 2)

    @cached_property
    def truncated(self) -> Interval:
        """Every value whose further digits, simply cut off, leave the digits printed.

        For a printed zero that is one unit either side of it.
        """
        if self.fraction > 0:
            return Interval(self.fraction, self.fraction + self.unit)
        if self.fraction < 0:
            return Interval(self.fraction - self.unit, self.fraction)
        return Interval(-self.unit, self.unit)

    @property
    def lower(self) -> float:
        """Lower end of `interval`, rounded outwards; `value` for an exact number."""
        return self.value if self.exact else down(self.interval.lower)

    @property
    def upper(self) -> float:
        """Upper end of `interval`, rounded outwards; `value` for an exact number."""
        return self.value if self.exact else up(self.interval.upper)

    def one_digit_off(self) -> Iterator[Printed]:
        """The number with two neighbouring digits exchanged or one changed, in this order."""
        text = self.text
        places = [k for k, character in enumerate(text) if character.isdigit()]
        for one, other in pairwise(places):
            a, b = text[one], text[other]
            if a != b:
                yield Printed(f"{text[:one]}{b}{text[one + 1 : other]}{a}{text[other + 1 :]}")
        for at in reversed(places):
            for digit in "0123456789":
                if digit != text[at]:
                    yield Printed(f"{text[:at]}{digit}{text[at + 1 :]}")

    def slips(self) -> Iterator[Printed]:
        """The numbers that may have been meant if it contains one misprint.

        `one_digit_off`; ten times more or less, or the point put where none is printed; the other
        sign.
        """
        yield from self.one_digit_off()
        if "e" in self.text.lower() or not self.decimal:
            return
        digits = len(self.decimal.as_tuple().digits)
        for places in (1, -1) if "." in self.text else (1, *range(-1, -digits, -1)):
            yield Printed(f"{self.decimal.scaleb(places):f}")
        yield Printed(f"{-self.decimal:f}")

    def __str__(self) -> str:
        return self.text


_SIDES = {"lower": ROUND_FLOOR, "upper": ROUND_CEILING}
"""What is at least so much is rounded down, what is at most so much up; negative numbers too."""


def shown_bound(
    value: Fraction | float, side: str, *, digits: int | None = None, places: int | None = None
) -> str:
    """A lower or an upper bound as text that is a bound as well.

    Parameters
    ----------
    side : {"lower", "upper"}
        "lower" if something is at least the value, "upper" if it is at most the value.
    digits : int, optional
        Significant digits at most; zeros at the end are left out.
    places : int, optional
        Decimals, instead of `digits`; all of them are written.

    Returns
    -------
    str
        "inf" or "-inf" for an infinite value.

    Examples
    --------
    >>> shown_bound(4.0604, "lower", places=1), shown_bound(4.0604, "upper", places=1)
    ('4.0', '4.1')
    >>> shown_bound(Fraction(2, 3), "upper", digits=3)
    '0.667'
    """
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return str(value)
    # A float stands for the shortest decimal that reads as it, such as a printed end of 1.905.
    exact = Fraction(repr(float(value))) if isinstance(value, float) else Fraction(value)
    over, under = Decimal(exact.numerator), Decimal(exact.denominator)
    if places is None:
        found = Context(digits or 6, _SIDES[side]).divide(over, under).normalize()
        return f"{found:f}"
    # More digits than any double has before and after the point: nothing is rounded before the end.
    work = Context(400, _SIDES[side])
    found = work.divide(over, under).quantize(Decimal(1).scaleb(-places), _SIDES[side], work)
    return f"{found if found else abs(found):f}"
