"""Printed digits as numbers: which of the values that they stand for a problem takes, and all."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import tau

import numpy as np

from ..arrays import Array
from ..errors import TrajgapError
from ..printed import CUT_SLACK, Measured, Printed


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


@dataclass(frozen=True, eq=False)
class RoundingBox:
    """Printed numbers with bounds on all values that round to them.

    Parameters
    ----------
    value, lower, upper : array_like
        All of the same shape: durations (segments,), s, or way-points (way-points, joints), rad.

    Raises
    ------
    TrajgapError
        If the shapes differ, a number is not finite, or a value lies outside its bounds.
    """

    value: Array
    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        for name in ("value", "lower", "upper"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not self.value.shape == self.lower.shape == self.upper.shape:
            why = "value, lower and upper differ in shape; give all three the same shape"
            raise TrajgapError(f"box: {why}")
        if not all(np.isfinite(a).all() for a in (self.value, self.lower, self.upper)):
            raise TrajgapError("box: a number is not finite; give finite bounds")
        if (self.lower > self.value).any() or (self.value > self.upper).any():
            raise TrajgapError("box: a value lies outside its bounds; give lower ≤ value ≤ upper")

    @classmethod
    def of(cls, numbers: Iterable[Measured | Printed]) -> RoundingBox:
        """Box of printed numbers, shape (numbers,)."""
        ends = zip(*((one.value, one.lower, one.upper) for one in numbers), strict=True)
        return cls(*map(np.array, ends))

    @classmethod
    def exact(cls, value: Array) -> RoundingBox:
        """Box of width 0."""
        return cls(value, value, value)

    def inside(self) -> tuple[Array, Array]:
        """The box with its ends moved inwards by their own rounding errors."""
        step = 4.0 * np.maximum(np.spacing(np.abs(self.lower)), np.spacing(np.abs(self.upper)))
        step = np.where(self.upper - self.lower > 4.0 * step, step, 0.0)
        return self.lower + step, self.upper - step

    def or_cut_off(self) -> RoundingBox:
        """The box widened by the inputs whose further digits were cut off instead of rounded."""
        up, down = 2.0 * (self.upper - self.value), 2.0 * (self.value - self.lower)
        lower = np.where(self.value > 0, self.lower, self.value - down * CUT_SLACK)
        upper = np.where(self.value < 0, self.upper, self.value + up * CUT_SLACK)
        return RoundingBox(self.value, np.minimum(lower, self.lower), np.maximum(upper, self.upper))

    @property
    def steps(self) -> tuple[Array, Array]:
        """Least and largest size of each step from one row to the next."""
        low, high = self.lower[1:] - self.upper[:-1], self.upper[1:] - self.lower[:-1]
        near = np.maximum(np.maximum(low, -high), 0.0)
        return near, np.maximum(np.abs(low), np.abs(high))
