"""Rationals a little below others, with few digits: bounds that stay bounds when written."""

from __future__ import annotations

import math
from fractions import Fraction

ROOMS = tuple(10.0**-k for k in range(13, 6, -1))
"""Shares of its limits by which an answer is moved inside them until it is feasible, tried in turn:
from some roundings of a float to a tenth of the gap that is asked for by default."""


def up(value: Fraction, digits: int) -> Fraction:
    """The smallest decimal with this many digits that is not below a positive number."""
    places = digits - math.ceil(math.log10(max(float(value), 1e-12)))
    ten = Fraction(10) ** places
    return math.ceil(value * ten) / ten


def down(value: Fraction, digits: int) -> Fraction:
    """The largest decimal, with this many further digits, that is not above a number ≥ 0."""
    if value <= 0:
        return Fraction(0)
    first = Fraction(1)
    while value < first:
        first /= 10
    while value >= 10 * first:
        first *= 10
    step: Fraction = first / 10**digits
    steps = math.floor(value / step)
    return steps * step


def below(value: Fraction) -> Fraction:
    """The largest multiple of 2⁻³⁰ that is not above: times a total of days it fits a double."""
    return Fraction(math.floor(value * 2**30), 2**30)


def root_below(value: Fraction, order: int) -> Fraction:
    """A rational at most the root of a positive number, in 15 digits."""
    guess = float(value) ** (1 / order)
    digits = 15 - math.ceil(math.log10(guess))
    whole = math.floor(guess * 10.0**digits) + 8
    while Fraction(whole, 1) ** order > value * Fraction(10) ** (digits * order):
        whole -= 1
    return Fraction(whole / Fraction(10) ** digits)
