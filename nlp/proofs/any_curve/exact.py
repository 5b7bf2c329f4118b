"""The question about all C1 curves in rational numbers, and motions proved to be answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..exact import ExactProblem, Real

_STRETCHES = (Fraction(0), *(Fraction(1, 10**k) for k in range(13, 6, -1)))
"""Shares by which a motion is stretched until it is feasible, as in `answer.prove_feasible`."""
_DIGITS = 16
"""Of durations and speeds in an answer: as many as a float has, so that cutting loses nothing."""

Number = Fraction | None


@dataclass(frozen=True)
class FreeQuestion:
    """What is left of a problem: joints that have to move and are limited, between way-points.

    Attributes
    ----------
    joints : tuple of int
        Their places in the problem.
    steps : tuple of tuple of Fraction
        [segment][joint], in the problem's unit of angle.
    loose, tight : tuple of tuple
        Per joint (velocity, acceleration) limit or None; upper and lower rational bounds of the
        limits, for the lower bound and for answers.
    shortest, longest : tuple of Fraction or None
        Duration bounds between way-points, s.
    ends : tuple of tuple of Fraction or None
        [0 start, 1 end][joint]: velocities prescribed there; None if free.
    """

    joints: tuple[int, ...]
    steps: tuple[tuple[Fraction, ...], ...]
    loose: tuple[tuple[Number, Number], ...]
    tight: tuple[tuple[Number, Number], ...]
    shortest: tuple[Fraction, ...]
    longest: tuple[Number, ...]
    ends: tuple[tuple[Number, ...], tuple[Number, ...]]

    def end(self, waypoint: int, joint: int) -> Number:
        """Velocity prescribed at a way-point; None if it is free there."""
        if waypoint == 0:
            return self.ends[0][joint]
        return self.ends[1][joint] if waypoint == len(self.steps) else None

    def speed(self, joint: int, cap: Fraction) -> Fraction:
        """Bound on the speed of a joint while the total is below ``cap``."""
        velocity, acceleration = self.loose[joint]
        if velocity is not None:
            return velocity
        assert acceleration is not None
        start = min(abs(v) for v in (side[joint] for side in self.ends) if v is not None)
        return start + acceleration * cap

    def floor(self, segment: int) -> Fraction:
        """Least duration of a segment: its lower bound, and no joint above its speed."""
        ways = [
            abs(step) / velocity
            for step, (velocity, _) in zip(self.steps[segment], self.loose, strict=True)
            if velocity is not None
        ]
        return max([self.shortest[segment], *ways])


def question(problem: ExactProblem) -> FreeQuestion:
    """Strip a problem of what does not matter for curves of any kind.

    Parameters
    ----------
    problem : ExactProblem
        Of the interpolant only the velocities prescribed at the two ends count. Limits of jerk and
        position are not looked at.

    Returns
    -------
    FreeQuestion
    """
    joints = [j for j in _restless(problem) if any(problem.limits[j][:2])]
    breaks = problem.curve.waypoint_breaks
    spans = [range(a, b) for a, b in pairwise(breaks)]

    def longest(span: range) -> Number:
        found = [problem.duration_upper[k] for k in span]
        return None if None in found else sum((x for x in found if x is not None), Fraction(0))

    def limits(side: Callable[[Real], Fraction]) -> tuple[tuple[Number, Number], ...]:
        pairs = [problem.limits[j][:2] for j in joints]
        return tuple(
            (None if v is None else side(v), None if a is None else side(a)) for v, a in pairs
        )

    points = problem.waypoints
    return FreeQuestion(
        tuple(joints),
        tuple(tuple(after[j] - before[j] for j in joints) for before, after in pairwise(points)),
        limits(lambda x: x.high),
        limits(lambda x: x.low),
        tuple(sum((problem.duration_lower[k] for k in s), Fraction(0)) for s in spans),
        tuple(longest(s) for s in spans),
        (
            tuple(problem.end_velocities(0)[j] for j in joints),
            tuple(problem.end_velocities(1)[j] for j in joints),
        ),
    )


def _restless(problem: ExactProblem) -> list[int]:
    """Joints that cannot simply stay where they are."""
    given = list(zip(*map(problem.end_velocities, (0, 1)), strict=True))
    columns = list(zip(*problem.waypoints, strict=True))
    return [j for j, column in enumerate(columns) if any(given[j]) or len(set(column)) > 1]


def missing(problem: ExactProblem) -> str | None:
    """Why no bound over all curves is computed for a problem, or None."""
    restless = _restless(problem)
    if not restless:
        return "nothing moves"
    for order, name in enumerate(("velocity", "acceleration")):
        for j in restless:
            limit = problem.limits[j][order]
            if limit is not None and limit.low <= 0:
                return f"joint {problem.joints[j]} moves, but its {name} limit is 0"
    asked = question(problem)
    if not asked.joints:
        return "nothing that moves is limited"
    for j, (velocity, _), (tight, _), *ends in zip(
        asked.joints, asked.loose, asked.tight, *asked.ends, strict=True
    ):
        given = [abs(v) for v in ends if v is not None]
        if velocity is None and not given:
            return f"joint {problem.joints[j]} has no velocity limit, and its ends are free"
        if tight is not None and any(v > tight for v in given):
            return f"a velocity prescribed at an end exceeds the limit of joint {problem.joints[j]}"
    for k, steps in enumerate(asked.steps):
        # In no time at all it may be passed at any speed, in however little time it may not.
        if not any(steps) and asked.shortest[k] == 0:
            return f"nothing moves in segment {k + 1}, whose duration may go to 0"
    return None


def unanswered(problem: ExactProblem) -> str | None:
    """Why feasible motions of a problem are not proved here, or None."""
    for j in _restless(problem):
        if problem.limits[j][2] is not None:
            return "jerk is limited: the bound holds, but motions are proved within v and a only"
        if problem.position_lower[j] is not None or problem.position_upper[j] is not None:
            return "position is limited: the bound holds, but motions are proved within v and a"
    for j, place in enumerate(problem.waypoints[0]):
        low, high = problem.position_lower[j], problem.position_upper[j]
        if (low is not None and low.high > place) or (high is not None and high.low < place):
            return f"joint {problem.joints[j]} is outside its position limits"
    return None


def _furthest(
    v0: Fraction, v1: Fraction, h: Fraction, velocity: Number, acceleration: Fraction
) -> Fraction:
    """Largest displacement in time h, as in `reach.furthest`."""
    p = (v0 + v1 + acceleration * h) / 2
    p = p if velocity is None else min(p, velocity)
    return p * h - ((p - v0) ** 2 + (p - v1) ** 2) / (2 * acceleration)


def keeps_limits(
    asked: FreeQuestion, durations: Sequence[Fraction], speeds: Sequence[Sequence[Fraction]]
) -> bool:
    """Whether some C1 motion passes the way-points with these durations and speeds, exactly.

    Parameters
    ----------
    asked : FreeQuestion
    durations : sequence of Fraction
        s.
    speeds : sequence of sequence of Fraction
        [way-point][joint]; not looked at for joints without an acceleration limit.

    Returns
    -------
    bool
    """
    for h, low, high in zip(durations, asked.shortest, asked.longest, strict=True):
        if h <= 0 or h < low or (high is not None and h > high):
            return False
    for j, (velocity, acceleration) in enumerate(asked.tight):
        for k, h in enumerate(durations):
            d = asked.steps[k][j]
            if acceleration is None:
                # Any mean speed strictly inside the limits leaves room for steep ramps.
                assert velocity is not None
                if not abs(d) < velocity * h:
                    return False
                continue
            v0, v1 = speeds[k][j], speeds[k + 1][j]
            if velocity is not None and max(abs(v0), abs(v1)) > velocity:
                return False
            if abs(v1 - v0) > acceleration * h:
                return False
            if not (
                -_furthest(-v0, -v1, h, velocity, acceleration)
                <= d
                <= _furthest(v0, v1, h, velocity, acceleration)
            ):
                return False
        if acceleration is not None:
            for at, side in zip((0, -1), asked.ends, strict=True):
                if side[j] is not None and speeds[at][j] != side[j]:
                    return False
    return True


def prove_motion(
    asked: FreeQuestion, durations: NDArray[np.float64], speeds: NDArray[np.float64]
) -> tuple[tuple[Fraction, ...], tuple[tuple[Fraction, ...], ...]] | None:
    """Rational durations and speeds near the given ones that some motion keeps, or None.

    Parameters
    ----------
    asked : FreeQuestion
    durations : ndarray, shape (segments,)
        s.
    speeds : ndarray, shape (way-points, joints)
        NaN where open.

    Returns
    -------
    tuple of (durations, speeds), or None
        Stretched by at most 1e-7.
    """
    for stretch in _STRETCHES:
        h = [
            max(_up(Fraction(float(x)) * (1 + stretch)), low)
            for x, low in zip(durations, asked.shortest, strict=True)
        ]
        h = [x if top is None else min(x, top) for x, top in zip(h, asked.longest, strict=True)]
        rows = []
        for at, row in enumerate(speeds):
            each = enumerate(zip(row, asked.tight, strict=True))
            rows.append(
                tuple(_speed(asked.end(at, j), v, stretch, limit) for j, (v, (limit, _)) in each)
            )
        if keeps_limits(asked, h, rows):
            return tuple(h), tuple(rows)
    return None


def _speed(end: Number, value: float, stretch: Fraction, limit: Number) -> Fraction:
    if end is not None:
        return end
    if math.isnan(value):
        return Fraction(0)
    exact = Fraction(value) / (1 + stretch)
    short = _digits(abs(exact), math.floor)
    short = short if limit is None else min(short, limit)
    return short if exact > 0 else -short


def _up(value: Fraction) -> Fraction:
    return _digits(value, math.ceil)


def _digits(value: Fraction, way: Callable[[Fraction], int]) -> Fraction:
    """A positive number cut to a few digits; 0 if it is next to nothing."""
    if value < Fraction(1, 10**30):
        return Fraction(0)
    digits = _DIGITS - math.ceil(math.log10(float(value)))
    ten = Fraction(10) ** digits
    return Fraction(way(value * ten)) / ten
