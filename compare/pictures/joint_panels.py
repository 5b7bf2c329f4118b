"""Pictures with two panels for each joint, one above the other: jumps, control polygons."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from ...problem import Array, Jump, Problem, Trajectory, TrajgapError, check, fit
from ...problem.curves import StretchedUniformBSpline, control_vertices
from ..audits.rules import Vertex
from .drawing import (
    BLUE,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    RED,
    Picture,
    drawing,
    finish,
    hollow,
    shown,
)
from .motion import shown_in
from .panels import Units
from .traced import sampled


def _pairs(
    figure: Picture, joints: Sequence[str], x: str, above: float
) -> tuple[NDArray[np.object_], list[NDArray[np.object_]]]:
    """All panels of a figure, and those of each joint: a high one with its name, a low one."""
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    grid = figure.subplots(
        2 * rows, columns, squeeze=False, sharex="all", height_ratios=[above, 1.0] * rows
    )
    places = [
        grid[2 * row : 2 * row + 2, column] for row in range(rows) for column in range(columns)
    ]
    for axes in (one for pair in places[len(joints) :] for one in pair):
        axes.remove()
    for axes in grid[-1]:
        axes.set_xlabel(x)
    for pair, label in zip(places, joints, strict=False):
        pair[0].set_title(f"joint {shown(label, 12)}", weight="bold")
        pair[0].locator_params(axis="y", nbins=5)
        pair[1].locator_params(axis="y", nbins=3)
    return grid, places[: len(joints)]


def _height(joints: Sequence[str], each: float) -> float:
    """Inches of such a figure with three joints a row."""
    return 0.9 + each * -(-len(joints) // 3)


def velocity_jumps(problem: Problem, durations: ArrayLike) -> tuple[Jump, ...]:
    """Jumps of the velocity at the breaks, in order of joint and time.

    Empty if the velocity is continuous. `durations`: shape (segments,), s.
    """
    found = [j for j in check(problem, durations).jumps if j.order == 1]
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
    own = [[j for j in jumps if j.joint == label] for label in joints]
    description = "; ".join(
        f"joint {label}: {_named(found, unit)}"
        for label, found, unit in zip(joints, own, own_units, strict=True)
    )
    with drawing():
        figure = Picture(title, description, 9.9, _height(joints, 3.0))
        grid, pairs = _pairs(figure, joints, "time, s", 2.2)
        alike = len(set(own_units)) == 1
        for j, (upper, lower) in enumerate(pairs):
            written, one = own_units[j]
            _velocity(upper, motion, j, own[j], one)
            _sizes(lower, motion, own[j], one)
            lower.set_title(shown(_named(own[j], own_units[j]), 60), fontsize=8)
            if upper in grid[:, 0] or not alike:
                upper.set_ylabel(f"velocity, {written}")
                lower.set_ylabel(f"jump, {written}")
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
    times, values = sampled(motion, joint, 1)
    axes.plot(times, values / one, color=BLUE, linewidth=1.4, zorder=2)
    for jump in jumps:
        for value, colour in zip(_sides(motion, joint, jump), (PAPER, INK), strict=True):
            style = hollow(3.4, face=colour)
            axes.plot(jump.time, value / one, markeredgewidth=0.8, zorder=4, **style)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _sizes(axes: Axes, motion: Trajectory, jumps: list[Jump], one: float) -> None:
    _ground(axes, motion)
    top = max((abs(j.size) for j in jumps), default=0.0)
    for jump in jumps:
        colour = INK if abs(jump.size) == top else ORANGE
        axes.vlines(jump.time, 0.0, jump.size / one, color=colour, linewidth=4.0, zorder=2)
    if not jumps:
        axes.set_ylim(-1.0, 1.0)
    axes.ticklabel_format(axis="y", scilimits=(-5, 5))


def _ground(axes: Axes, motion: Trajectory) -> None:
    for b in motion.breaks:
        axes.axvline(float(b), color=GRID, linewidth=0.7, zorder=0)
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    axes.margins(x=0.02, y=0.1)
    axes.locator_params(axis="x", nbins=7)


def _sides(motion: Trajectory, joint: int, jump: Jump) -> tuple[float, float]:
    """Velocity before and after a break, rad/s."""
    before = motion.derivative(jump.break_index - 1, joint, 1)
    after = motion.derivative(jump.break_index, joint, 1)
    return float(np.polynomial.polynomial.polyval(1.0, before)), float(after[0])


def polygon_picture(
    waypoints: ArrayLike, vertices: Sequence[Vertex], *, title: str, quantity: str = "angle"
) -> Picture:
    """Uniform cubic B-spline of every joint over its parameter, with its control polygon.

    Vertex V_k stands over the parameter k − 1, where its basis function is largest.

    Below each curve: printed less computed vertices, and how far rounding explains. `waypoints`:
    shape (way-points, joints), in the unit in which they are printed. `vertices`: printed vertices
    with the intervals that the way-points allow, joint after joint. `quantity`: what the way-points
    are: "position" where some joint slides.
    """
    w = np.asarray(waypoints, dtype=np.float64)
    joints = tuple(dict.fromkeys(v.joint for v in vertices))
    own = [[v for v in vertices if v.joint == label] for label in joints]
    if w.ndim != 2 or w.shape[1] != len(joints) or any(len(o) != len(w) + 2 for o in own):
        raise TrajgapError(
            f"polygon_picture: way-points of shape {w.shape} for {len(vertices)} vertices of "
            f"{len(joints)} joints; give two vertices more than way-points for each joint"
        )
    computed = control_vertices(w)
    description = "; ".join(
        f"joint {label}: {_words(found, computed[:, j])}"
        for j, (label, found) in enumerate(zip(joints, own, strict=True))
    )
    with drawing():
        figure = Picture(title, description, 9.9, _height(joints, 3.2))
        grid, pairs = _pairs(figure, joints, "parameter: way-point number + e", 2.6)
        curve = StretchedUniformBSpline(len(w))
        motion = fit(curve, w, np.ones(curve.segments))
        exponent = math.floor(math.log10(max(float(v.width) for v in vertices)))
        # Digits as exponents, for type without formulas.
        raised = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        for j, (upper, lower) in enumerate(pairs):
            upper.plot(*sampled(motion, j, 0), color=BLUE, linewidth=1.6, zorder=3)
            _polygon(upper, w[:, j], own[j], computed[:, j])
            _differences(lower, own[j], computed[:, j], exponent)
            lower.set_title(_words(own[j], computed[:, j]), fontsize=8)
        for upper, lower in zip(grid[::2, 0], grid[1::2, 0], strict=True):
            upper.set_ylabel(f"{quantity}, as printed")
            lower.set_ylabel(f"printed − comp.\n10{raised}")
        figure.align_ylabels(grid[:, 0])
        key = (
            "— curve   ○ way-point   + control vertex, computed   □ control vertex, printed   "
            "bars below: what rounding explains"
        )
        finish(figure, key)
    return figure


def _words(vertices: list[Vertex], computed: Array) -> str:
    far = max(abs(v.printed.value - c) for v, c in zip(vertices, computed, strict=True))
    inside = sum(v.inside for v in vertices)
    apart = f"{far:.1e}".replace("e-0", "e−")
    return f"{inside} of {len(vertices)} within rounding, at most {apart} apart"


def _polygon(axes: Axes, waypoints: Array, vertices: list[Vertex], computed: Array) -> None:
    at = np.arange(len(computed)) - 1.0
    axes.plot(at, computed, color=ORANGE, linewidth=0.9, linestyle=(0, (4, 2)), zorder=1)
    printed = [v.printed.value for v in vertices]
    square = hollow(6.5, face="none") | {"marker": "s"}
    axes.plot(at, printed, markeredgewidth=0.8, zorder=2, **square)
    axes.plot(at, computed, linestyle="none", marker="+", markersize=6, color=ORANGE, zorder=4)
    axes.plot(np.arange(len(waypoints)), waypoints, zorder=5, **hollow(4, BLUE))


def _differences(axes: Axes, vertices: list[Vertex], computed: Array, exponent: int) -> None:
    at = np.arange(len(computed)) - 1.0
    axes.axhline(0.0, color=GRID, linewidth=0.7, zorder=0)
    low = [float(v.allowed.lower - v.printed.unit / 2) for v in vertices] - computed
    high = [float(v.allowed.upper + v.printed.unit / 2) for v in vertices] - computed
    unit = 10.0**exponent
    axes.vlines(at, low / unit, high / unit, color=MUTED, linewidth=3.5, alpha=0.35, zorder=1)
    apart = np.array([v.printed.value for v in vertices]) - computed
    colours = [INK if v.inside else RED for v in vertices]
    axes.scatter(at, apart / unit, marker="s", s=14, color=colours, zorder=2)
    axes.set_xticks(np.arange(-1, len(computed) - 1, max(1, len(computed) // 6)))
