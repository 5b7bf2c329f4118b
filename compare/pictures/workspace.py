"""Picture of a workspace: the sampled positions of the end from three sides, and way-points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from ...problem import Array, TrajgapError
from ...problem.robots import Workspace
from .drawing import (
    BLUE,
    INK,
    MUTED,
    PAPER,
    RED,
    SKY,
    Picture,
    drawing,
    light_grid,
    shown,
)
from .labels import place_labels

_VIEWS = ((0, 1, "from above"), (0, 2, "from the side"), (1, 2, "from the front"))
"""The two axes of each view, and its name."""
_AXES = "xyz"
"""Names of the axes of the base."""
_LARGEST_CLOUD = 2_000
"""Sampled positions that are drawn: more of them only make the file larger."""
_ROOM = 1.1
"""Half the width of a view by half the extent of what it shows: a margin of a tenth."""


def workspace_picture(
    workspace: Workspace,
    *,
    waypoints: ArrayLike | None = None,
    labels: Sequence[str] = (),
    missed: Sequence[bool] = (),
    title: str = "",
) -> Picture:
    """Three views of the sampled positions, with their bounding box and the base.

    The first 2,000 samples are drawn, at one scale in all views; box and numbers are of all
    samples. `waypoints`: shape (way-points, 3), positions in the base, m, joined by straight lines
    in order over the cloud. `labels`: names of the way-points. `missed`: which way-points the end
    cannot reach; they are drawn as red crosses.
    """
    path = _positions(waypoints)
    for name, given in (("labels", labels), ("missed", missed)):
        if given and len(given) != len(path):
            raise TrajgapError(f"{name}: {len(given)} for {len(path)} way-points; give one each")
    far_off = np.array(missed or [False] * len(path), dtype=np.bool_)
    cloud = workspace.points[:_LARGEST_CLOUD]
    numbers = _numbers(workspace, len(cloud))
    name = workspace.chain.name or "the chain"
    description = f"Positions that the end of {name} can take. {numbers}"
    if len(path):
        description += f"; {len(path)} way-points, {int(far_off.sum())} of them out of reach"
    corners = np.vstack([workspace.lower, workspace.upper, path, np.zeros((1, 3))])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, half = (low + high) / 2, _ROOM * float((high - low).max() / 2 or 1.0)
    with drawing():
        figure = Picture(title or f"Workspace of {name}", f"{description}.", 9.9, 4.15)
        views = list(zip(figure.subplots(1, 3), _VIEWS, strict=True))
        for axes, (across, up, view) in views:
            plane = [across, up]
            _view(axes, workspace, cloud[:, plane], path[:, plane], far_off, plane)
            axes.set_xlim(middle[across] - half, middle[across] + half)
            axes.set_ylim(middle[up] - half, middle[up] + half)
            axes.set_title(f"{view} ({_AXES[across]}, {_AXES[up]})")
        handles, names = _legend(bool(len(path)), bool(far_off.any()))
        figure.legend(handles, names, loc="outside upper right", ncols=len(names))
        figure.suptitle(shown(figure.title, 34, 2), x=0.005, ha="left", fontsize=11, weight="bold")
        figure.supxlabel(shown(numbers, 150, 2), x=0.005, ha="left", fontsize=8, color=MUTED)
        # The layout moves a little with every drawing; frozen, it gives the same bytes.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        for axes, (across, up, _) in views:
            if labels:
                place_labels(axes, path[:, [across, up]], [shown(x, 16) for x in labels])
    return figure


def _numbers(workspace: Workspace, drawn: int) -> str:
    near, far = workspace.distances
    box = ", ".join(
        f"{axis} {_metres(low)} to {_metres(high)}"
        for axis, low, high in zip(_AXES, workspace.lower, workspace.upper, strict=True)
    )
    total = len(workspace.points)
    some = f", the first {drawn} drawn" if drawn < total else ""
    return (
        f"{total} positions, seed {workspace.seed}{some}; {box} m; "
        f"{_metres(near)} to {_metres(far)} m from the base's origin"
    )


def _metres(x: float) -> str:
    # Adding 0 turns a rounded −0 into 0.
    return f"{round(x, 3) + 0.0:.3f}".replace("-", "−")


def _positions(waypoints: ArrayLike | None) -> Array:
    if waypoints is None:
        return np.empty((0, 3))
    try:
        path = np.asarray(waypoints, dtype=np.float64)
    except (TypeError, ValueError):
        raise TrajgapError("waypoints: not numbers; give positions, m") from None
    if path.ndim != 2 or path.shape[1] != 3 or not np.isfinite(path).all():
        raise TrajgapError(
            f"waypoints: shape {path.shape}, or not finite; give (way-points, 3) positions, m"
        )
    return path


def _dots(points: Array) -> Path:
    """One path with a stroke of no length at every point: far smaller than a marker for each."""
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=np.uint8), len(points))
    path = Path(np.repeat(points, 2, axis=0), codes)
    # Simplifying would drop such strokes.
    path.should_simplify = False
    return path


def _view(
    axes: Axes,
    workspace: Workspace,
    cloud: Array,
    path: Array,
    far_off: NDArray[np.bool_],
    plane: list[int],
) -> None:
    corner = workspace.lower[plane]
    size = workspace.upper[plane] - corner
    axes.add_patch(
        PathPatch(
            _dots(cloud),
            fill=False,
            edgecolor=SKY,
            linewidth=1.5,
            capstyle="round",
            alpha=0.75,
        )
    )
    axes.add_patch(
        Rectangle((corner[0], corner[1]), *size, fill=False, edgecolor=BLUE, linewidth=0.9)
    )
    axes.plot(0, 0, marker="+", color=INK, markersize=9, linestyle="none")
    if len(path):
        axes.plot(path[:, 0], path[:, 1], "-", color=INK, linewidth=0.9)
        axes.plot(*path[~far_off].T, "o", color=INK, markersize=4.5, markeredgecolor=PAPER)
        axes.plot(*path[far_off].T, "X", color=RED, markersize=6.5, markeredgecolor=PAPER)
    axes.set_aspect("equal", adjustable="box")
    axes.locator_params(nbins=5)
    axes.set_xlabel(f"{_AXES[plane[0]]}, m")
    axes.set_ylabel(f"{_AXES[plane[1]]}, m")
    light_grid(axes)


def _legend(with_path: bool, with_missed: bool) -> tuple[list[Line2D], list[str]]:
    handles = [
        Line2D([], [], color=SKY, marker="o", linestyle="none", markersize=3),
        Line2D([], [], color=BLUE, linewidth=0.9),
        Line2D([], [], color=INK, marker="+", linestyle="none", markersize=9),
    ]
    names = ["sampled positions", "their box", "base"]
    if with_path:
        handles.append(Line2D([], [], color=INK, marker="o", markersize=4.5, linewidth=0.9))
        names.append("way-points, in order")
    if with_missed:
        handles.append(Line2D([], [], color=RED, marker="X", linestyle="none", markersize=6.5))
        names.append("out of reach")
    return handles, names
