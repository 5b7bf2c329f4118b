"""The picture of other instances: what both procedures, algorithm and curve alone save."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..audits.instances import InstancesResult, distribution, percent_range
from ..documents import Effect
from .drawing import (
    INK,
    PAPER,
    RED,
    Picture,
    drawing,
    finish,
    hollow,
    light_grid,
    name_rows,
    series,
    shown,
)
from .searches import spread_dots

_MARKERS = "os^D"
"""Of the step lengths, in their order."""
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
        names = [_label(result, reading) for reading in result.readings]
        name_rows(panels[0], names, 0.6)
        figure.legend(*_legend(result), loc="outside lower left", ncols=4)
        finish(figure)
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
            y = row + 0.2 * (2 * at - len(objectives) + 1)
            for which, step in enumerate(result.block.lengths):
                values = 100 * result.reductions(reading, effect, at, step)
                colour = series(which)[0]
                spread_dots(
                    axes, values, y, 0.1, s=16, marker=_MARKERS[which % len(_MARKERS)],
                    facecolor=colour if at == 0 else PAPER, edgecolor=colour, linewidths=0.8,
                    alpha=0.8,
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
    found: dict[str, Line2D | Patch] = {}
    for which, step in enumerate(result.block.lengths):
        colour, marker = series(which)[0], _MARKERS[which % len(_MARKERS)]
        dot = Line2D([], [], color=colour, marker=marker, markersize=4, linestyle="none")
        found[f"steps of {step:g} {result.block.unit}"] = dot
    for at, objective in enumerate(result.block.objectives[:_SHOWN_OBJECTIVES]):
        word, fill = ("filled", INK) if at == 0 else ("hollow", PAPER)
        found[f"{word}: {objective}"] = Line2D([], [], **hollow(4, face=fill))
    found["median"] = Line2D([], [], color=INK, linewidth=2.2)
    if result.printed is not None:
        found["printed"] = Patch(facecolor=RED, alpha=0.5)
    return list(found.values()), list(found)
