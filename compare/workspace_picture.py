"""Picture of a workspace: the sampled positions of the end from three sides, and way-points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike, NDArray

from ..problem import TrajgapError
from ..problem.workspace import Workspace
from .drawing import BLUE, INK, MUTED, RED, SKY, Picture, drawing, light_grid, shown

_VIEWS = ((0, 1, "from above"), (0, 2, "from the side"), (1, 2, "from the front"))
_AXES = "xyz"
_LARGEST_CLOUD = 20_000


def workspace_picture(
    workspace: Workspace,
    *,
    waypoints: ArrayLike | None = None,
    labels: Sequence[str] = (),
    title: str = "",
) -> Picture:
    """Three views of the sampled positions, with their bounding box and the base.

    Parameters
    ----------
    workspace : Workspace
    waypoints : array_like, shape (way-points, 3), optional
        Positions in the base, m, drawn in order over the cloud.
    labels : sequence of str, optional
        Names of the way-points.
    title : str, optional

    Returns
    -------
    Picture
        The first 20,000 samples are drawn; box and numbers are of all of them.

    Raises
    ------
    TrajgapError
        If the way-points are no finite positions, or the labels are not one each.
    """
    path = _positions(waypoints, labels)
    near, far = workspace.distances
    cloud = workspace.points[:_LARGEST_CLOUD]
    box = ", ".join(
        f"{axis} {low:.3f} to {high:.3f}"
        for axis, low, high in zip(_AXES, workspace.lower, workspace.upper, strict=True)
    ).replace("-", "−")
    numbers = (
        f"{len(workspace.points)} positions, seed {workspace.seed}; {box} m; "
        f"{near:.3f} to {far:.3f} m from the base's origin"
    )
    name = workspace.chain.name or "the chain"
    description = f"Positions that the end of {name} can take. {numbers}"
    if len(path):
        description += f"; {len(path)} way-points"
    with drawing():
        figure = Picture(title or f"Workspace of {name}", f"{description}.", 9.6, 4.4)
        for axes, (across, up, view) in zip(figure.subplots(1, 3), _VIEWS, strict=True):
            _view(axes, workspace, cloud, path, labels, (across, up))
            axes.set_title(f"{view} ({_AXES[across]}, {_AXES[up]})")
        handles, names = _legend(bool(len(path)))
        figure.legend(handles, names, loc="outside upper right", ncols=4)
        figure.suptitle(shown(figure.title, 44, 2), x=0.005, ha="left", fontsize=11, weight="bold")
        figure.supxlabel(shown(numbers, 140, 2), x=0.005, ha="left", fontsize=8, color=MUTED)
        # The layout moves a little with every drawing; frozen, it gives the same bytes.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    return figure


def _positions(waypoints: ArrayLike | None, labels: Sequence[str]) -> NDArray[np.float64]:
    if waypoints is None:
        path = np.empty((0, 3))
    else:
        try:
            path = np.asarray(waypoints, dtype=np.float64)
        except (TypeError, ValueError):
            raise TrajgapError("waypoints: not numbers; give positions, m") from None
    if path.ndim != 2 or path.shape[1] != 3 or not np.isfinite(path).all():
        raise TrajgapError(
            f"waypoints: shape {path.shape}, or not finite; give (way-points, 3) positions, m"
        )
    if labels and len(labels) != len(path):
        raise TrajgapError(f"labels: {len(labels)} for {len(path)} way-points; give one each")
    return path


def _view(
    axes: Axes,
    workspace: Workspace,
    cloud: NDArray[np.float64],
    path: NDArray[np.float64],
    labels: Sequence[str],
    plane: tuple[int, int],
) -> None:
    across, up = plane
    # Thousands of outlines would make the page heavy.
    axes.scatter(
        cloud[:, across], cloud[:, up], s=1.5, color=SKY, alpha=0.35, linewidths=0, rasterized=True
    )
    corner = workspace.lower[[across, up]]
    width, height = workspace.upper[[across, up]] - corner
    axes.add_patch(
        Rectangle((corner[0], corner[1]), width, height, fill=False, edgecolor=BLUE, linewidth=0.9)
    )
    axes.plot(0, 0, marker="+", color=INK, markersize=9, linestyle="none")
    if len(path):
        axes.plot(path[:, across], path[:, up], "o-", color=RED, markersize=4, linewidth=1.0)
        for k, (label, point) in enumerate(zip(labels, path[:, [across, up]], strict=bool(labels))):
            # Neighbours above and below their points in turn, so that they stay apart.
            offset = (4, 4 if k % 2 == 0 else -11)
            axes.annotate(
                shown(label, 16), point, xytext=offset, textcoords="offset points", fontsize=8
            )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{_AXES[across]} (m)")
    axes.set_ylabel(f"{_AXES[up]} (m)")
    light_grid(axes)


def _legend(with_path: bool) -> tuple[list[Line2D], list[str]]:
    handles = [
        Line2D([], [], color=SKY, marker="o", linestyle="none", markersize=4),
        Line2D([], [], color=BLUE, linewidth=0.9),
        Line2D([], [], color=INK, marker="+", linestyle="none", markersize=9),
    ]
    names = ["sampled positions", "their bounding box", "base"]
    if with_path:
        handles.append(Line2D([], [], color=RED, marker="o", markersize=4, linewidth=1.0))
        names.append("way-points")
    return handles, names
