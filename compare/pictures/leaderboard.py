"""Picture of the leaderboard: share of the runs that come within each distance of the optimum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from ...problem import Array
from .drawing import (
    BLUE,
    GREEN,
    GRID,
    INK,
    ORANGE,
    PURPLE,
    Line,
    Picture,
    drawing,
    finish,
    light_grid,
    shown,
)

_MARKED: tuple[tuple[str, Line], ...] = (
    (BLUE, "-"),
    (ORANGE, "--"),
    (GREEN, "-."),
    (PURPLE, ":"),
    (INK, "-"),
)
"""Colour and line style of the marked optimisers, in order."""


@dataclass(frozen=True, eq=False)
class BoardPanel:
    """Optimisers under one handling."""

    title: str
    marked: dict[str, Array]
    """Share of runs within each gap, of optimisers that are told apart, by what they are called;
    shape (gaps,)."""
    others: Sequence[Array]
    """Those that are drawn in grey; shape (gaps,)."""


def leaderboard_picture(
    panels: Sequence[BoardPanel], gaps: Sequence[float], *, title: str
) -> Picture:
    """Share of runs within each gap, a panel for each handling.

    `gaps`: relative, falling.
    """
    description = "; ".join(
        f"{panel.title}: {label}, " + ", ".join(
            f"{100 * share:.0f} % of the runs within {100 * gap:g} %"
            for gap, share in zip(gaps, shares, strict=True)
            if gap in (0.01, 1e-4)
        )
        for panel in panels
        for label, shares in panel.marked.items()
    )  # fmt: skip
    with drawing():
        figure = Picture(title, description, 9.6, 5.0)
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axes, panel in zip(grid, panels, strict=True):
            _panel(axes, panel, np.asarray(gaps))
        grid[0].set_ylabel("runs that come so near, %")
        finish(figure)
    return figure


def _panel(axes: Axes, panel: BoardPanel, gaps: Array) -> None:
    for at, shares in enumerate(panel.others):
        label = f"{len(panel.others)} other optimisers" if at == 0 else None
        axes.plot(gaps, 100 * shares, color=GRID, linewidth=1.0, label=label)
    for (colour, line), (label, shares) in zip(_MARKED, panel.marked.items(), strict=False):
        axes.plot(
            gaps, 100 * shares, color=colour, linestyle=line, linewidth=2.2, label=shown(label, 52)
        )
    axes.set_xscale("log")
    axes.set_xlim(gaps[0], gaps[-1])
    ticks = [10.0**k for k in range(0, -7, -1)]
    axes.set_xticks(ticks, [f"{100 * tick:.10g} %" for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(0, 102)
    axes.set_xlabel("distance from the certified optimum, at most")
    axes.set_title(panel.title)
    light_grid(axes)
    handles, labels = axes.get_legend_handles_labels()
    # What is marked comes first, although it is drawn last.
    axes.legend(
        [*handles[1:], handles[0]] if panel.others else handles,
        [*labels[1:], labels[0]] if panel.others else labels,
        loc="upper left", bbox_to_anchor=(0.0, -0.17), handlelength=3.0,
    )  # fmt: skip
