"""Which of the values that printed digits stand for a problem takes."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from math import tau

import numpy as np

from ..arrays import Array
from ..printed import Measured


class Digits(StrEnum):
    """Which of the values that their printed digits stand for the limits and bounds take."""

    PRINTED = "printed"
    """The digits themselves."""
    TIGHTEST = "tightest"
    """Of all values that round to the digits those that allow least."""
    LOOSEST = "loosest"
    """Of all values that round to the digits those that allow most."""
    LOOSEST_CUT = "loosest, cut off"
    """The same, of all values whose digits were rounded or cut off."""


def turned(angle: Measured, turns: int) -> Measured:
    """An angle with whole turns added, in an interval that cutting off digits does not leave."""
    if not turns:
        return angle
    value = angle.value + turns * tau
    # On the far side of 0 cut-off digits would widen the wrong end, so both ends are widened here.
    half = 2.0 * max(angle.upper - angle.value, angle.value - angle.lower)
    slack = 4.0 * float(np.spacing(max(abs(value), abs(angle.value))))
    return Measured(value, value - half - slack, value + half + slack)


def end(numbers: Sequence[Measured], digits: Digits, upper: bool) -> Array:
    """The end of each number's interval that allows most, or least."""
    if digits is Digits.PRINTED:
        return np.array([n.value for n in numbers])
    if digits is Digits.LOOSEST_CUT:
        numbers = [n.cut_off() if np.isfinite(n.value) else n for n in numbers]
    if upper is (digits is Digits.TIGHTEST):
        return np.array([n.lower for n in numbers])
    return np.array([n.upper for n in numbers])
