"""Picture of the velocity of every joint over time, with the jumps between the segments marked."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...problem import Jump, Problem, Trajectory, TrajgapError, check, fit
from .drawing import (
    BLUE,
    GRID,
    INK,
    ORANGE,
    PAPER,
    Picture,
    drawing,
    finish,
    shown,
)
from .motion import shown_in
from .panels import Units
from .traced import sampled

_VELOCITY = 1
"""Order of the derivative whose jumps are drawn."""


def velocity_jumps(problem: Problem, durations: ArrayLike) -> tuple[Jump, ...]:
    """Jumps of the velocity at the breaks, in order of joint and time.

    Empty if the velocity is continuous. `durations`: shape (segments,), s.
    """
    found = [j for j in check(problem, durations).jumps if j.order == _VELOCITY]
    return tuple(sorted(found, key=lambda j: (problem.joints.index(j.joint), j.time)))


def jump_picture(
    problem: Problem, durations: ArrayLike, *, title: str, units: Units | None = None
) -> Picture:
    """Velocity of every joint over time; below it the size of each jump.

    The largest jump of each joint is dark, and named with its time and size. `durations`: shape
    (segments,), shared by all joints, s. `units`: those of the paper, as for `motion_picture`; SI
    by default.
    """
    h = np.asarray(durations, dtype=np.float64)
    if h.shape != (problem.segments,):
        raise TrajgapError(
            f"jump_picture: expected durations of shape ({problem.segments},), got {h.shape}"
        )
    own_units = [shown_in(units, problem, j, "velocity") for j in range(len(problem.joints))]
    motion = fit(problem.curve, problem.waypoints, h)
    jumps = velocity_jumps(problem, h)
    joints = problem.joints
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    own = [[j for j in jumps if j.joint == label] for label in joints]
    description = "; ".join(
        f"joint {label}: {_named(found, unit)}"
        for label, found, unit in zip(joints, own, own_units, strict=True)
    )
    with drawing():
        figure = Picture(title, description, 9.9, 0.9 + 3.0 * rows)
        grid = figure.subplots(
            2 * rows, columns, squeeze=False, sharex="all", height_ratios=[2.2, 1.0] * rows
        )
        for j in range(rows * columns):
            upper, lower = grid[2 * (j // columns) : 2 * (j // columns) + 2, j % columns]
            if j >= len(joints):
                upper.remove()
                lower.remove()
                continue
            _velocity(upper, motion, j, own[j], own_units[j][1])
            _sizes(lower, motion, own[j], own_units[j][1])
            upper.set_title(f"joint {shown(joints[j], 12)}", weight="bold")
            lower.set_title(shown(_named(own[j], own_units[j]), 60), fontsize=8)
        for axes in grid[-1]:
            axes.set_xlabel("time, s")
        alike = len(set(own_units)) == 1
        for j, (written, _) in enumerate(own_units):
            row, column = 2 * (j // columns), j % columns
            if column == 0 or not alike:
                grid[row, column].set_ylabel(f"velocity, {written}")
                grid[row + 1, column].set_ylabel(f"jump, {written}")
        figure.align_ylabels(grid[:, 0])
        key = "○ before a jump   ● after it   vertical lines: way-points   bars: after less before"
        finish(figure, key)
    return figure


def _named(jumps: list[Jump], unit: tuple[str, float]) -> str:
    if not jumps:
        return "no jump"
    top = max(jumps, key=lambda j: abs(j.size))
    size = f"{top.size / unit[1]:+#.3g}".replace("e-0", "e-").replace("-", "−")
    count = f"largest of {len(jumps)} jumps" if len(jumps) > 1 else "jump"
    return f"{count}: {size} {unit[0]} at {top.time:.2f} s"


def _velocity(axes: Axes, motion: Trajectory, joint: int, jumps: list[Jump], one: float) -> None:
    _ground(axes, motion)
    times, values = sampled(motion, joint, _VELOCITY)
    axes.plot(times, values / one, color=BLUE, linewidth=1.4, zorder=2)
    for jump in jumps:
        for value, colour in zip(_sides(motion, joint, jump), (PAPER, INK), strict=True):
            axes.plot(
                jump.time,
                value / one,
                marker="o",
                markersize=3.4,
                markerfacecolor=colour,
                markeredgecolor=INK,
                markeredgewidth=0.8,
                zorder=4,
            )
    axes.locator_params(axis="y", nbins=5)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _sizes(axes: Axes, motion: Trajectory, jumps: list[Jump], one: float) -> None:
    _ground(axes, motion)
    top = max((abs(j.size) for j in jumps), default=0.0)
    for jump in jumps:
        largest = abs(jump.size) == top
        colour = INK if largest else ORANGE
        axes.vlines(jump.time, 0.0, jump.size / one, color=colour, linewidth=4.0, zorder=2)
    if not jumps:
        axes.set_ylim(-1.0, 1.0)
    axes.locator_params(axis="y", nbins=3)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _ground(axes: Axes, motion: Trajectory) -> None:
    for b in motion.breaks:
        axes.axvline(float(b), color=GRID, linewidth=0.7, zorder=0)
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    axes.margins(x=0.02, y=0.1)
    axes.locator_params(axis="x", nbins=7)


def _sides(motion: Trajectory, joint: int, jump: Jump) -> tuple[float, float]:
    """Velocity before and after a break, rad/s."""
    before = motion.derivative(jump.break_index - 1, joint, _VELOCITY)
    after = motion.derivative(jump.break_index, joint, _VELOCITY)
    return float(np.polynomial.polynomial.polyval(1.0, before)), float(after[0])
