"""Curves over time: points and stretches beyond limits, in a panel for each quantity of a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes

from ...problem import TOLERANCE, Array, Trajectory, extrema
from .drawing import BLUE, GRID, INK, ORANGE, RED, Picture, Style, hollow, picture, shown

POINTS = 480
"""Points of a curve of many segments, extrema apart: more than a panel has pixels."""
Stretches = Sequence[tuple[float, float]]
"""Starts and ends, s."""


def sampled(trajectory: Trajectory, column: int, order: int) -> tuple[Array, Array]:
    """Times and values, with the exact extrema among them and a gap where the curve jumps.

    Shape (samples,): s and rad/sᵒʳᵈᵉʳ (m/sᵒʳᵈᵉʳ of a joint that slides); a value is NaN at a jump.
    If there are more pieces than a panel has pixels, only the exact extrema. `column, order`: joint
    and derivative.
    """
    if len(trajectory.durations) > POINTS:
        places, found = (one[:, :, column] for one in trajectory.turns(order))
        clock = trajectory.times(np.arange(places.shape[1]), places)
        known = ~np.isnan(found.T)
        return thinned(clock.T[known], found.T[known])
    times: list[Array] = []
    values: list[Array] = []
    count = max(8, min(48, POINTS // len(trajectory.durations)))
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


def thinned(times: Array, values: Array) -> tuple[Array, Array]:
    """The least and the largest of the values that share a pixel, in order of time."""
    if values.size <= 2 * POINTS:
        return times, values
    edges = np.linspace(0, values.size, POINTS + 1).astype(np.int64)
    kept = [
        place
        for first, last in pairwise(edges.tolist())
        for place in (
            first + int(values[first:last].argmin()),
            first + int(values[first:last].argmax()),
        )
    ]
    at = np.unique([0, *kept, values.size - 1])
    return times[at], values[at]


def beyond(
    trajectory: Trajectory,
    column: int,
    order: int,
    low: float,
    high: float,
    slack: Array | float | None = None,
    braking: float = np.inf,
) -> Stretches:
    """Stretches of time in which a derivative lies beyond its limits, far finer than a pixel.

    Start and end, s: where the line between two samples, among which are the exact extrema, crosses
    a limit; stretches that touch are joined, and of more pieces than pixels those within a pixel.
    `column, order`: joint and derivative. `low, high`: limits in rad/sᵒʳᵈᵉʳ or m/sᵒʳᵈᵉʳ. `slack`:
    shape (pieces,), an excess up to this does not count; by default the checker's relative
    tolerance. A negative one counts what stays within the limits by less than its size. `braking`:
    limit of an acceleration while the speed falls, where it has one of its own.
    """
    pieces, total = len(trajectory.durations), trajectory.total_time
    if slack is None:
        slack = TOLERANCE * max((abs(x) for x in (low, high) if np.isfinite(x)), default=0.0)
    times, values = sampled(trajectory, column, order)
    own = np.searchsorted(trajectory.breaks[1:-1], times, side="right")
    # Of an error of which nothing is known, the largest number: infinity less itself is none.
    finite = np.nan_to_num(slack, nan=np.finfo(np.float64).max)
    slacks = np.broadcast_to(finite, (pieces,))[own]
    least, most = np.full(times.size, low), np.full(times.size, high)
    if np.isfinite(braking):
        forth = trajectory(times, 1)[:, column] >= 0
        least, most = np.where(forth, -braking, low), np.where(forth, high, braking)
    excess = np.maximum(values - most, least - values) - slacks
    turns = np.flatnonzero(np.diff(np.concatenate([[False], excess > 0, [False]])))
    found = [
        (_crossing(times, excess, first, first - 1), _crossing(times, excess, after - 1, after))
        for first, after in turns.reshape(-1, 2).tolist()
    ]
    return joined_stretches(found, total / POINTS if pieces > POINTS else 1e-12 * total)


def _crossing(times: Array, excess: Array, beyond: int, within: int) -> float:
    """Where the line from a sample beyond a limit to its neighbour crosses it."""
    if not 0 <= within < times.size or not np.isfinite(excess[within]):
        return float(times[beyond])
    share = excess[beyond] / (excess[beyond] - excess[within])
    return float(times[beyond] + share * (times[within] - times[beyond]))


def joined_stretches(found: Stretches, gap: float) -> Stretches:
    """Stretches in order of time, those joined that are at most a gap apart, s."""
    joined: list[tuple[float, float]] = []
    for start, end in found:
        if joined and start - joined[-1][1] <= gap:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return joined


def without(stretches: Stretches, others: Stretches, least: float) -> Stretches:
    """What others leave of stretches, both in order of time.

    `least`: what is left beside another stretch counts if it is longer than this, s.
    """
    left: list[tuple[float, float]] = []
    for start, end in stretches:
        at = start
        inner = [one for one in others if one[1] >= start and one[0] <= end]
        for first, last in inner:
            left += [(at, first)] if first - at > least else []
            at = max(at, last)
        left += [(at, end)] if end - at > least or not inner else []
    return left


Unit: TypeAlias = tuple[str, float]
"""The unit as it is written, and how much of SI one of it is."""
Units: TypeAlias = Mapping[tuple[str, str], Unit]
"""How a quantity of a joint is shown, by the joint's label and the quantity."""


@dataclass(frozen=True)
class Mark:
    """A value of a curve that is marked and written above its panel."""

    time: float
    value: float
    """s, and rad or m with the powers of s that belong to it."""
    limit: float
    """On the side of the value; infinite if it has none."""
    ratio: float
    """Value to limit."""
    both: bool
    """Whether the limit is the same on the other side."""
    colour: str = INK

    def words(self, one: float) -> str:
        """The value, and how much of its limit it is, in a unit that is so much of SI."""
        value = self.value / one
        # Fewer digits of large numbers: they fill the head of a panel.
        text = f"{value:.4f}" if abs(value) < 1e4 else f"{value:.6g}"
        if np.isfinite(self.limit) and self.limit:
            limit = f"±{abs(self.limit) / one:.5g}" if self.both else f"{self.limit / one:.5g}"
            places = 2 if abs(self.ratio) < 10 else 0
            text += f", {100 * self.ratio:.{places}f} % of {limit}"
        elif np.isfinite(self.limit):
            text += ", limit 0"
        return text.replace("-", "−")


@dataclass(frozen=True, eq=False)
class Line:
    """One quantity of one joint over time."""

    joint: str
    quantity: str
    """"position", "velocity" and so on."""
    linear: bool
    unit: Unit
    times: Array
    values: Array
    """s, and rad or m; NaN if the curve jumps."""
    limits: Sequence[float]
    """All that hold on either side; infinite ones are none."""
    marks: Sequence[Mark] = ()
    """The gravest first."""
    points: tuple[Array, Array] = (np.empty(0), np.empty(0))
    """Times and values of way-points or samples."""
    breaks: Array = field(default_factory=lambda: np.empty(0))
    """Times of lines that stand behind the curve."""
    broken: Stretches = ()
    unsure: Stretches = ()
    """Stretches that are beyond a limit, and those that may be."""
    jumps: bool = False
    """Whether jumps are marked as faults."""
    dots: bool = False
    """Whether nothing is known between the times."""

    @property
    def described(self) -> str:
        """Its largest value in words, for those who cannot see the picture."""
        if not self.marks:
            return f"joint {self.joint}: no value of {self.quantity} is known"
        top, (written, one) = self.marks[0], self.unit
        text = (
            f"joint {self.joint}: largest {self.quantity} {top.value / one:.5g} {written} at "
            f"{top.time:.4g} s"
        )
        limit = f", limit {abs(top.limit) / one:.5g}" if np.isfinite(top.limit) else ", no limit"
        return text + limit


def panels_picture(
    rows: Sequence[Sequence[Line]],
    title: str,
    signs: Sequence[str],
    note: str,
    span: tuple[float, float],
) -> Picture:
    """Panels with the curves of every joint.

    `rows`: by joint, each from the position on. `signs`: what hollow and filled points stand for.
    `note`: below the picture, after the key. `span`: first and last time, s.
    """
    many = len(rows[0])
    description = "; ".join(line.described for row in rows for line in row[1:])
    lines = [line for row in rows for line in row]
    key = "   ".join((*signs, "- - limit   red: beyond a limit"))
    if any(line.jumps for line in lines):
        key += ", or a jump"
    if any(line.unsure for line in lines):
        key += "   orange: perhaps beyond"
    height = 0.95 + 1.45 * len(rows)
    with picture(title, description, 3.3 * many, height, key + note) as figure:
        # Axes that share one scale ask all others at every turn: each has its own, of one range.
        grid = figure.subplots(len(rows), many, squeeze=False)
        free = 0.02 * (span[1] - span[0])  # markers at both ends are whole
        for k, row in enumerate(rows):
            for axes, line in zip(grid[k], row, strict=True):
                _panel(axes, line)
                axes.set_xlim(span[0] - free, span[1] + free)
                axes.tick_params(axis="x", labelbottom=k == len(rows) - 1)
        for axes in grid[-1]:
            axes.set_xlabel("time, s")
    return figure


def _panel(axes: Axes, line: Line) -> None:
    written, one = line.unit
    times, values = line.times, line.values / one
    style: Style = {"linestyle": "-"}
    if line.dots:  # many would run together
        style = {"linestyle": "none", "marker": ".", "markersize": 5.0 if times.size <= 60 else 2.0}
    ends = np.tile([0.0, 1.0, np.nan], len(line.breaks))
    behind: Style = {"color": GRID, "linewidth": 0.7, "zorder": 0}
    across = axes.get_xaxis_transform()
    axes.plot(np.repeat(line.breaks, 3), ends, transform=across, scaley=False, **behind)
    axes.axhline(0.0, **behind)
    axes.plot(times, values, color=BLUE, linewidth=1.4, zorder=2, **style)
    size = float(np.nanmax(np.abs(values), initial=0.0))
    near = [x / one for x in line.limits if np.isfinite(x)]
    # A limit far away would flatten the curve.
    drawn = [x for x in near if line.quantity == "position" or size > 0.12 * abs(x)]
    for limit in drawn:
        axes.axhline(limit, color=INK, linestyle=(0, (4, 3)), linewidth=0.9, zorder=1)
    for colour, stretches in ((ORANGE, line.unsure), (RED, line.broken)):
        shade: Style = {"facecolor": colour, "edgecolor": colour, "alpha": 0.22}
        for start, end in stretches:
            axes.axvspan(start, end, linewidth=1.0, zorder=1, **shade)
    for start, end in line.broken:
        inside = (times >= start) & (times <= end)
        axes.plot(times[inside], values[inside], color=RED, linewidth=2.0, zorder=3, **style)
    if line.jumps:
        gaps = np.nonzero(np.isnan(values))[0]
        before, after = values[gaps - 1], values[gaps + 1]
        steps = np.column_stack([before, after, np.full(gaps.size, np.nan)])
        axes.plot(np.repeat(times[gaps], 3), steps.ravel(), color=RED, linewidth=1.4, zorder=3)
    axes.set_ylabel(written)
    if line.points[0].size:
        axes.plot(line.points[0], line.points[1] / one, zorder=4, **hollow(4.5))
    if line.quantity == "position":
        what = "position" if line.linear else "angle"
        axes.set_title(f"joint {shown(line.joint, 12)}, {what}", weight="bold")
    else:
        axes.set_title(line.quantity)
    for mark in line.marks:
        place = [mark.time], [mark.value / one]
        axes.plot(*place, marker="o", markersize=4.5, color=mark.colour, zorder=5)
    for mark in line.marks[:1] if line.quantity != "position" else ():
        axes.set_title(mark.words(one), color=mark.colour, fontsize=8, loc="right")
    marked = [mark.value / one for mark in line.marks]
    reach = [np.nanmin(values, initial=np.inf), np.nanmax(values, initial=-np.inf)]
    extent = np.array([*(reach if values.size else [0.0]), *marked, *drawn])
    room = 0.1 * (float(np.ptp(extent)) or 1.0)
    axes.set_ylim(float(extent.min()) - room, float(extent.max()) + room)
    axes.locator_params(axis="y", nbins=4)
    axes.locator_params(axis="x", nbins=6)
