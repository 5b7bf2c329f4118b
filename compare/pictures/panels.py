"""The panels of a motion: one row for each joint, and a column for each derivative."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from matplotlib.axes import Axes

from ...problem import Array
from .drawing import BLUE, GRID, INK, ORANGE, RED, Picture, Style, drawing, finish, hollow, shown
from .traced import Stretches

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
    with drawing():
        figure = Picture(title, description, 3.3 * many, 0.95 + 1.45 * len(rows))
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
        key = "   ".join((*signs, "- - limit   red: beyond a limit"))
        if any(line.jumps for line in lines):
            key += ", or a jump"
        if any(line.unsure for line in lines):
            key += "   orange: perhaps beyond"
        finish(figure, key + note)
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
    _mark(axes, line)
    marked = [mark.value / one for mark in line.marks]
    reach = [np.nanmin(values, initial=np.inf), np.nanmax(values, initial=-np.inf)]
    extent = np.array([*(reach if values.size else [0.0]), *marked, *drawn])
    room = 0.1 * (float(np.ptp(extent)) or 1.0)
    axes.set_ylim(float(extent.min()) - room, float(extent.max()) + room)
    axes.locator_params(axis="y", nbins=4)
    axes.locator_params(axis="x", nbins=6)


def _mark(axes: Axes, line: Line) -> None:
    one = line.unit[1]
    for mark in line.marks:
        place = [mark.time], [mark.value / one]
        axes.plot(*place, marker="o", markersize=4.5, color=mark.colour, zorder=5)
    if line.quantity != "position":
        for mark in line.marks[:1]:
            axes.set_title(mark.words(one), color=mark.colour, fontsize=8, loc="right")
