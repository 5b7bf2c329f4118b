"""Pictures of a motion: angle and derivatives over time, with limits, peaks and way-points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...problem import (
    TOLERANCE,
    Array,
    Check,
    Problem,
    Trajectory,
    TrajgapError,
    extrema,
    fit,
)
from ...problem.motions import ORDERS
from ..documents import si_unit
from .drawing import INK, RED, Picture, shown
from .panels import Line, Mark, Unit, Units, panels_picture
from .traced import beyond, sampled


def motion_picture(
    problem: Problem,
    durations: ArrayLike,
    *,
    title: str,
    check: Check | None = None,
    note: str = "",
    nodal: ArrayLike | None = None,
    units: Units | None = None,
) -> Picture:
    """Angle, velocity, acceleration (and jerk, if limited) over time, one row per joint.

    Limits are dashed, largest values are marked at their exact places, and stretches beyond a limit
    are red. `durations`: shape (segments,) or (joints, segments), segment durations, s, shared by
    all joints or of each joint separately. `check`: its verdict is written below the picture.
    `note`: further words below the picture, such as the verdict over the rounding box. `nodal`:
    shape (free, joints), free derivatives of an under-determined interpolant. `units`: those of the
    paper, by joint and "position", "velocity" and so on; SI where one is missing.
    """
    h = np.asarray(durations, dtype=np.float64)
    joints = len(problem.joints)
    if h.shape not in ((problem.segments,), (joints, problem.segments)):
        raise TrajgapError(
            f"curves: expected durations of shape ({problem.segments},) or "
            f"({joints}, {problem.segments}), got {h.shape}"
        )
    if h.ndim == 1:
        motion = fit(problem.curve, problem.waypoints, h, _array(nodal))
        rows = [(motion, j) for j in range(joints)]
    else:
        rows = [
            (fit(one.curve, one.waypoints, h[j]), 0)
            for j, one in enumerate(map(problem.joint, range(joints)))
        ]
    orders = [0, 1, 2] + ([3] if np.isfinite(problem.limits.sides[:, :, 2]).any() else [])
    lines = [
        [_line(problem, *rows[j], j, r, shown_in(units, problem, j, ORDERS[r])) for r in orders]
        for j in range(joints)
    ]
    words = "" if check is None else f"   ·   for all t: {check.verdict}"
    words += f"   ·   {shown(note, 90)}" if note else ""
    longest = max(trajectory.total_time for trajectory, _ in rows)
    signs = ("○ way-point", "● largest value")
    return panels_picture(lines, title, signs, words, (0.0, longest))


def shown_in(units: Units | None, problem: Problem, joint: int, quantity: str) -> Unit:
    """The unit that a quantity of a joint is drawn in, and how much of SI one of it is."""
    own = (units or {}).get((problem.joints[joint], quantity))
    return own or (si_unit(quantity, problem.linear[joint]), 1.0)


def _array(values: ArrayLike | None) -> Array | None:
    return None if values is None else np.asarray(values, dtype=np.float64)


def _limits_of(problem: Problem, joint: int, order: int) -> tuple[float, float]:
    limits = problem.limits
    if order == 0:
        return float(limits.position_lower[joint]), float(limits.position_upper[joint])
    below, above = limits.sides[:, joint, order - 1].tolist()
    return -below, above


def _line(
    problem: Problem, trajectory: Trajectory, column: int, joint: int, order: int, unit: Unit
) -> Line:
    low, high = _limits_of(problem, joint, order)
    times, values = sampled(trajectory, column, order)
    own = np.empty(0), np.empty(0)
    marks = []
    if order:
        top = max(extrema(trajectory, column, order), key=lambda e: abs(e.value))
        marks.append(_largest(top.time, top.value, low, high))
    else:
        at = trajectory.breaks[list(problem.curve.waypoint_breaks)]
        own = at, problem.waypoints[:, joint]
    return Line(
        joint=problem.joints[joint],
        quantity=ORDERS[order],
        linear=problem.linear[joint],
        unit=unit,
        times=times,
        values=values,
        limits=(low, high),
        marks=marks,
        points=own,
        breaks=trajectory.breaks,
        broken=beyond(trajectory, column, order, low, high),
    )


def _largest(time: float, value: float, low: float, high: float) -> Mark:
    """The largest value beside the limit on its side."""
    limit = low if value < 0 else high
    ratio = value / limit if limit else np.inf
    broken = abs(value) > abs(limit) * (1 + TOLERANCE)
    return Mark(time, value, limit, ratio, low == -high, RED if broken else INK)
