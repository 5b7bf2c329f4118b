"""Pictures of a motion: angle and derivatives over time, with limits, peaks and way-points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...problem import (
    QUANTITIES,
    TOLERANCE,
    Array,
    Check,
    Extremum,
    Problem,
    Trajectory,
    TrajgapError,
    extrema,
    fit,
)
from ..documents import si_unit
from .drawing import BLUE, GRID, INK, PAPER, RED, Picture, drawing, finish, shown

_SAMPLES = 48
"""Points of a segment that are drawn, beside its exact extrema: smooth at the width of a page."""
_POINTS = 480
"""Points of a curve of many segments, extrema apart: more than a panel has pixels."""
_FEWEST = 8
"""Points of a segment at least, however many there are."""
Units: TypeAlias = Mapping[tuple[str, str], tuple[str, float]]
"""How a quantity of a joint is shown, by the joint's label and the quantity: the unit as it is
written, and how much of SI one of it is."""
_BESIDE = 0.02
"""Share of the time that is left free before and after it: markers at both ends are whole."""
_OFF_SCALE = 0.12
"""Share of a limit below which drawing the limit would flatten the curve."""


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

    Parameters
    ----------
    problem : Problem
    durations : array_like, shape (segments,) or (joints, segments)
        Segment durations, s, shared by all joints or of each joint by itself.
    title : str
    check : Check, optional
        Its verdict is written below the picture.
    note : str
        Further words below the picture, such as the verdict over the rounding box.
    nodal : array_like, shape (free, joints), optional
        Free derivatives of an under-determined interpolant.
    units : mapping, optional
        Those of the paper, by joint and "position", "velocity" and so on; SI where one is
        missing.

    Returns
    -------
    Picture
        Limits are dashed, largest values are marked at their exact places, and stretches beyond a
        limit are red.

    Raises
    ------
    TrajgapError
        If the durations have the wrong shape.
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
    description = "; ".join(
        _words(problem, *rows[j], j, r, shown_in(units, problem, j, _name(r)))
        for j in range(joints)
        for r in orders
        if r
    )
    with drawing():
        figure = Picture(title, description, 3.3 * len(orders), 0.95 + 1.45 * joints)
        # Axes that share one scale ask all others at every turn: each has its own, of one range.
        grid = figure.subplots(joints, len(orders), squeeze=False)
        longest = max(trajectory.total_time for trajectory, _ in rows)
        for j, (trajectory, column) in enumerate(rows):
            for axes, r in zip(grid[j], orders, strict=True):
                unit = shown_in(units, problem, j, _name(r))
                _panel(axes, problem, trajectory, column, j, r, unit)
                axes.set_xlim(-_BESIDE * longest, (1.0 + _BESIDE) * longest)
                axes.tick_params(axis="x", labelbottom=j == joints - 1)
        for axes in grid[-1]:
            axes.set_xlabel("time, s")
        key = "○ way-point   ● largest value   - - limit   red: beyond a limit"
        if check is not None:
            key += f"   ·   for all t: {check.verdict}"
        finish(figure, key + (f"   ·   {shown(note, 90)}" if note else ""))
    return figure


def shown_in(units: Units | None, problem: Problem, joint: int, quantity: str) -> tuple[str, float]:
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


def _largest(trajectory: Trajectory, column: int, order: int) -> Extremum:
    return max(extrema(trajectory, column, order), key=lambda e: abs(e.value))


def _name(order: int) -> str:
    return ("position", *QUANTITIES)[order]


def _words(
    problem: Problem,
    trajectory: Trajectory,
    column: int,
    joint: int,
    order: int,
    unit: tuple[str, float],
) -> str:
    top = _largest(trajectory, column, order)
    quantity = _name(order)
    limit = _limits_of(problem, joint, order)[1]
    text = (
        f"joint {problem.joints[joint]}: largest {quantity} {top.value / unit[1]:.5g} "
        f"{unit[0]} at {top.time:.4g} s"
    )
    return text + (f", limit {limit / unit[1]:.5g}" if np.isfinite(limit) else ", no limit")


def _panel(
    axes: Axes,
    problem: Problem,
    trajectory: Trajectory,
    column: int,
    joint: int,
    order: int,
    unit: tuple[str, float],
) -> None:
    quantity = _name(order)
    written, one = unit
    times, values = sampled(trajectory, column, order)
    low, high = _limits_of(problem, joint, order)
    too_much = beyond(trajectory, column, order, low, high)
    values, low, high = values / one, low / one, high / one
    ends = np.tile([0.0, 1.0, np.nan], len(trajectory.breaks))
    axes.plot(
        np.repeat(trajectory.breaks, 3),
        ends,
        transform=axes.get_xaxis_transform(),
        color=GRID,
        linewidth=0.7,
        zorder=0,
        scaley=False,
    )
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    axes.plot(times, values, color=BLUE, linewidth=1.4, zorder=2)
    size = float(np.nanmax(np.abs(values)))
    drawn = [
        x for x in (low, high) if np.isfinite(x) and (order == 0 or size > _OFF_SCALE * abs(x))
    ]
    for limit in drawn:
        axes.axhline(limit, color=INK, linestyle=(0, (4, 3)), linewidth=0.9, zorder=1)
    for start, end in too_much:
        axes.axvspan(start, end, facecolor=RED, edgecolor=RED, alpha=0.22, linewidth=1.0, zorder=1)
        inside = (times >= start) & (times <= end)
        axes.plot(times[inside], values[inside], color=RED, linewidth=2.0, zorder=3)
    axes.set_ylabel(written)
    if order == 0:
        axes.plot(
            trajectory.breaks[list(problem.curve.waypoint_breaks)],
            problem.waypoints[:, joint] / one,
            linestyle="none",
            marker="o",
            markersize=4.5,
            markerfacecolor=PAPER,
            markeredgecolor=INK,
            zorder=4,
        )
        what = "position" if problem.linear[joint] else "angle"
        axes.set_title(f"joint {shown(problem.joints[joint], 12)}, {what}", weight="bold")
    else:
        axes.set_title(quantity)
        _mark_peak(axes, _largest(trajectory, column, order), high, one)
    extent = np.concatenate([[np.nanmin(values), np.nanmax(values)], drawn])
    room = 0.1 * (float(np.ptp(extent)) or 1.0)
    axes.set_ylim(float(extent.min()) - room, float(extent.max()) + room)
    axes.locator_params(axis="y", nbins=4)
    axes.locator_params(axis="x", nbins=6)


def _mark_peak(axes: Axes, top: Extremum, limit: float, one: float) -> None:
    value = top.value / one
    over = abs(value) > limit * (1 + TOLERANCE)
    colour = RED if over else INK
    axes.plot([top.time], [value], marker="o", markersize=4.5, color=colour, zorder=5)
    text = f"{value:.4f}".replace("-", "−")
    if np.isfinite(limit) and limit > 0:
        share = 100 * abs(value) / limit
        text += f", {share:.2f} % of ±{limit:.5g}"
    elif np.isfinite(limit):
        text += ", limit 0"
    axes.set_title(text, color=colour, fontsize=8, loc="right")


def sampled(trajectory: Trajectory, column: int, order: int) -> tuple[Array, Array]:
    """Times and values, with the exact extrema among them and a gap where the curve jumps.

    Parameters
    ----------
    trajectory : Trajectory
    column, order : int
        Joint and derivative.

    Returns
    -------
    times, values : ndarray, shape (samples,)
        s and rad/sᵒʳᵈᵉʳ (m/sᵒʳᵈᵉʳ of a joint that slides); a value is NaN at a jump.
    """
    times: list[Array] = []
    values: list[Array] = []
    count = max(_FEWEST, min(_SAMPLES, _POINTS // len(trajectory.durations)))
    turning = extrema(trajectory, column, order)
    scale = max(abs(e.value) for e in turning) or 1.0
    for k, start in enumerate(trajectory.breaks[:-1]):
        own = [e.s for e in turning if e.segment == k]
        s = np.unique(np.concatenate([np.linspace(0.0, 1.0, count + 1), own]))
        v = trajectory.values(k, column, order, s)
        if values and abs(values[-1][-1] - v[0]) > 1e-6 * scale:
            times.append(np.array([start]))
            values.append(np.array([np.nan]))
        times.append(trajectory.times(k, s))
        values.append(v)
    return np.concatenate(times), np.concatenate(values)


def beyond(
    trajectory: Trajectory, column: int, order: int, low: float, high: float
) -> Sequence[tuple[float, float]]:
    """Stretches of time in which a derivative lies beyond its limits, from exact crossings.

    Parameters
    ----------
    trajectory : Trajectory
    column, order : int
        Joint and derivative.
    low, high : float
        Limits in rad/sᵒʳᵈᵉʳ or m/sᵒʳᵈᵉʳ; an excess within the checker's relative tolerance does
        not count.

    Returns
    -------
    sequence of (float, float)
        Start and end, s; stretches that touch are joined.
    """
    found: list[tuple[float, float]] = []
    slack = TOLERANCE * max((abs(x) for x in (low, high) if np.isfinite(x)), default=0.0)
    for k in range(len(trajectory.durations)):
        cuts = [0.0, 1.0]
        for limit in (low - slack, high + slack):
            if np.isfinite(limit):
                shifted = trajectory.level(k, column, order, limit)
                roots = np.polynomial.polynomial.polyroots(np.trim_zeros(shifted, "b"))
                cuts += [float(r.real) for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1]
        cuts.sort()
        for s0, s1 in pairwise(cuts):
            v = float(trajectory.values(k, column, order, np.array([(s0 + s1) / 2]))[0])
            if s1 > s0 and not low - slack <= v <= high + slack:
                t0, t1 = map(float, trajectory.times(k, np.array([s0, s1])))
                if found and t0 - found[-1][1] <= 1e-12 * trajectory.total_time:
                    found[-1] = (found[-1][0], t1)
                else:
                    found.append((t0, t1))
    return found
