"""A printed number of a motion beside what the motion gives, and beside what digits leave open."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi
from typing import NamedTuple

import numpy as np

from ....problem import Array, Printed, TrajgapError
from ....problem.cases import RoundingBox
from ..rounding import Agreement, agreement, hull, meet

Meant = Callable[[Array, Array], dict[str, float]]
"""From way-points and durations to what a number may be, each in words."""
Boxes = tuple[RoundingBox, RoundingBox]
"""Durations, shape (segments,), and way-points, shape (way-points, joints)."""
SAMPLES = (50, 100, 200, 500, 1000)
"""Numbers of samples of which a paper may have taken a mean, with or without the last instant."""
_FACTORS = {
    180 / pi: "as between degrees and radians",
    1000.0: "as a thousandth of the unit",
    100.0: "as a hundredth of the unit",
    60.0: "as per minute instead of per second",
    2 * pi: "as turns instead of radians",
    30 / pi: "as turns per minute instead of radians per second",
}
"""Ratios between units that are mixed up, and what that would mean; their inverses count too."""
_LENGTH_FACTORS = {
    1000.0: "as a thousandth of the unit",
    100.0: "as a hundredth of the unit",
    10.0: "as between millimetres and centimetres",
    60.0: "as per minute instead of per second",
}
"""The same of joints that slide, whose numbers are not angles."""


FITS = (Agreement.ROUNDING, Agreement.CUT_OFF, Agreement.SAMPLING, Agreement.NORM)
"""The classes that accuse of nothing."""


@dataclass(frozen=True, eq=False)
class Beside:
    """A printed number beside one of the motion, all in the unit of the paper.

    Attributes
    ----------
    rounded, wide : tuple of float
        Ends of what the digits stand for, if they were rounded, and if they may be cut off.
    exact : float
        The motion's number, at the printed durations and way-points.
    reach : float
        Its change over all values that round to the printed digits: of first order, and where that
        does not reach the printed number the largest that is found, if it is larger.
    far : float
        The same over values that are cut off to the printed digits, which lie up to a whole last
        place away.
    sampled : tuple of float
        The least and the most that samples of that motion give.
    unit : str
        As a sentence writes it.
    joint : str or None
        Whose number it is; that of the robot if None.
    meaning : str
        Which of several numbers it may be, in words.
    norm : Beside, optional
        The same beside the largest norm over the joints, where one number speaks of several.
    linear : bool, optional
        Of a peak: whether its joint slides, so units explain a factor between the two.
    """

    printed: Printed
    rounded: tuple[float, float]
    wide: tuple[float, float]
    exact: float
    reach: float
    far: float
    sampled: tuple[float, float]
    unit: str
    joint: str | None = None
    meaning: str = ""
    norm: Beside | None = None
    linear: bool | None = None

    @property
    def met(self) -> bool:
        """Whether the motion's number rounds to the printed digits, all others as printed."""
        return self.rounded[0] <= self.exact <= self.rounded[1]

    @property
    def distance(self) -> float:
        """Relative distance of the printed number from that of the motion."""
        value = float(self.printed.fraction)
        if self.exact == 0.0:
            return 0.0 if value == 0.0 else np.inf
        return (value - self.exact) / self.exact

    @cached_property
    def kind(self) -> Agreement:
        """How the two lie beside each other, the most charitable first."""
        exact, far = self.exact, self.far
        around = exact - self.reach, exact + self.reach
        found = agreement(
            (Agreement.ROUNDING, self.rounded, around),
            (Agreement.CUT_OFF, self.wide, (exact - far, exact + far)),
            (Agreement.SAMPLING, self.wide, (self.sampled[0] - far, self.sampled[1] + far)),
        )
        if found is not Agreement.OFF:
            return found
        if self.norm is not None and self.norm.fits:
            return Agreement.NORM
        if self.root is not None:
            return Agreement.ROOT
        return Agreement.OFF if self.factor is None else Agreement.UNIT

    @property
    def fits(self) -> bool:
        """Whether nothing speaks against the printed number."""
        return self.kind in FITS

    @property
    def printed_there(self) -> bool:
        """Whether the motion's number is the printed one, its digits rounded or cut off."""
        return self.kind in (Agreement.ROUNDING, Agreement.CUT_OFF)

    @property
    def around(self) -> str:
        """The motion's number with what rounding may change of it."""
        # A reach below the last digit that is shown says nothing.
        near = self.reach < 5e-7 * abs(self.exact)
        return f"{self.exact:.6g}{'' if near else f' ± {self.reach:.1g}'} {self.unit}"

    def told(self, name: str) -> str:
        """A number of a motion by its name, with what is printed and how the two agree."""
        how = {
            Agreement.ROUNDING: "equal within the rounding of the printed digits",
            Agreement.CUT_OFF: "which fits if digits were cut off instead of rounded",
            Agreement.SAMPLING: f"which {SAMPLES[0]} or more samples of the motion give",
        }.get(self.kind)
        said = f"{name} is {self.exact:.6g} {self.unit}, printed as {self.printed}"
        return said if how is None else f"{said}, {how}"

    @property
    def root(self) -> int | None:
        """Whose square root a printed peak lacks, if with it the two agree within rounding."""
        if self.linear is None:
            return None
        around = self.exact - self.reach, self.exact + self.reach
        low, high = self.rounded
        # Closed forms of peaks hold them, such as 10/√3 of degree 5 and 84√5/25 of degree 7.
        found = (n for n in (2, 3, 5) if meet((n**0.5 * low, n**0.5 * high), around))
        return next(found, None)

    @property
    def factor(self) -> str | None:
        """What a ratio of peaks near that of two units would mean, if it is near one."""
        value = float(self.printed.fraction)
        if self.linear is None or not (self.exact > 0 and value > 0):
            return None
        return _meant_by_ratio(value / self.exact, self.linear)


def _meant_by_ratio(ratio: float, linear: bool) -> str | None:
    """The factor between two units that a positive ratio is near, and what it would mean, if any.

    Joints that slide have units of their own.
    """
    for factor, meaning in (_LENGTH_FACTORS if linear else _FACTORS).items():
        for one in (factor, 1 / factor):
            if abs(ratio / one - 1) <= 0.01:
                return f"{one:.6g}, {meaning}"
    return None


def nearest_number(
    printed: Printed,
    unit: str,
    joint: str | None,
    meant: Meant,
    samples: Sequence[Mapping[str, float]],
    boxes: Boxes,
    spread: tuple[float, float] = (0.0, 0.0),
) -> Beside:
    """A printed number beside the one that it is nearest to, of those that it may be.

    Parameters
    ----------
    unit : str
        Of the paper, as a sentence writes it.
    meant : callable
        In the unit of the paper.
    samples : sequence of dict
        What samples of the printed motion give instead, in the same words; may be empty.
    spread : tuple of float
        Further change that rounding allows, and that cut-off digits allow, in the unit of the
        paper.
    """
    middle, _, upper = flat(boxes)
    at_print = meant(*split(middle, boxes))
    reach = dict.fromkeys(at_print, 0.0)
    for moved in _each_moved(middle, upper):
        for words, number in meant(*split(moved, boxes)).items():
            reach[words] += abs(number - at_print[words])
    rounded, wide = (
        (float(one.lower), float(one.upper)) for one in (printed.interval, hull(printed))
    )
    tried = []
    for words, value in at_print.items():
        sampled = [one[words] for one in samples] or [value]
        near, far = reach[words] + spread[0], 2 * reach[words] + max(2 * spread[0], spread[1])
        ends = min(sampled), max(sampled)
        tried.append(Beside(printed, rounded, wide, value, near, far, ends, unit, joint, words))
    fitting = [one for one in tried if one.fits]
    if not fitting:
        for i, one in enumerate(tried):
            near, far = (_farthest(meant, one.meaning, boxes, share) for share in (1.0, 2.0))
            near, far = near + spread[0], far + max(2 * spread[0], spread[1])
            tried[i] = replace(one, reach=max(one.reach, near), far=max(one.far, far))
        fitting = [one for one in tried if one.fits]
    return min(fitting or tried, key=lambda one: abs(one.exact - float(printed.fraction)))


def flat(boxes: Boxes) -> tuple[Array, Array, Array]:
    """Numbers of two boxes in one array, as printed and at both ends: the durations first."""
    durations, waypoints = boxes
    middle, low, high = (
        np.append(getattr(durations, end), getattr(waypoints, end))
        for end in ("value", "lower", "upper")
    )
    return middle, low, high


def split(numbers: Array, boxes: Boxes) -> tuple[Array, Array]:
    """Way-points and durations that lie in one array, see `flat`."""
    durations, waypoints = np.split(numbers, [boxes[0].value.size])
    return waypoints.reshape(boxes[1].value.shape), durations


def _each_moved(numbers: Array, others: Array) -> Iterator[Array]:
    """The numbers with one of them in the place of its own, each in turn."""
    for k in range(numbers.size):
        moved = numbers.copy()
        moved[k] = others[k]
        yield moved


def _farthest(meant: Meant, words: str, boxes: Boxes, share: float) -> float:
    """Largest change of a number that is found in the rounding box, ``share`` as wide."""

    def number(at: Array) -> float:
        return meant(*split(at, boxes))[words]

    def look(at: Array, *ends: Array) -> Look:
        here = number(at)
        changes = []
        for end in ends:
            changes.append(np.full(at.size, np.nan))
            for k, moved in enumerate(_each_moved(at, end)):
                with suppress(TrajgapError):  # a duration that is not positive, or no curve
                    changes[-1][k] = number(moved) - here
        return Look(here, *changes)

    return largest_change(boxes, share, look)


class Look(NamedTuple):
    """A number at one place of the rounding box.

    Attributes
    ----------
    down, up : ndarray
        What it would change by if one printed number went to the lower or the upper end of its
        range while the others stay; not a number where that end has no curve.
    """

    value: float
    down: Array
    up: Array


def largest_change(
    boxes: Boxes, share: float, look: Callable[[Array, Array, Array], Look]
) -> float:
    """Largest change of a number that is found at corners of the rounding box, in its own unit.

    The first order at the printed numbers tells little where a segment lasts few units of its last
    digit. So every printed number goes to the end at which the number is better while the others
    stay, and from that corner again, upwards and downwards.

    Parameters
    ----------
    share : float
        How wide the box is: 1 for rounded digits, 2 for digits that may be cut off.
    look : callable
        Of a place and of the lower and the upper ends of the wider box, each as `flat` has them.
        May raise `TrajgapError` where there is no curve.
    """
    middle, low, high = flat(boxes)
    low, high = middle + share * (low - middle), middle + share * (high - middle)
    widest, start = 0.0, look(middle, low, high)
    for side in (1.0, -1.0):
        at, here = middle, start
        # Six corners in turn, each way: a search of all 2ⁿ would not end.
        for _ in range(6):
            down, up = (
                np.where(np.isnan(change), -np.inf, side * change)
                for change in (here.down, here.up)
            )
            ahead = np.where(up > down, high, np.where(down > up, low, middle))
            if np.array_equal(ahead, at):
                break
            try:
                at, here = ahead, look(ahead, low, high)
            except TrajgapError:  # a duration that is not positive, or no curve
                break
            widest = max(widest, side * (here.value - start.value))
    return widest
