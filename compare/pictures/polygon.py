"""Picture of a control polygon: curve, way-points, and the vertices as printed and computed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...problem import Array, TrajgapError, fit
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
    shown,
)
from .traced import sampled

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits as exponents, for type without formulas."""


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
    columns = min(3, len(joints))
    rows = -(-len(joints) // columns)
    description = "; ".join(
        f"joint {label}: {_words(found, computed[:, j])}"
        for j, (label, found) in enumerate(zip(joints, own, strict=True))
    )
    with drawing():
        figure = Picture(title, description, 9.9, 0.9 + 3.2 * rows)
        grid = figure.subplots(
            2 * rows, columns, squeeze=False, sharex="all", height_ratios=[2.6, 1.0] * rows
        )
        curve = StretchedUniformBSpline(len(w))
        motion = fit(curve, w, np.ones(curve.segments))
        exponent = math.floor(math.log10(max(float(v.width) for v in vertices)))
        for j, label in enumerate(joints):
            upper, lower = grid[2 * (j // columns) : 2 * (j // columns) + 2, j % columns]
            upper.plot(*sampled(motion, j, 0), color=BLUE, linewidth=1.6, zorder=3)
            _polygon(upper, w[:, j], own[j], computed[:, j])
            _differences(lower, own[j], computed[:, j], exponent)
            upper.set_title(f"joint {shown(label, 12)}", weight="bold")
            lower.set_title(_words(own[j], computed[:, j]), fontsize=8)
            upper.locator_params(axis="y", nbins=5)
        for spare in range(len(joints), rows * columns):
            for axes in grid[2 * (spare // columns) : 2 * (spare // columns) + 2, spare % columns]:
                axes.remove()
        for axes in grid[-1]:
            axes.set_xlabel("parameter: way-point number + e")
        for row in range(rows):
            raised = str(exponent).translate(_RAISED)
            grid[2 * row, 0].set_ylabel(f"{quantity}, as printed")
            grid[2 * row + 1, 0].set_ylabel(f"printed − comp.\n10{raised}")
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
    axes.plot(
        at,
        [v.printed.value for v in vertices],
        linestyle="none",
        marker="s",
        markersize=6.5,
        markerfacecolor="none",
        markeredgecolor=INK,
        markeredgewidth=0.8,
        zorder=2,
    )
    axes.plot(at, computed, linestyle="none", marker="+", markersize=6, color=ORANGE, zorder=4)
    axes.plot(
        np.arange(len(waypoints)),
        waypoints,
        linestyle="none",
        marker="o",
        markersize=4,
        markerfacecolor=PAPER,
        markeredgecolor=BLUE,
        zorder=5,
    )


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
    axes.locator_params(axis="y", nbins=3)
    axes.set_xticks(np.arange(-1, len(computed) - 1, max(1, len(computed) // 6)))
