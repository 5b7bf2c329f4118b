"""Pictures of searches over many seeds: best-so-far over the iterations, and where they end."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from ...heuristics import JointRuns, Run
from ...problem import Array, TrajgapError
from ..documents import PUBLISHED, Gap, Reached, Waterfall
from .drawing import (
    INK,
    RED,
    SERIES,
    Line,
    Picture,
    drawing,
    finish,
    light_grid,
    shown,
)

Runs = Sequence[Run] | Sequence[JointRuns]
"""Runs of one algorithm: of all joints, or of each joint separately."""
_DASHES = ((0, (1, 1.5)), (0, (5, 2)), (0, (7, 2, 1, 2)), (0, (3, 1, 1, 1, 1, 1)))
"""Of the printed totals, in their order; none is a line style of the algorithms."""
_LINEAR = 0.01
"""Gaps up to this many percent stand on a linear scale, larger ones on a logarithmic one."""
_INVISIBLE = 0.02
"""Share of its own height by which a curve may move unseen, so its point is left out."""
_TICKS = (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0, 10_000.0, 100_000.0)
"""Gaps in percent that the axis may name: decades from the end of the linear part."""
_RUNS = 16
"""Runs of an algorithm drawn one by one: more thin lines on top of each other show no more."""


def convergence(
    runs: Mapping[str, Runs],
    optimum: float | Sequence[float],
    printed: Mapping[str, float | Sequence[float]],
    *,
    title: str,
    rounding: float = 0.0,
    evidence: str = "best known",
    joints: Sequence[str] = (),
) -> Picture:
    """Best-so-far of every seed, with median and quartiles, beside the optimum.

    One panel, or one per joint. The vertical axis is the gap to the optimum in percent, logarithmic
    beyond 0.01 %, and goes below zero where a search or a printed total does. `runs`: replays of
    each algorithm, by its name. `optimum`: reference total, s; one per joint for searches of single
    joints. `printed`: printed totals by label, s; one per joint (nan where none) for searches of
    single joints. `rounding`: half the width of the interval that printed digits stand for, s;
    drawn as a band. `evidence`: word for the evidence of the optimum. `joints`: joint labels; "1",
    "2", ... by default.
    """
    panels = _panels(runs)
    optima = [float(x) for x in np.atleast_1d(np.asarray(optimum, dtype=np.float64))]
    if len(optima) != len(panels):
        raise TrajgapError(
            f"convergence: {len(optima)} optima for {len(panels)} searched problems; give one each"
        )
    if not min(optima) > 0:
        raise TrajgapError("convergence: the optimum is 0 s, and no gap is a share of it")
    totals = {
        label: np.broadcast_to(np.asarray(value, dtype=np.float64), (len(panels),))
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
    with drawing():
        figure = Picture(title, description, 9.6, 1.2 + tall)
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True)
        for axes in grid.ravel()[len(panels) :]:
            axes.set_visible(False)
        for i, panel in enumerate(panels):
            axes = grid.ravel()[i]
            own = {name: float(value[i]) for name, value in totals.items()}
            _panel(axes, panel, optima[i], own, rounding)
            name = f"joint {shown(labels[i], 14)}: " if len(panels) > 1 else ""
            axes.set_title(f"{name}{evidence} optimum {optima[i]:.6f} s", fontsize=8.5)
            if i + columns >= len(panels):
                axes.tick_params(labelbottom=True)
                axes.set_xlabel("iteration")
        for row in grid:
            row[0].set_ylabel("gap of best so far, %")
        figure.legend(*_legend(runs, printed), loc="outside lower left", ncols=1, handlelength=3.2)
        finish(figure)
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
) -> None:
    low, high = 0.0, 0.0
    for (colour, line), (_, traces) in zip(_styles(len(panel)), panel.items(), strict=True):
        gaps = 100 * (traces / optimum - 1)
        iterations = np.arange(gaps.shape[1], dtype=np.float64)
        axes.add_collection(
            LineCollection(
                [_stairs(iterations, g) for g in _drawn(gaps)],
                colors=colour,
                linewidths=0.5,
                alpha=0.28,
            )
        )
        # Quantiles that are runs: a run without answer is infinite and can't be averaged.
        lower, middle, upper = np.quantile(gaps, [0.25, 0.5, 0.75], axis=0, method="inverted_cdf")
        shown_band = np.isfinite(upper)
        axes.fill_between(
            iterations, lower, upper, where=shown_band, step="post", color=colour, alpha=0.2,
            linewidth=0,
        )  # fmt: skip
        axes.plot(
            iterations, np.where(np.isfinite(middle), middle, np.nan), drawstyle="steps-post",
            color=colour, linestyle=line, linewidth=1.8,
        )  # fmt: skip
        good = gaps[np.isfinite(gaps)]
        if good.size:
            low, high = min(low, float(good.min())), max(high, float(good.max()))
    axes.axhline(0.0, color=INK, linewidth=1.3)
    for dash, value in zip(_dashes(len(printed)), printed.values(), strict=True):
        if np.isfinite(value):
            gap = 100 * (value / optimum - 1)
            axes.axhline(gap, color=RED, linestyle=dash, linewidth=1.3)
            half = 100 * rounding / optimum
            axes.axhspan(gap - half, gap + half, facecolor=RED, alpha=0.1, linewidth=0)
            low, high = min(low, gap - half), max(high, gap + half)
    axes.set_yscale("symlog", linthresh=_LINEAR, linscale=0.5)
    ticks = [t for t in _TICKS if t <= 3 * high] + [-t for t in _TICKS if t <= -low] + [0.0]
    axes.set_yticks(sorted(ticks), [f"{t:g}".replace("-", "−") for t in sorted(ticks)])
    axes.minorticks_off()
    axes.set_ylim(min(1.6 * low, -0.5 * _LINEAR), 2.0 * max(high, _LINEAR))
    axes.set_xlim(0, max(t.shape[1] - 1 for t in panel.values()))
    light_grid(axes, "y")


def _drawn(gaps: Array) -> Array:
    """The runs that are drawn one by one: all, or spread by rank from the best end to the worst."""
    if len(gaps) <= _RUNS:
        return gaps
    ranks = np.linspace(0, len(gaps) - 1, _RUNS).round().astype(np.intp)
    return gaps[np.argsort(gaps[:, -1], kind="stable")[ranks]]


def _stairs(iterations: Array, values: Array) -> Array:
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
        if level - y[i] > max(_INVISIBLE * abs(level), _INVISIBLE * _LINEAR):
            corners += [(x[i], level), (x[i], y[i])]
    corners += [(x[-1], corners[-1][1]), (x[-1], y[-1])]
    return np.array(corners)


def _styles(count: int) -> list[tuple[str, Line]]:
    return [SERIES[i % len(SERIES)] for i in range(count)]


def _dashes(count: int) -> list[tuple[int, tuple[float, ...]]]:
    return [_DASHES[i % len(_DASHES)] for i in range(count)]


def _legend(
    runs: Mapping[str, Runs], printed: Mapping[str, float | Sequence[float]]
) -> tuple[list[Line2D], list[str]]:
    handles, labels = [], []
    for (colour, line), (name, replays) in zip(_styles(len(runs)), runs.items(), strict=True):
        handles.append(Line2D([], [], color=colour, linestyle=line, linewidth=1.8))
        each = "each" if len(replays) <= _RUNS else f"{_RUNS} of them, best and worst included,"
        labels.append(
            f"{len(replays)} runs of {shown(name, 64)}: median, quartiles (band), {each} (thin)"
        )
    for dash, (label, value) in zip(_dashes(len(printed)), printed.items(), strict=True):
        handles.append(Line2D([], [], color=RED, linestyle=dash, linewidth=1.3))
        one = np.atleast_1d(np.asarray(value, dtype=np.float64))
        text = f", {one[0]:.6g} s" if one.size == 1 else ""
        labels.append(f"printed: {shown(label, 48)}{text}")
    handles.append(Line2D([], [], color=INK, linewidth=1.3))
    labels.append("optimum")
    return handles, labels


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
    with drawing():
        figure = Picture(title, description, 9.6, 1.1 + 0.55 * len(ends) + 0.24 * len(lines))
        axes = figure.subplots()
        for row, ((colour, _), (_, one)) in enumerate(
            zip(_styles(len(ends)), ends.items(), strict=True)
        ):
            good = np.sort(one[np.isfinite(one)])
            # Spread by rank, so no picture depends on a random draw.
            offset = 0.26 * (2 * ((np.arange(good.size) * 0.618034) % 1.0) - 1)
            axes.scatter(good, row + offset, s=14, color=colour, alpha=0.65, linewidths=0, zorder=3)
            if good.size:
                axes.plot(
                    [np.median(good)] * 2, [row - 0.36, row + 0.36], color=colour, linewidth=2.4
                )
        count = len(ends)
        for i, (label, value, colour) in enumerate(lines):
            at = count - 0.2 + 0.42 * i
            axes.plot([value, value], [-0.6, at], color=colour, linewidth=1.0, zorder=2)
            axes.annotate(
                f"{shown(label, 60)}, {value:.6g} s", (value, at), (4, 0),
                textcoords="offset points", va="center", fontsize=8, color=colour,
            )  # fmt: skip
        names = [f"{shown(n, 34, 2)}\n{_range(one)}" for n, one in ends.items()]
        axes.set_yticks(range(count), names)
        axes.tick_params(axis="y", length=0)
        axes.set_ylim(count - 0.2 + 0.42 * len(lines), -0.65)
        _room_for_labels(axes, ends, [value for _, value, _ in lines])
        axes.spines["left"].set_visible(False)
        axes.set_xlabel("total time, s")
        light_grid(axes, "x")
        finish(figure)
    return figure


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


def _room_for_labels(axes: Axes, ends: Mapping[str, Array], values: Sequence[float]) -> None:
    every = np.concatenate([*ends.values(), np.asarray(values, dtype=np.float64)])
    every = every[np.isfinite(every)]
    if every.size:
        width = float(np.ptp(every)) or 0.02 * float(every.max())
        axes.set_xlim(float(every.min()) - 0.04 * width, float(every.max()) + 0.42 * width)


def _range(ends: Array) -> str:
    good = ends[np.isfinite(ends)]
    missing = ends.size - good.size
    tail = f", {missing} without answer" if missing else ""
    if not good.size:
        return f"{ends.size} runs, none with an answer"
    digits = max(4, 2 - math.floor(math.log10(float(good.max()))))
    return f"{ends.size} runs, {good.min():.{digits}f} to {good.max():.{digits}f} s{tail}"
