"""Linear segments with parabolic blends: what their printed durations ask of the joints.

A joint moves at constant speed along each segment; around each way-point its speed changes at
constant acceleration, so that it passes via-points at a distance (Craig, *Introduction to
Robotics*, section 7.3). With steps Δ_k, durations h_k and blends τ_k around way-point k:

    v_k = Δ_k / h_k,    a_k = (v_{k+1} − v_k) / τ_k,    τ_{k−1}/2 + τ_k/2 ≤ h_k

At the ends two conventions are in use. Either the blends reach half beyond the first and the last
duration, and this is all; or they lie within them, and v_1 = Δ_1 / (h_1 − τ_0/2), likewise at the
finish, where the whole blend takes its part of the segment.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ...problem import Array
from .rounding import RoundingBox

_NO_SPEED = 1e300
"""Stands for the speed where none is high enough: no limit allows it, and sums of two stay
numbers."""


class EndBlends(StrEnum):
    """Where the first and the last blend lie."""

    BEYOND = "beyond"
    """Half of each before the first duration begins, and after the last one has ended."""
    WITHIN = "within"
    """Within the first and the last duration."""


@dataclass(frozen=True, eq=False)
class Between:
    """Bounds of numbers, in arrays of one shape; not rounded outwards."""

    low: Array
    high: Array

    def __add__(self, other: Between) -> Between:
        """Bounds of all sums."""
        return Between(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Between) -> Between:
        """Bounds of all differences, as if the numbers were independent."""
        return Between(self.low - other.high, self.high - other.low)

    def times(self, factor: float) -> Between:
        """Bounds of a multiple, the factor not negative."""
        return Between(factor * self.low, factor * self.high)

    def over(self, divisor: Between) -> Between:
        """Bounds of all quotients by numbers that are positive; none are known where some is not.

        A divisor that may be 0 or less leaves infinite bounds; what is 0 stays 0.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack(np.broadcast_arrays(
                self.low / divisor.low, self.low / divisor.high,
                self.high / divisor.low, self.high / divisor.high,
            ))  # fmt: skip
        sure = np.broadcast_to(divisor.low > 0, ends.shape[1:])
        low = np.where(sure, ends.min(axis=0), -np.inf)
        high = np.where(sure, ends.max(axis=0), np.inf)
        nothing = np.broadcast_to((self.low == 0) & (self.high == 0), ends.shape[1:])
        return Between(np.where(nothing, 0.0, low), np.where(nothing, 0.0, high))

    @property
    def size(self) -> Between:
        """Bounds of the absolute values."""
        through = (self.low <= 0) & (self.high >= 0)
        ends = np.abs(np.stack([self.low, self.high]))
        return Between(np.where(through, 0.0, ends.min(axis=0)), ends.max(axis=0))

    def __getitem__(self, key: int | slice) -> Between:
        """Bounds of some of the numbers."""
        return Between(self.low[key], self.high[key])


@dataclass(frozen=True, eq=False)
class Blended:
    """What a motion of linear segments with parabolic blends asks for.

    Attributes
    ----------
    velocity : Between, shape (segments, joints)
        Speeds along the segments, rad/s.
    acceleration : Between, shape (way-points, joints)
        Sizes within the blends, rad/s².
    room : Between, shape (segments, joints)
        What the blends leave of each segment, s; no such motion exists where it is negative.
    """

    velocity: Between
    acceleration: Between
    room: Between


def _stacked(parts: Sequence[Between]) -> Between:
    return Between(np.stack([p.low for p in parts]), np.stack([p.high for p in parts]))


def _ranges(box: RoundingBox) -> Between:
    return Between(box.lower, box.upper)


def _steps(waypoints: RoundingBox) -> Between:
    q = _ranges(waypoints)
    return q[1:] - q[:-1]


def by_blend_times(
    waypoints: RoundingBox, durations: RoundingBox, blends: RoundingBox, ends: EndBlends
) -> Blended:
    """What printed durations with printed durations of the blends ask for.

    Parameters
    ----------
    waypoints : RoundingBox, shape (way-points, joints)
        rad.
    durations : RoundingBox, shape (segments,)
        s.
    blends : RoundingBox, shape (way-points,)
        s.

    Returns
    -------
    Blended
        Bounds over all values in the boxes.
    """
    step, h, tau = _steps(waypoints), _ranges(durations), _ranges(blends)
    within = 1.0 if ends is EndBlends.WITHIN else 0.0
    n = len(durations.value)
    speeds, rooms = [], []
    for k in range(n):
        first, last = within * (k == 0), within * (k == n - 1)
        straight = h[k] - tau[k].times(0.5 * first) - tau[k + 1].times(0.5 * last)
        speeds.append(step[k].over(straight))
        left = h[k] - tau[k].times(0.5 + 0.5 * first) - tau[k + 1].times(0.5 + 0.5 * last)
        rooms.append(Between(*np.broadcast_arrays(left.low, left.high, step[k].low)[:2]))
    changes = _changes(speeds)
    sizes = [change.size.over(tau[k]) for k, change in enumerate(changes)]
    return Blended(_stacked(speeds), _stacked(sizes), _stacked(rooms))


def by_blend_accelerations(
    waypoints: RoundingBox, durations: RoundingBox, accelerations: RoundingBox, ends: EndBlends
) -> Blended:
    """What printed durations with a printed acceleration of the blends ask for.

    A blend takes what its change of speed needs. Within the first duration that is the shorter
    solution τ of a τ (h − τ/2) = |Δ|, and of a τ (h − τ) = |Δ| where there is one segment only.

    Parameters
    ----------
    waypoints, durations, ends
        As in `by_blend_times`.
    accelerations : RoundingBox, shape (joints,)
        rad/s², sizes; those of joints that move are positive.

    Returns
    -------
    Blended
        Bounds over all values in the boxes.
    """
    step, h, a = _steps(waypoints), _ranges(durations), _ranges(accelerations)
    n = len(durations.value)
    speeds = [step[k].over(h[k]) for k in range(n)]
    if ends is EndBlends.WITHIN:
        for k in {0, n - 1}:
            speeds[k] = _with_blend(step[k], h[k], a, both=n == 1)
    changes = [change.size for change in _changes(speeds)]
    blends = [change.over(a) for change in changes]
    rooms = []
    for k in range(n):
        shares = [0.5, 0.5]
        if ends is EndBlends.WITHIN:
            shares = [1.0 if k == 0 else 0.5, 1.0 if k == n - 1 else 0.5]
        rooms.append(h[k] - blends[k].times(shares[0]) - blends[k + 1].times(shares[1]))
    # Where the speed of a joint does not change, there is no acceleration.
    sizes = [
        Between(np.where(change.low > 0, a.low, 0.0), np.where(change.high > 0, a.high, 0.0))
        for change in changes
    ]
    return Blended(_stacked(speeds), _stacked(sizes), _stacked(rooms))


def _changes(speeds: Sequence[Between]) -> list[Between]:
    """Changes of speed at each way-point, from rest and to rest."""
    inner = [after - before for before, after in itertools.pairwise(speeds)]
    return [speeds[0], *inner, speeds[-1]]


def _with_blend(step: Between, h: Between, a: Between, both: bool) -> Between:
    """Speed along an end segment whose blend, or both, lie within its duration.

    With r = √(h² − c|Δ|/a), c = 2 or 4, the blend takes h − r, or half of that, and the speed is a
    times it: more for a longer way, and less for a longer duration or a larger acceleration, since
    the speed is |Δ| over what remains of the duration. Where no speed is high enough, none is
    known.
    """
    way = step.size

    def speed(ways: Array, length: Array, size: Array) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            c = 4.0 if both else 2.0
            root = np.sqrt(length**2 - c * ways / size)
            found = size * (length - root) * (0.5 if both else 1.0)
        return np.where(ways > 0, found, 0.0)

    least = speed(way.low, h.high, a.high)
    most = speed(way.high, h.low, a.low)
    # No root: no motion with these numbers, whatever its speed.
    size = Between(
        np.where(np.isnan(least), _NO_SPEED, least), np.where(np.isnan(most), _NO_SPEED, most)
    )
    forward, backward = step.low > 0, step.high < 0
    return Between(
        np.where(forward, size.low, -size.high), np.where(backward, -size.low, size.high)
    )
