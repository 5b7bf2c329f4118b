"""Picture of the audited papers: from the optimum of each problem to the total that it prints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .drawing import BLUE, GRID, INK, MUTED, PAPER, RED, Picture, drawing, finish, shown

_TICKS = (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Ratios that the axis names."""
_ROOM = 2.0
"""The axis goes so much further than the longest bar: room for its words."""


@dataclass(frozen=True)
class PaperBar:
    """One paper: what its printed total is of the optimum."""

    label: str
    lowest: float
    highest: float
    """Printed total over the optimum; an interval where the optimum is one."""
    said: str
    """The distance in words."""
    proven: bool
    """Whether the optimum is certified."""
    sure: bool = True
    """Whether the distance holds however the digits were rounded."""


def papers_picture(bars: Sequence[PaperBar], *, title: str) -> Picture:
    """A bar for each paper, from its optimum at the left to its printed total.

    On a logarithmic axis, so no bar is cut.
    """
    description = "; ".join(f"{one.label}: {one.said}" for one in bars)
    top = _ROOM * max([one.highest for one in bars], default=1.0)
    with drawing():
        figure = Picture(title, description, 9.6, 1.3 + 0.42 * max(1, len(bars)))
        axes = figure.subplots()
        axes.set_xscale("log")
        axes.axvline(1.0, color=INK, linewidth=1.3)
        for row, one in enumerate(bars):
            axes.axhline(row, color=GRID, linewidth=0.6, zorder=0)
            axes.barh(
                row,
                one.highest - 1.0,
                0.3,
                1.0,
                facecolor=RED if one.sure else PAPER,
                edgecolor=RED,
            )
            if one.highest > one.lowest:  # the optimum is an interval, and so is the distance
                axes.plot([one.lowest] * 2, [row - 0.3, row + 0.3], color=INK, linewidth=1.2)
            marker = "o" if one.proven else "D"
            axes.plot([1.0], [row], marker=marker, color=BLUE, markersize=6, zorder=3)
            axes.annotate(
                shown(one.said, 46), (one.highest, row), (7, 0), textcoords="offset points",
                va="center", weight="bold",
            )  # fmt: skip
        axes.set_yticks(range(len(bars)), [shown(one.label, 34) for one in bars])
        axes.tick_params(axis="y", length=0)
        axes.set_ylim(len(bars) - 0.5, -0.6)
        axes.set_xlim(top**-0.02, top)
        ticks = [one for one in _TICKS if one < top]
        axes.set_xticks(ticks, [f"{one:g} ×" if one > 1 else "optimum" for one in ticks])
        axes.minorticks_off()
        axes.spines[["left"]].set_visible(False)
        axes.set_xlabel(
            "printed total over the shortest known: first problem, default reading, printed digits",
            color=MUTED,
        )
        figure.legend(
            [
                Line2D([], [], color=BLUE, marker="o", linestyle=""),
                Line2D([], [], color=BLUE, marker="D", linestyle=""),
                Patch(facecolor=RED, edgecolor=RED),
                Patch(facecolor=PAPER, edgecolor=RED),
            ],
            [
                "optimum, proven",
                "best known, no proof",
                "printed total above it",
                "the same, but rounding may explain it",
            ],
            loc="outside lower left",
            ncols=4,
        )
        finish(figure)
    return figure
