"""Labels of points in a picture, placed so that they overlap neither each other nor a point."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import Bbox

from ...problem import Array
from .drawing import INK, PAPER

_SIZE = 8.0
"""Of the type, points: that of the axes' numbers."""
_REACH = (8.0, 13.0, 19.0, 26.0, 34.0, 44.0)
"""Distances of a label from its point that are tried, points: the nearest is clear of the dot."""
_DIRECTIONS = 12
"""Directions that are tried at each distance; more of them move no label visibly."""
_DOT = 9.0
"""Room of a point that no label may cover, points: a little more than the dot."""


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
    taken = [_box(x, y, _DOT, _DOT) for x, y in places]  # a label near a point seems to name it
    for (x, y), text in _together(places, labels).items():
        width, height = 0.62 * _SIZE * len(text) + 2, 1.2 * _SIZE
        choices = [
            _box(x + reach * cos(a) + width / 2 * cos(a), y + (reach + 2) * sin(a), width, height)
            for reach in _REACH
            for a in (pi / 4 + 2 * pi * k / _DIRECTIONS for k in range(_DIRECTIONS))
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
            fontsize=_SIZE,
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
