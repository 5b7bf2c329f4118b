"""How far a number moves within what the printed digits allow, from corner to corner."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....problem import Array, TrajgapError
from ..rounding import RoundingBox

_CORNERS = 6
"""Corners of the rounding box that are looked at in turn at most, each way; a search of all of its
2ⁿ corners would not end where there are many durations and way-points."""


class Look(NamedTuple):
    """A number at one place of the rounding box.

    Attributes
    ----------
    value : float
    down, up : ndarray
        What it would change by if one printed number went to the lower or the upper end of its
        range while the others stay, the durations first, then the way-points row by row; not a
        number where that end has no curve.
    """

    value: float
    down: Array
    up: Array


def largest_change(
    durations: RoundingBox,
    waypoints: RoundingBox,
    share: float,
    look: Callable[[RoundingBox, RoundingBox], Look],
) -> float:
    """Largest change of a number that is found at corners of the rounding box.

    The first order at the printed numbers tells little where a segment lasts few units of its last
    digit. So every printed number goes to the end at which the number is better while the others
    stay, and from that corner again, upwards and downwards.

    Parameters
    ----------
    durations : RoundingBox, shape (segments,)
    waypoints : RoundingBox, shape (way-points, joints)
    share : float
        How wide the box is: 1 for rounded digits, 2 for digits that may be cut off.
    look : callable
        Of durations and way-points; the value of each box is the place, its ends are those of the
        wider box. May raise `TrajgapError` where there is no curve.

    Returns
    -------
    float
        In the unit of the number.
    """
    middle, low, high = (
        np.append(getattr(durations, end), getattr(waypoints, end))
        for end in ("value", "lower", "upper")
    )
    low, high = middle + share * (low - middle), middle + share * (high - middle)
    segments, shape = durations.value.size, waypoints.value.shape

    def looked(at: Array) -> Look:
        h, q = (
            RoundingBox(*parts)
            for parts in zip(*(np.split(x, [segments]) for x in (at, low, high)), strict=True)
        )
        return look(h, RoundingBox(*(x.reshape(shape) for x in (q.value, q.lower, q.upper))))

    widest, start = 0.0, looked(middle)
    for side in (1.0, -1.0):
        at, here = middle, start
        for _ in range(_CORNERS):
            down, up = (
                np.where(np.isnan(change), -np.inf, side * change)
                for change in (here.down, here.up)
            )
            ahead = np.where(up > down, high, np.where(down > up, low, middle))
            if np.array_equal(ahead, at):
                break
            try:
                at, here = ahead, looked(ahead)
            except TrajgapError:  # a duration that is not positive, or no curve
                break
            widest = max(widest, side * (here.value - start.value))
    return widest
