"""The picture of other instances: what both procedures, algorithm and curve alone save."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..audits.instances import InstancesResult, distribution, percent_range
from ..documents import Effect
from .drawing import INK, PAPER, RED, SERIES, Picture, drawing, light_grid, shown

_MARKERS = ("o", "s", "^", "D")
"""Of the step lengths, in their order."""
_OFFSET = 0.2
"""Distance of the rows of the objectives from the middle of their reading."""
_SHOWN_OBJECTIVES = 2
"""Objectives that are drawn: filled and hollow tell two apart."""


def instances_picture(result: InstancesResult, *, title: str) -> Picture:
    """Reductions of the total on every instance, one row for each reading.

    Three panels: both together with the printed reduction as a band, the algorithm alone, and the
    curve alone at the best known optima. Nothing is clipped; pairs without answer are counted
    beside their row. `result`: its first two objectives are drawn.
    """
    described = [
        f"{result.label(reading)}: {effect} {distribution(result.reductions(reading, effect))}"
        for reading in result.readings
        for effect in Effect
    ]
    if result.printed is not None:
        described.append(f"printed: {percent_range(*result.printed)}")
    with drawing():
        figure = Picture(title, "; ".join(described) + ".", 9.6, 1.9 + 0.62 * len(result.readings))
        panels = figure.subplots(1, 3, sharey=True, width_ratios=(1.25, 1.25, 1.0))
        for axes, effect in zip(panels, Effect, strict=True):
            _panel(axes, result, effect)
        rows = range(len(result.readings))
        panels[0].set_yticks(rows, [_label(result, reading) for reading in result.readings])
        panels[0].set_ylim(len(result.readings) - 0.4, -0.6)
        handles, names = _legend(result)
        figure.legend(handles, names, loc="outside lower left", ncols=4)
        figure.suptitle(shown(title, 105, 2), x=0.005, ha="left", fontsize=11, weight="bold")
        # The layout moves a little with every drawing; frozen, it gives the same bytes.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    return figure


def _objectives(result: InstancesResult, effect: Effect) -> tuple[int, ...]:
    """Objectives that a panel tells apart; the optima have none."""
    many = min(_SHOWN_OBJECTIVES, len(result.block.objectives))
    return (0,) if effect is Effect.CURVE else tuple(range(many))


def _label(result: InstancesResult, reading: str) -> str:
    missing = sum(
        distribution(result.reductions(reading, effect, at)).missing
        for effect in Effect
        for at in _objectives(result, effect)
    )
    return shown(result.label(reading), 24, 3) + (
        f"\n{missing} pairs without answer" if missing else ""
    )


def _panel(axes: Axes, result: InstancesResult, effect: Effect) -> None:
    if effect is Effect.BOTH and result.printed is not None:
        low, high = (100 * x for x in result.printed)
        axes.axvspan(low, high, facecolor=RED, alpha=0.35, linewidth=0)
        axes.axvline((low + high) / 2, color=RED, linewidth=1.0)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    objectives = _objectives(result, effect)
    for row, reading in enumerate(result.readings):
        for at in objectives:
            y = row + _OFFSET * (2 * at - len(objectives) + 1)
            for which, step in enumerate(result.block.lengths):
                colour = SERIES[which % len(SERIES)][0]
                values = 100 * result.reductions(reading, effect, at, step)
                good = np.sort(values[np.isfinite(values)])
                # Spread by rank, so no picture depends on a random draw.
                jitter = 0.1 * (2 * ((np.arange(good.size) * 0.618034) % 1.0) - 1)
                axes.scatter(
                    good, y + jitter, s=16, marker=_MARKERS[which % len(_MARKERS)],
                    facecolor=colour if at == 0 else PAPER, edgecolor=colour, linewidths=0.8,
                    alpha=0.8, zorder=3,
                )  # fmt: skip
            found = distribution(result.reductions(reading, effect, at))
            if found.missing < found.pairs:
                middle = 100 * found.median
                axes.plot([middle] * 2, [y - 0.17, y + 0.17], color=INK, linewidth=2.2, zorder=4)
    axes.set_title(str(effect))
    axes.set_xlabel("reduction of the total, %")
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    light_grid(axes, "x")


def _legend(result: InstancesResult) -> tuple[list[Line2D | Patch], list[str]]:
    handles: list[Line2D | Patch] = []
    names = []
    for which, step in enumerate(result.block.lengths):
        colour, marker = SERIES[which % len(SERIES)][0], _MARKERS[which % len(_MARKERS)]
        handles.append(Line2D([], [], color=colour, marker=marker, markersize=4, linestyle="none"))
        names.append(f"steps of {step:g} {result.block.unit}")
    for at, objective in enumerate(result.block.objectives[:_SHOWN_OBJECTIVES]):
        fill = INK if at == 0 else PAPER
        handles.append(
            Line2D(
                [], [], marker="o", markersize=4, linestyle="none", markerfacecolor=fill,
                markeredgecolor=INK,
            )
        )  # fmt: skip
        names.append(f"{'filled' if at == 0 else 'hollow'}: {objective}")
    handles.append(Line2D([], [], color=INK, linewidth=2.2))
    names.append("median")
    if result.printed is not None:
        handles.append(Patch(facecolor=RED, alpha=0.5))
        names.append("printed")
    return handles, names
