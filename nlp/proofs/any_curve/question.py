"""The question about all C1 curves, by the verifier's own reading of it, and motions proved."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ....problem import Array
from ....verify import Clock, Refused, StatedProblem, check_motion, spans_of
from ..document import stated_problem
from ..exact import ExactProblem
from ..rounding import ROOMS, up

Bounds = tuple[Fraction, Fraction] | None
"""Rational bounds of a limit; None if there is none."""

Number = Fraction | None
Motion = tuple[tuple[Fraction, ...], tuple[tuple[Fraction, ...], ...]]
"""Durations between way-points, and the speeds of all joints at the way-points."""


@dataclass(frozen=True)
class FreeQuestion:
    """What is left of a problem: joints that have to move and are limited, between way-points.

    Attributes
    ----------
    stated : StatedProblem
        Within limits of velocity and acceleration alone.
    joints : tuple of int
        Their places in the problem.
    steps : list of list of Fraction
        [segment][joint], in the problem's unit of angle.
    velocity, acceleration : list of (low, high) or None
        Rational bounds of the limits.
    shortest, longest : list of Fraction or None
        Duration bounds between way-points, s.
    ends : list of list of Fraction or None
        [0 start, 1 end][joint]: velocities prescribed there; None if free.
    """

    stated: StatedProblem
    joints: tuple[int, ...]
    steps: list[list[Fraction]]
    velocity: list[Bounds]
    acceleration: list[Bounds]
    shortest: list[Fraction]
    longest: list[Number]
    ends: list[list[Number]]


def question(problem: ExactProblem) -> FreeQuestion:
    """Strip a problem of what does not matter for curves of any kind.

    From the interpolant, only the velocities prescribed at the two ends are used. Limits of jerk
    and position are ignored.
    """
    stated = stated_problem(problem)
    limits = [[*row[:2], None] for row in stated.limits]
    nowhere: list[Bounds] = [None] * stated.joints
    position = [nowhere, nowhere]
    alone = replace(stated, limits=limits, sides=[limits, limits], position=position)
    spans, restless = spans_of(alone), _restless(stated)
    joints = tuple(j for j in restless if any(limits[j]))
    return FreeQuestion(
        alone,
        joints,
        [[row[j] for j in joints] for row in spans.steps],
        [limits[j][0] for j in joints],
        [limits[j][1] for j in joints],
        spans.shortest,
        spans.longest,
        [[side[j] for j in joints] for side in stated.ends],
    )


def _restless(stated: StatedProblem) -> list[int]:
    """Joints that cannot simply stay where they are."""
    columns = list(zip(*stated.waypoints, strict=True))
    ends = list(zip(*stated.ends, strict=True))
    return [j for j, column in enumerate(columns) if any(ends[j]) or len(set(column)) > 1]


def missing(problem: ExactProblem) -> str | None:
    """Why no interval over all curves is computed for a problem, or None."""
    asked = question(problem)
    why = unbounded(problem, asked)
    if why is not None:
        return why
    for k, steps in enumerate(asked.steps):
        # In no time at all it may be passed at any speed, in however little time it may not.
        if not any(steps) and asked.shortest[k] == 0:
            return f"nothing moves in segment {k + 1}, whose duration may go to 0"
    return None


def unbounded(problem: ExactProblem, asked: FreeQuestion) -> str | None:
    """Why not even a lower bound is computed, or None."""
    restless = _restless(asked.stated)
    if not restless:
        return "nothing moves"
    for order, name in enumerate(("velocity", "acceleration")):
        for j in restless:
            limit = problem.limits[j][order]
            if limit is not None and limit.low <= 0:
                return f"joint {problem.joints[j]} moves, but its {name} limit is 0"
    if not asked.joints:
        return "nothing that moves is limited"
    for j, velocity, *ends in zip(asked.joints, asked.velocity, *asked.ends, strict=True):
        given = [abs(v) for v in ends if v is not None]
        if velocity is None and not given:
            return f"joint {problem.joints[j]} has no velocity limit, and its ends are free"
        if velocity is not None and any(v > velocity[0] for v in given):
            return f"a velocity prescribed at an end exceeds the limit of joint {problem.joints[j]}"
    return None


def keeps(stated: StatedProblem, motion: Motion) -> bool:
    """Whether some C1 motion with these durations and speeds is an answer, exactly."""
    durations, speeds = motion
    try:
        check_motion(stated, durations, [list(row) for row in speeds], Clock(math.inf))
    except Refused:
        return False
    return True


def prove_motion(asked: FreeQuestion, durations: Array, speeds: Array) -> Motion | None:
    """Rational durations and speeds near the given ones that some motion keeps, or None.

    Parameters
    ----------
    asked : FreeQuestion
    durations : ndarray, shape (segments,)
        s.
    speeds : ndarray, shape (way-points, joints)
        Of the joints that matter; NaN where open. Others stand still.

    Returns
    -------
    tuple of (durations, speeds), or None
        Stretched by at most 1e-7.
    """
    for stretch in map(Fraction, (0, *ROOMS)):
        h = [
            max(up(Fraction(float(x)) * (1 + stretch), 16), low)
            for x, low in zip(durations, asked.shortest, strict=True)
        ]
        h = [x if top is None else min(x, top) for x, top in zip(h, asked.longest, strict=True)]
        rows = []
        for at, row in enumerate(speeds):
            ends = asked.ends[0 if at == 0 else 1] if at in (0, len(h)) else [None] * len(row)
            full = [Fraction(0)] * asked.stated.joints
            for j, v, end, limit in zip(asked.joints, row, ends, asked.velocity, strict=True):
                full[j] = _speed(v, stretch, limit) if end is None else end
            rows.append(tuple(full))
        found = tuple(h), tuple(rows)
        if keeps(asked.stated, found):
            return found
    return None


def _speed(value: float, stretch: Fraction, limit: Bounds) -> Fraction:
    """A speed of a longer motion, cut to 16 digits."""
    if not np.isfinite(value) or abs(value) < 1e-30:
        return Fraction(0)
    exact = abs(Fraction(float(value))) / (1 + stretch)
    ten = Fraction(10) ** (16 - math.ceil(math.log10(float(exact))))
    short = math.floor(exact * ten) / ten
    short = short if limit is None else min(short, limit[0])
    return short if value > 0 else -short
