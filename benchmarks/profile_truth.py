"""Shortest profiles by ruckig, which shares no code with the judge, and numbers of them.

Where speeding up and braking have limits of their own, the profile is found from the way that a
peak speed passes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np
import ruckig
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]
Phase = tuple[float, float, float]
"""A time, and acceleration and jerk at its start."""


class UnfitError(Exception):
    """No profile joins what was drawn, or it cannot carry the fault."""


def between(start: Array, finish: Array, sizes: Array) -> list[Phase]:
    """The shortest motion between two states (position, velocity, acceleration) by ruckig."""
    asked, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
    for name, state in (("current", start), ("target", finish)):
        for quantity, value in zip(("position", "velocity", "acceleration"), state, strict=True):
            setattr(asked, f"{name}_{quantity}", [float(value)])
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = ([float(s)] for s in sizes[:3])
    try:
        result = ruckig.Ruckig(1).calculate(asked, found)
    except ruckig.RuckigError as error:
        raise UnfitError from error
    if result != ruckig.Result.Working:
        raise UnfitError
    one = found.profiles[0][0]
    return list(zip(one.t, one.a, one.j, strict=False))


def braking(way: float, first: float, last: float, sizes: Array) -> list[Phase]:
    """The shortest motion that slows down with another acceleration: one speed in between."""
    top, speeding, _, slowing = map(float, sizes)

    def ramp(u: float, v: float) -> Iterator[Phase]:
        for a, b in pairwise([u, 0.0, v] if u * v < 0 else [u, v]):
            size = speeding if abs(b) > abs(a) else slowing
            yield abs(b - a) / size, math.copysign(size, b - a), 0.0

    def passed(peak: float) -> float:
        return float(state([*ramp(first, peak), *ramp(peak, last)], math.inf, first)[0])

    if passed(-top) < way < passed(top):
        peak = brentq(lambda v: passed(v) - way, -top, top, xtol=1e-15, rtol=1e-15)
        return [*ramp(first, peak), *ramp(peak, last)]
    peak = math.copysign(top, way - passed(top))
    if way <= passed(-top):
        peak = -top
    cruise = (way - passed(peak)) / peak
    return [*ramp(first, peak), (cruise, 0.0, 0.0), *ramp(peak, last)]


def state(phases: list[Phase], time: float, speed: float = 0.0) -> Array:
    """Way, velocity and acceleration after a time."""
    now = np.array([0.0, speed, phases[0][1] if phases else 0.0])
    for length, a, j in phases:
        t = min(length, time)
        way, v = now[:2]
        now = np.array(
            [way + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j]
        )
        time -= length
        if time <= 0:
            break
    return now


def fourth(way: float, sizes: Array) -> float:
    """Total of two changes of speed that are S-curves within the next limits, and a cruise."""

    def rise(speed: float) -> float:
        ends = np.array([0.0, 0, 0]), np.array([speed, 0, 0])
        return sum(t for t, _, _ in between(*ends, sizes[1:]))

    top = float(sizes[0])
    if top * rise(top) <= way:
        return 2 * rise(top) + (way - top * rise(top)) / top
    speed = brentq(lambda v: v * rise(v) - way, 0.0, top, xtol=1e-15, rtol=1e-14)
    return 2 * rise(float(speed))


@dataclass(frozen=True)
class Inputs:
    """What a profile follows from, rad and s."""

    profile: str
    """As a case file names it; "braking" for a trapezoid with a limit of deceleration."""
    together: str
    """"straight" or "apart" of several joints, else empty."""
    points: Array
    """Shape (way-points, joints)."""
    ends: Array
    """Velocity and acceleration, shape (2, joints, 2)."""
    limits: Array
    """Velocity, acceleration, jerk, and snap or deceleration, shape (joints, 4)."""

    @cached_property
    def laws(self) -> list[tuple[Array, float, list[Phase]]]:
        """Of each segment: the joints' ways by unit of the law, its first speed and its phases."""
        found = []
        for step in np.diff(self.points, axis=0):
            if self.together == "straight":
                limits = (self.limits / np.abs(step)[:, None]).min(axis=0)
                found.append((step, 0.0, self._law(1.0, np.zeros((2, 2)), limits)))
            else:
                ends = self.ends[:, 0] if len(self.points) == 2 else np.zeros((2, 2))
                law = self._law(float(step[0]), ends, self.limits[0])
                found.append((np.ones(1), float(ends[0, 0]), law))
        return found

    def _law(self, way: float, ends: Array, limits: Array) -> list[Phase]:
        if self.profile == "braking":
            return braking(way, float(ends[0, 0]), float(ends[1, 0]), limits)
        own = limits.copy()
        if self.profile == "trapezoidal":
            own[2] = math.inf
        if self.profile == "sine-jerk":
            own[2] *= 2 / math.pi
        return between(np.array([0.0, *ends[0]]), np.array([way, *ends[1]]), own)

    @cached_property
    def total(self) -> float:
        if self.profile == "fourth-order":
            return sum(
                fourth(abs(float(way)), self.limits[0]) for way in np.diff(self.points[:, 0])
            )
        if self.together == "apart":
            alone = [
                [
                    replace(self, together="", points=pair[:, [j]], limits=self.limits[[j]]).total
                    for j in range(self.points.shape[1])
                ]
                for pair in zip(self.points[:-1], self.points[1:], strict=True)
                for pair in [np.array(pair)]
            ]
            return sum(map(max, alone))
        return sum(t for _, _, law in self.laws for t, _, _ in law)

    def at(self, time: float, joint: int) -> Array:
        """Position, velocity and acceleration of a joint."""
        for k, (step, speed, law) in enumerate(self.laws):
            length = sum(t for t, _, _ in law)
            if time <= length or k == len(self.laws) - 1:
                own = float(step[joint]) * state(law, time, speed)
                return own + np.array([self.points[k, joint], 0.0, 0.0])
            time -= length
        raise AssertionError

    def extreme(self, order: int, joint: int, which: Callable[[list[float]], float]) -> float:
        """The largest or smallest velocity or acceleration of a joint."""
        values = []
        for step, speed, law in self.laws:
            at = 0.0
            for t, a, j in law:
                turn = -a / j if j else 0.0
                if t > 0:
                    inside = [s for s in (turn,) if 0 < s < t and order == 1]
                    values += [state(law, at + s, speed)[1] * step[joint] for s in (0, *inside, t)]
                    if order == 2:
                        values[-2:] = [a * step[joint], (a + j * t) * step[joint]]
                at += t
        return float(which(values))

    @cached_property
    def parts(self) -> tuple[float, ...]:
        """Times of the three phases, and of jerk at the start and at the end."""
        ((_, _, law),) = self.laws
        sign = math.copysign(1.0, float(self.points[1, 0] - self.points[0, 0]))
        kept = [one for one in law if one[0] > 1e-9]
        pieces = []
        for k, (t, a, j) in enumerate(kept):
            turn = -a / j if j and 0 < k < len(kept) - 1 else 0.0
            for begin, end in pairwise([0.0, turn, t] if 0 < turn < t else [0.0, t]):
                pieces.append((end - begin, round(sign * (a + j * (begin + end) / 2), 9)))
        runs = [(side, sum(t for t, _ in own)) for side, own in groupby(pieces, _side)]
        lengths = dict(runs)
        if [side for side, _ in runs] not in ([1, -1], [1, 0, -1]):
            raise UnfitError
        return lengths[1], lengths.get(0, 0.0), lengths[-1], kept[0][0], kept[-1][0]


def _side(piece: tuple[float, float]) -> int:
    return int(np.sign(piece[1]))
