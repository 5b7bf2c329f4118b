"""Picture of a workspace: the sampled positions of the end from three sides, and way-points."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Bbox
from numpy.typing import ArrayLike, NDArray

from ...problem import Array, TrajgapError
from ...problem.robots import Workspace
from .drawing import (
    BLUE,
    INK,
    PAPER,
    RED,
    SKY,
    Picture,
    Style,
    drawing,
    legend,
    light_grid,
    picture,
    shown,
)

_AXES = "xyz"
"""Names of the axes of the base."""


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
    cloud = workspace.points[:2_000]  # more of them only make the file larger
    numbers = _numbers(workspace, len(cloud))
    name = workspace.chain.name or "the chain"
    description = f"Positions that the end of {name} can take. {numbers}"
    if len(path):
        description += f"; {len(path)} way-points, {int(far_off.sum())} of them out of reach"
    corners = np.vstack([workspace.lower, workspace.upper, path, np.zeros((1, 3))])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, half = (low + high) / 2, 1.1 * float((high - low).max() / 2 or 1.0)
    title, note = title or f"Workspace of {name}", shown(numbers, 150, 2)
    with picture(title, f"{description}.", 9.9, 4.15, note, line=34) as figure:
        sides = ((0, 1, "from above"), (0, 2, "from the side"), (1, 2, "from the front"))
        views = list(zip(figure.subplots(1, 3), sides, strict=True))
        for axes, (across, up, view) in views:
            plane = [across, up]
            _view(axes, workspace, cloud[:, plane], path[:, plane], far_off, plane)
            axes.set_xlim(middle[across] - half, middle[across] + half)
            axes.set_ylim(middle[up] - half, middle[up] + half)
            axes.set_title(f"{view} ({_AXES[across]}, {_AXES[up]})")
        signs = _signs(bool(len(path)), bool(far_off.any()))
        legend(figure, signs, loc="outside upper right", ncols=len(signs))
    with drawing():
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
    dots: Style = {"edgecolor": SKY, "linewidth": 1.5, "capstyle": "round", "alpha": 0.75}
    # One path with a stroke of no length at every point: far smaller than a marker for each.
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=np.uint8), len(cloud))
    path_of_dots = Path(np.repeat(cloud, 2, axis=0), codes)
    path_of_dots.should_simplify = False  # which would drop such strokes
    axes.add_patch(PathPatch(path_of_dots, fill=False, **dots))
    box = Rectangle((corner[0], corner[1]), *size, fill=False, edgecolor=BLUE, linewidth=0.9)
    axes.add_patch(box)
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


def _signs(with_path: bool, with_missed: bool) -> dict[str, Artist]:
    cross: Style = {"linestyle": "none", "markersize": 9}
    found: dict[str, Artist] = {
        "sampled positions": Line2D([], [], color=SKY, marker="o", linestyle="none", markersize=3),
        "their box": Line2D([], [], color=BLUE, linewidth=0.9),
        "base": Line2D([], [], color=INK, marker="+", **cross),
    }
    if with_path:
        path = Line2D([], [], color=INK, marker="o", markersize=4.5, linewidth=0.9)
        found["way-points, in order"] = path
    if with_missed:
        found["out of reach"] = Line2D([], [], color=RED, marker="X", **cross | {"markersize": 6.5})
    return found


def place_labels(axes: Axes, points: Array, labels: Sequence[str]) -> None:
    """Write a label beside every point of a panel whose limits and place are settled.

    `points`: shape (points, 2), in the panel's coordinates. `labels`: points with the same label,
    or at the same place, share one.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    per_point = figure.dpi / 72
    places = axes.transData.transform(points) / per_point
    inside = axes.get_window_extent()
    room = Bbox(np.asarray(inside) / per_point)
    # A little more than the dot: a label near a point seems to name it.
    taken = [_box(x, y, 9.0, 9.0) for x, y in places]
    size = 8.0  # of the axes' numbers, points
    reaches = (8.0, 13.0, 19.0, 26.0, 34.0, 44.0)  # the nearest is clear of the dot
    angles = [pi / 4 + pi * k / 6 for k in range(12)]  # more of them move no label visibly
    for (x, y), text in _together(places, labels).items():
        width, height = 0.62 * size * len(text) + 2, 1.2 * size
        choices = [
            _box(x + reach * cos(a) + width / 2 * cos(a), y + (reach + 2) * sin(a), width, height)
            for reach in reaches
            for a in angles
        ]
        box = min(choices, key=lambda b: _cost(b, taken, room))
        taken.append(box)
        middle = ((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2)
        away = max(abs(middle[0] - x) - width / 2, abs(middle[1] - y) - height / 2)
        home = axes.transData.inverted().transform((x * per_point, y * per_point))
        axes.annotate(
            text,
            (float(home[0]), float(home[1])),
            xytext=(middle[0] - x, middle[1] - y),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            color=INK,
            bbox={"boxstyle": "round,pad=0.1", "facecolor": PAPER, "alpha": 0.8, "linewidth": 0},
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.5} if away > 8 else None,
            annotation_clip=False,
        )


def _together(places: Array, labels: Sequence[str]) -> dict[tuple[float, float], str]:
    """Labels by place, in points; those of places too near to tell apart are joined."""
    groups: list[tuple[float, float, list[str]]] = []
    for (x, y), label in zip(places, labels, strict=True):
        for gx, gy, names in groups:
            if abs(gx - x) < 2 and abs(gy - y) < 2:
                names.append(label)
                break
        else:
            groups.append((float(x), float(y), [label]))
    return {(x, y): ", ".join(dict.fromkeys(names)) for x, y, names in groups}


def _box(x: float, y: float, width: float, height: float) -> Bbox:
    return Bbox.from_bounds(x - width / 2, y - height / 2, width, height)


def _cost(box: Bbox, taken: list[Bbox], room: Bbox) -> float:
    """Overlap with what is there, and what stands outside the panel; earlier choices win ties."""
    overlap = sum(
        max(0.0, min(box.x1, b.x1) - max(box.x0, b.x0))
        * max(0.0, min(box.y1, b.y1) - max(box.y0, b.y0))
        for b in taken
    )
    outside = max(room.x0 - box.x0, box.x1 - room.x1, room.y0 - box.y0, box.y1 - room.y1, 0.0)
    return float(overlap + 10.0 * outside)
