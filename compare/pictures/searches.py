"""Pictures of runs over many seeds: best-so-far, where they end, and on other instances."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...heuristics import JointRuns, Run
from ...problem import Array, TrajgapError
from ..audits.instances import InstancesResult, distribution, percent_range
from ..documents import PUBLISHED, Effect, Gap, Reached, Waterfall
from .drawing import (
    INK,
    PAPER,
    RED,
    Picture,
    Style,
    gap_scale,
    hollow,
    legend,
    light_grid,
    name_rows,
    picture,
    series,
    shown,
)
from .gap_bands import quartile_band

Runs = Sequence[Run] | Sequence[JointRuns]
"""Runs of one algorithm: of all joints, or of each joint separately."""


def convergence(
    runs: Mapping[str, Runs],
    optimum: float | Sequence[float],
    printed: Mapping[str, float | Sequence[float]],
    *,
    title: str,
    rounding: float = 0.0,
    evidence: str = "best known",
    joints: Sequence[str] = (),
    thin: int = 16,
) -> Picture:
    """Best-so-far of every seed, with median and quartiles, beside the optimum.

    One panel, or one per joint. The vertical axis is the gap to the optimum in percent, logarithmic
    beyond 0.01 %, and goes below zero where a search or a printed total does. `runs`: replays of
    each algorithm, by its name. `optimum`: reference total, s; one per joint for searches of single
    joints. `printed`: printed totals by label, s; one per joint (nan where none) for searches of
    single joints. `rounding`: half the width of the interval that printed digits stand for, s;
    drawn as a band. `evidence`: word for the evidence of the optimum. `joints`: joint labels; "1",
    "2", ... by default. `thin`: runs of an algorithm that are drawn one by one; more thin lines on
    top of each other show no more.
    """
    panels = _panels(runs)
    optima = np.atleast_1d(np.asarray(optimum, dtype=np.float64)).tolist()
    if len(optima) != len(panels):
        raise TrajgapError(
            f"convergence: {len(optima)} optima for {len(panels)} searched problems; give one each"
        )
    if not min(optima) > 0:
        raise TrajgapError("convergence: the optimum is 0 s, and no gap is a share of it")
    totals = {
        label: np.broadcast_to(np.asarray(value, dtype=np.float64), (len(panels),)).tolist()
        for label, value in printed.items()
    }
    labels = list(joints) or [str(i + 1) for i in range(len(panels))]
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    tall = 3.4 if len(panels) == 1 else 2.1 * rows
    description = "; ".join(
        _words(f"joint {labels[i]}, " if len(panels) > 1 else "", name, one, optima[i])
        for i, panel in enumerate(panels)
        for name, one in panel.items()
    )
    with picture(title, description, 9.6, 1.2 + tall) as figure:
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True)
        for axes in grid.ravel()[len(panels) :]:
            axes.set_visible(False)
        for i, (axes, panel) in enumerate(zip(grid.ravel(), panels, strict=False)):
            own = {name: value[i] for name, value in totals.items()}
            _panel(axes, panel, optima[i], own, rounding, thin)
            name = f"joint {shown(labels[i], 14)}: " if len(panels) > 1 else ""
            axes.set_title(f"{name}{evidence} optimum {optima[i]:.6f} s", fontsize=8.5)
            if i + columns >= len(panels):
                axes.tick_params(labelbottom=True)
                axes.set_xlabel("iteration")
        for row in grid:
            row[0].set_ylabel("gap of best so far, %")
        lines = zip(*grid[0, 0].get_legend_handles_labels(), strict=True)
        signs = {_legend_words(name, runs, totals, thin): line for line, name in lines}
        legend(figure, signs, ncols=1, handlelength=3.2)
    return figure


def _panels(runs: Mapping[str, Runs]) -> list[dict[str, Array]]:
    """Traces of each panel by algorithm, each of shape (seeds, iterations + 1)."""
    panels: list[dict[str, Array]] = []
    for name, replays in runs.items():
        split = [r.runs if isinstance(r, JointRuns) else (r,) for r in replays]
        for i, seeds in enumerate(zip(*split, strict=True)):
            if i == len(panels):
                panels.append({})
            panels[i][name] = np.array([r.trace for r in seeds])
    if not panels:
        raise TrajgapError("convergence: no runs to draw")
    return panels


def _words(where: str, name: str, traces: Array, optimum: float) -> str:
    ends = traces[:, -1]
    good = ends[np.isfinite(ends)]
    if not good.size:
        return f"{where}{name}: no feasible answer in {ends.size} runs"
    return (
        f"{where}{name}: {ends.size} runs end {100 * (good.min() / optimum - 1):+.3g} to "
        f"{100 * (good.max() / optimum - 1):+.3g} % from the optimum, median "
        f"{100 * (np.median(good) / optimum - 1):+.3g} %, {ends.size - good.size} without answer"
    )


def _panel(
    axes: Axes,
    panel: Mapping[str, Array],
    optimum: float,
    printed: Mapping[str, float],
    rounding: float,
    thin: int,
    linear: float = 0.01,
) -> None:
    """Draw runs, printed totals and optimum; `linear`: percent up to which the scale is linear."""
    low, high = 0.0, 0.0
    for at, (name, traces) in enumerate(panel.items()):
        colour, line = series(at)
        gaps = 100 * (traces / optimum - 1)
        iterations = np.arange(gaps.shape[1], dtype=np.float64)
        chosen = np.arange(len(gaps))
        if len(gaps) > thin:  # of many runs some, by rank from the best end to the worst
            ranks = np.linspace(0, len(gaps) - 1, thin).round().astype(np.intp)
            chosen = np.argsort(gaps[:, -1], kind="stable")[ranks]
        curves = [_stairs(iterations, g, linear) for g in gaps[chosen]]
        axes.add_collection(LineCollection(curves, colors=colour, linewidths=0.5, alpha=0.28))
        # Quantiles that are runs: a run without answer is infinite and can't be averaged.
        bands = np.quantile(gaps, [0.25, 0.5, 0.75], axis=0, method="inverted_cdf")
        quartile_band(axes, iterations, bands, colour, line, name)
        good = gaps[np.isfinite(gaps)]
        if good.size:
            low, high = min(low, float(good.min())), max(high, float(good.max()))
    # Of the printed totals, in their order; none is a line style of the algorithms.
    dashes = ((0, (1, 1.5)), (0, (5, 2)), (0, (7, 2, 1, 2)), (0, (3, 1, 1, 1, 1, 1)))
    for at, (name, value) in enumerate(printed.items()):
        gap, half = 100 * (value / optimum - 1), 100 * rounding / optimum
        style: Style = {"color": RED, "linestyle": dashes[at % len(dashes)], "linewidth": 1.3}
        axes.axhline(gap, label=f"printed: {name}", **style)
        if np.isfinite(value):
            axes.axhspan(gap - half, gap + half, facecolor=RED, alpha=0.1, linewidth=0)
            low, high = min(low, gap - half), max(high, gap + half)
    axes.axhline(0.0, color=INK, linewidth=1.3, label="optimum")
    axes.set_yscale("symlog", linthresh=linear, linscale=0.5)
    top = 2.0 * max(high, linear)
    gap_scale(axes.yaxis, top, linear, low)
    axes.set_ylim(min(1.6 * low, -0.5 * linear), top)
    axes.set_xlim(0, max(t.shape[1] - 1 for t in panel.values()))
    light_grid(axes, "y")


def _stairs(iterations: Array, values: Array, linear: float) -> Array:
    """Corners of a best-so-far curve, nothing before the first feasible answer.

    Steps of less than a fiftieth of the gap are joined: on the logarithmic axis they are thinner
    than the line.
    """
    finite = np.isfinite(values)
    x, y = iterations[finite], values[finite]
    if not x.size:
        return np.empty((0, 2))
    corners = [(x[0], y[0])]
    for i in range(1, x.size):
        level = corners[-1][1]
        if level - y[i] > max(abs(level), linear) / 50:
            corners += [(x[i], level), (x[i], y[i])]
    corners += [(x[-1], corners[-1][1]), (x[-1], y[-1])]
    return np.array(corners)


def _legend_words(
    name: str, runs: Mapping[str, Runs], totals: Mapping[str, Sequence[float]], thin: int
) -> str:
    """What the legend says of a line that has the name of an algorithm or of a printed total."""
    if name in runs:
        many = len(runs[name])
        each = "each" if many <= thin else f"{thin} of them, best and worst included,"
        return f"{many} runs of {shown(name, 64)}: median, quartiles (band), {each} (thin)"
    label = name.removeprefix("printed: ")
    if label not in totals:
        return name
    own = totals[label]
    return f"printed: {shown(label, 48)}" + (f", {own[0]:.6g} s" if len(own) == 1 else "")


def endings(
    ends: Mapping[str, Array],
    references: Mapping[str, float],
    printed: Mapping[str, float],
    *,
    title: str,
) -> Picture:
    """Total of every run, one row per algorithm, beside references and printed totals.

    Runs without a feasible answer are counted beside their row. `ends`: shape (runs,), totals by
    name, s; inf for a run without a feasible answer. `references, printed`: totals by label, s.
    """
    lines = [(label, value, INK) for label, value in references.items()]
    lines += [(f"printed: {label}", value, RED) for label, value in printed.items()]
    # Falling, so each label stands below the ends of the lines to its right.
    lines.sort(key=lambda one: -one[1])
    description = "; ".join(
        [f"{name}: {_range(one)}" for name, one in ends.items()]
        + [f"{label}: {value:.6g} s" for label, value, _ in lines]
    )
    with picture(title, description, 9.6, 1.1 + 0.55 * len(ends) + 0.24 * len(lines)) as figure:
        axes = figure.subplots()
        for row, one in enumerate(ends.values()):
            colour, good = series(row)[0], one[np.isfinite(one)]
            spread_dots(axes, good, row, 0.26, s=14, color=colour, alpha=0.65, linewidths=0)
            if good.size:
                middle = np.median(good)
                reach = [row - 0.36, row + 0.36]
                axes.plot([middle] * 2, reach, color=colour, linewidth=2.4)
        count = len(ends)
        for i, (label, value, colour) in enumerate(lines):
            at = count - 0.2 + 0.42 * i
            axes.plot([value, value], [-0.6, at], color=colour, linewidth=1.0, zorder=2)
            axes.annotate(
                f"{shown(label, 60)}, {value:.6g} s", (value, at), (4, 0),
                textcoords="offset points", va="center", fontsize=8, color=colour,
            )  # fmt: skip
        names = [f"{shown(n, 34, 2)}\n{_range(one)}" for n, one in ends.items()]
        name_rows(axes, names, 0.8 + 0.42 * len(lines), 0.65)
        every = np.concatenate([*ends.values(), [value for _, value, _ in lines]])
        every = every[np.isfinite(every)]
        if every.size:  # at the right there is room for labels
            width = float(np.ptp(every)) or 0.02 * float(every.max())
            axes.set_xlim(float(every.min()) - 0.04 * width, float(every.max()) + 0.42 * width)
        axes.set_xlabel("total time, s")
        light_grid(axes, "x")
    return figure


def spread_dots(axes: Axes, values: Array, row: float, half: float, **style: Any) -> None:
    """Draw finite values as dots of one row, spread by rank over its height.

    A random spread would differ from picture to picture.
    """
    good = np.sort(values[np.isfinite(values)])
    jitter = half * (2 * ((np.arange(good.size) * 0.618034) % 1.0) - 1)
    axes.scatter(good, row + jitter, zorder=3, **style)


def reached_picture(
    runs: Sequence[Reached], waterfalls: Iterable[Waterfall], *, title: str
) -> Picture:
    """Where the runs of a paper's algorithms end, between the optimum and the printed total.

    `runs`: of one search. `waterfalls`: of the case, which have its printed totals.
    """
    ends = {
        f"{one.handling.replace('-', ' ')}: {one.name}": np.array(
            [*one.totals, *([np.inf] * one.unanswered)]
        )
        for one in runs
    }
    references = {one.beside: one.gap.reference.upper for one in runs if isinstance(one.gap, Gap)}
    times = [
        step.time
        for waterfall in waterfalls
        if (waterfall.problem, waterfall.reading) == (runs[0].problem, runs[0].reading)
        for step in waterfall.steps
        if step.name == PUBLISHED and isinstance(step.time, float)
    ]
    printed = {"total": times[0]} if times else {}
    return endings(ends, references, printed, title=title)


def _range(ends: Array) -> str:
    good = ends[np.isfinite(ends)]
    missing = ends.size - good.size
    tail = f", {missing} without answer" if missing else ""
    if not good.size:
        return f"{ends.size} runs, none with an answer"
    digits = max(4, 2 - math.floor(math.log10(float(good.max()))))
    return f"{ends.size} runs, {good.min():.{digits}f} to {good.max():.{digits}f} s{tail}"


_MARKERS = "os^D"
"""Of the step lengths, in their order."""
_FILLED = {"filled": INK, "hollow": PAPER}
"""What tells objectives apart: no more of them are drawn."""


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
    height = 1.9 + 0.62 * len(result.readings)
    with picture(title, "; ".join(described) + ".", 9.6, height) as figure:
        panels = figure.subplots(1, 3, sharey=True, width_ratios=(1.25, 1.25, 1.0))
        for axes, effect in zip(panels, Effect, strict=True):
            _effect_panel(axes, result, effect)
        names = []
        for reading in result.readings:
            missing = sum(
                distribution(result.reductions(reading, effect, at)).missing
                for effect in Effect
                for at in _objectives(result, effect)
            )
            beside = f"\n{missing} pairs without answer" if missing else ""
            names.append(shown(result.label(reading), 24, 3) + beside)
        name_rows(panels[0], names, 0.6)
        legend(figure, _signs(result), ncols=4)
    return figure


def _objectives(result: InstancesResult, effect: Effect) -> tuple[int, ...]:
    """Objectives that a panel tells apart; the optima have none."""
    many = min(len(_FILLED), len(result.block.objectives))
    return (0,) if effect is Effect.CURVE else tuple(range(many))


def _effect_panel(axes: Axes, result: InstancesResult, effect: Effect) -> None:
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


def _signs(result: InstancesResult) -> dict[str, Artist]:
    found: dict[str, Artist] = {}
    for which, step in enumerate(result.block.lengths):
        colour, marker = series(which)[0], _MARKERS[which % len(_MARKERS)]
        dot = Line2D([], [], color=colour, marker=marker, markersize=4, linestyle="none")
        found[f"steps of {step:g} {result.block.unit}"] = dot
    for (word, fill), objective in zip(_FILLED.items(), result.block.objectives, strict=False):
        found[f"{word}: {objective}"] = Line2D([], [], **hollow(4, face=fill))
    found["median"] = Line2D([], [], color=INK, linewidth=2.2)
    if result.printed is not None:
        found["printed"] = Patch(facecolor=RED, alpha=0.5)
    return found
