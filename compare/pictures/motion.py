"""Pictures of a motion over time: one of ours, or one from elsewhere, with limits and peaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

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
    half_range,
    is_linear,
)
from ...problem.motions import (
    BRAKING,
    ORDERS,
    JointLimits,
    Motion,
    MotionCheck,
    Samples,
    factors_of,
    neighbours,
)
from ..documents import si_unit
from .drawing import INK, ORANGE, RED, Picture, shown
from .panels import (
    POINTS,
    Line,
    Mark,
    Stretches,
    Unit,
    Units,
    beyond,
    joined_stretches,
    panels_picture,
    sampled,
    thinned,
    without,
)


def _few(times: Array) -> bool:
    """Whether each sample or piece is marked: more would hide the curve."""
    return times.size <= 60


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
    """Angle, velocity, acceleration (and jerk and snap, if limited) over time, one row per joint.

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
        free = None if nodal is None else np.asarray(nodal, dtype=np.float64)
        motion = fit(problem.curve, problem.waypoints, h, free)
        rows = [(motion, j) for j in range(joints)]
    else:
        rows = [
            (fit(one.curve, one.waypoints, h[j]), 0)
            for j, one in enumerate(map(problem.joint, range(joints)))
        ]
    higher = np.flatnonzero(problem.limits.limited[:, 2:].any(axis=0))
    orders = [0, 1, 2, *(3 + higher).tolist()]
    names = ("position", *problem.limits.quantities)
    lines = [
        [_line(problem, *rows[j], j, r, shown_in(units, problem, j, names[r])) for r in orders]
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


def _line(
    problem: Problem, trajectory: Trajectory, column: int, joint: int, order: int, unit: Unit
) -> Line:
    limits = problem.limits
    if order:
        low, high = (limits.sides[:, joint, order - 1] * (-1, 1)).tolist()
    else:
        low, high = float(limits.position_lower[joint]), float(limits.position_upper[joint])
    times, values = sampled(trajectory, column, order)
    own = np.empty(0), np.empty(0)
    marks = []
    if order:
        top = max(extrema(trajectory, column, order), key=lambda e: abs(e.value))
        limit = low if top.value < 0 else high  # on its side
        ratio = top.value / limit if limit else np.inf
        broken = abs(top.value) > abs(limit) * (1 + TOLERANCE)
        colour = RED if broken else INK
        marks.append(Mark(top.time, top.value, limit, ratio, low == -high, colour))
    else:
        at = trajectory.breaks[list(problem.curve.waypoint_breaks)]
        own = at, problem.waypoints[:, joint]
    return Line(
        joint=problem.joints[joint],
        quantity=("position", *limits.quantities)[order],
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


def checked_picture(
    content: Motion | Samples,
    limits: JointLimits,
    found: MotionCheck,
    *,
    title: str,
    units: Sequence[str] = ("rad",),
) -> Picture:
    """Position, velocity, acceleration and jerk of a motion from elsewhere, one row per joint.

    Limits are dashed. Red is what surely breaks a limit, or jumps; orange is what may break one, by
    what the numbers may be off by. `content`: of samples, dots show what neighbours prove; nothing
    is drawn between them. `limits`: for the same joints in the same order. `found`: the verdict on
    this motion, or on every motion through these samples. `units`: of positions, one for all joints
    or one each: rad, deg, m, cm or mm.
    """
    each = [*units] * (len(content.joints) if len(units) == 1 else 1)
    factors = factors_of(units, len(content.joints), "units").tolist()
    rows = []
    for j, (unit, factor) in enumerate(zip(each, factors, strict=True)):
        row = _Row(content.joints[j], j, limits, found, unit, factor)
        if isinstance(content, Samples):
            rows.append([row.dots(content, r) for r in range(4)])
        else:
            # Turning points of one joint at a time: those of all would fill the memory.
            alone = np.ascontiguousarray(content.scaled[:, :, j : j + 1])
            degrees = (content.scaled.shape[1] - 1,) * content.pieces
            trajectory = Trajectory(content.durations, alone, degrees)
            rows.append([row.curve(content, trajectory, r) for r in range(4)])
    if isinstance(content, Samples):
        of, times, points = "every motion through the samples", content.time, "○ sample"
    else:
        of, times, points = "for all t", content.breaks, "○ point of the file"
    span = float(times[0]), float(times[-1])
    note = f"   ·   {of}: {found.verdict}"
    signs = (points, "● nearest to a limit") if _few(times) else ("● nearest to a limit",)
    return panels_picture(rows, title, signs, note, span)


@dataclass(frozen=True)
class _Row:
    """One joint: its limits, what was found of it, and its unit."""

    label: str
    joint: int
    limits: JointLimits
    found: MotionCheck
    unit: str
    factor: float

    def curve(self, motion: Motion, trajectory: Trajectory, order: int) -> Line:
        """A derivative of a motion that is known for all t."""
        start = float(motion.breaks[0])
        times, values = sampled(trajectory, 0, order)
        error = motion.error[:, order, self.joint]
        low, high, braking = self._kept(order)
        broken, unsure = (
            [
                (start + t0, start + t1)
                for t0, t1 in beyond(trajectory, 0, order, low, high, slack, braking)
            ]
            for slack in (error, -error)
        )
        jumps = [
            (one.time, one.time)
            for one in self.found.jumps
            if (one.joint, one.quantity) == (self.label, ORDERS[order]) and self._serious(order)
        ]
        line = self._line(order, start + times, values, [*broken, *jumps], unsure)
        if not _few(motion.breaks):
            return replace(line, jumps=bool(jumps))
        ends = np.append(trajectory.derivatives(0)[0, :, 0], trajectory.edges(0)[1][-1, 0])
        points = line.points if order else (motion.breaks, ends)
        return replace(line, jumps=bool(jumps), points=points, breaks=motion.breaks)

    def dots(self, samples: Samples, order: int) -> Line:
        """What samples prove of a derivative; nothing if they are too inexact for the limit."""
        times, values, errors = (
            one if one.ndim == 1 else one[:, self.joint] for one in neighbours(samples, order)
        )
        low, high, braking = self._kept(order)
        if np.isfinite(braking):
            low, high = min(low, -braking), max(high, braking)
        sizes = [abs(x) for x in (low, high) if np.isfinite(x)]
        told = np.isfinite(values)
        if sizes and order:
            told &= errors <= max(sizes)
        times, values = times[told], values[told]
        errors = np.nan_to_num(errors[told], nan=np.finfo(np.float64).max)
        gap = (samples.time[-1] - samples.time[0]) / POINTS
        broken, unsure = (
            joined_stretches(
                [(t, t) for t in times[(values < low - slack) | (values > high + slack)].tolist()],
                gap,
            )
            for slack in (errors, -errors)
        )
        line = replace(self._line(order, *thinned(times, values), broken, unsure), dots=True)
        if order or not _few(samples.time):
            return line
        return replace(line, points=(samples.time, samples.position[:, self.joint]))

    def _line(
        self, order: int, times: Array, values: Array, broken: Stretches, unsure: Stretches
    ) -> Line:
        braking = float(self.limits.deceleration[self.joint]) if order == 2 else np.inf
        return Line(
            joint=self.label,
            quantity=ORDERS[order],
            linear=is_linear(self.unit),
            unit=(self.unit + ("", "/s", "/s²", "/s³")[order], self.factor),
            times=times,
            values=values,
            limits=(*self._range(order), -braking, braking),
            marks=self._marks(order, times, values),
            broken=broken,
            unsure=without(unsure, broken, self.found.total_time / POINTS),
        )

    def _range(self, order: int) -> tuple[float, float]:
        return (
            float(self.limits.lower[self.joint, order]),
            float(self.limits.upper[self.joint, order]),
        )

    def _kept(self, order: int) -> tuple[float, float, float]:
        """What counts as kept: the range with its tolerance, and the limit of a deceleration."""
        low, high = self._range(order)
        tolerance = self.found.tolerance
        spare = [
            tolerance * (abs(x) if order else half_range(low, high, x)) if np.isfinite(x) else 0.0
            for x in (low, high)
        ]
        braking = float(self.limits.deceleration[self.joint]) if order == 2 else np.inf
        return low - spare[0], high + spare[1], braking * (1 + tolerance)

    def _serious(self, order: int) -> bool:
        """Whether a jump is a fault: that of an acceleration only if jerk is limited."""
        return order < 2 or bool(np.isfinite(self._range(3)).any())

    def _marks(self, order: int, times: Array, values: Array) -> list[Mark]:
        """Where the derivative comes nearest to its limits, or its largest value without one."""
        names = (ORDERS[order], BRAKING) if order == 2 else (ORDERS[order],)
        peaks = [p for p in self.found.peaks if p.joint == self.label and p.quantity in names]
        low, high = self._range(order)
        both = low == -high and len(peaks) < 2
        kept = 1 + self.found.tolerance
        marks = []
        for one in sorted(peaks, key=lambda p: -p.ratio):
            colour = RED if one.least_ratio > kept else ORANGE if one.most_ratio > kept else INK
            marks.append(Mark(one.time, one.value, one.limit, one.ratio, both, colour))
        if not marks and times.size:
            k = int(np.nanargmax(np.abs(values)))
            marks.append(Mark(float(times[k]), float(values[k]), np.inf, 0.0, False))
        return marks
