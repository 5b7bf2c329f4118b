"""A bound in few digits, rounded to the side on which it still holds."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

_SIDES = {"lower": ROUND_FLOOR, "upper": ROUND_CEILING}
"""What is at least so much is rounded down, what is at most so much up; negative numbers too."""
_WORK = 400
"""Digits of the quotient before it is cut to decimals: more than any double has before and after
the point, so no rounding comes before the last one."""


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
    work = Context(_WORK, _SIDES[side])
    found = work.divide(over, under).quantize(Decimal(1).scaleb(-places), _SIDES[side], work)
    return f"{found if found else abs(found):f}"
