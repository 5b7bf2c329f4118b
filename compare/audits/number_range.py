"""A number of profiles over all that rounds to the printed digits, and where it jumps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...problem import Array
from .profile_motions import ProfileMotion
from .rounding import ROUNDING, Ends, meet


@dataclass(frozen=True)
class NumberRange:
    """A number of a profile at the printed numbers, and at all others that digits leave.

    Attributes
    ----------
    others : ndarray
        In order.
    jump : tuple of float or None
        The two values between which it jumps; None if it changes gradually.
    """

    plain: float
    others: Array
    jump: tuple[float, float] | None = None

    @classmethod
    def of(
        cls,
        every: Sequence[ProfileMotion],
        number: Callable[[ProfileMotion], Iterable[float]],
        gradual: bool = True,
    ) -> NumberRange:
        """A number of the printed motion, the first, and of all others.

        Parameters
        ----------
        gradual : bool
            Whether a motion changes it without a jump.
        """
        found = [(value, one) for one in every for value in number(one)]
        plain = found[0][0]
        found.sort(key=lambda pair: pair[0])
        jump = _jump(found, number, gradual)
        return cls(plain, np.sort([*(value for value, _ in found), *(jump or ())]), jump)

    def meets(self, printed: Ends) -> bool:
        """Whether a printed interval holds a value, each side of a jump by itself."""
        parts = [self.others]
        if self.jump is not None:
            low = self.others <= self.jump[0]
            parts = [self.others[low], self.others[~low]]
        for part in parts:
            # As much again, because corners need not be the extremes of a curved function.
            width = float(part[-1] - part[0]) + ROUNDING * float(np.abs(part).max())
            if meet(printed, (part[0] - width, part[-1] + width)):
                return True
        return False

    def spans(self, printed: Ends) -> bool:
        """Whether a printed interval lies among the values, where they jump over it."""
        return meet(printed, (self.others[0], self.others[-1]))


def _jump(
    found: Sequence[tuple[float, ProfileMotion]],
    number: Callable[[ProfileMotion], Iterable[float]],
    gradual: bool,
) -> tuple[float, float] | None:
    """The values on both sides of the widest gap, where inputs are brought together over it.

    It is None if that closes the gap. Values stand in order, each with its motion.
    """
    gaps = np.diff([value for value, _ in found])
    if not len(gaps):
        return None
    at = int(np.argmax(gaps))
    # A jump: values for numerically equal inputs differ by more than one per cent.
    least = 0.01 * abs(found[0][0])
    if gaps[at] <= max(0.5 * gaps.sum(), least):
        return None
    low, high = found[at : at + 2]
    middle = (low[0] + high[0]) / 2.0
    # Brought halfway together forty times, two inputs differ by rounding only.
    for _ in range(40):
        between = low[1].asked(low[1].question.halfway(high[1].question))
        if between is None:
            break
        values = [*number(between)]
        if min(values) <= middle < max(values):
            # The number is of some time, in which it changes.
            return None if gradual else (low[0], high[0])
        if values[0] <= middle:
            low = max(values), between
        else:
            high = min(values), between
    return (low[0], high[0]) if high[0] - low[0] > least else None
