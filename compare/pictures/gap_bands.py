"""Pictures against the optimum: gaps of runs, and totals as bars by step and by paper."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...nlp import Evidence
from ...problem import Array, TrajgapError
from ..documents import Step, Waterfall, Why, two_digits, value_or_none
from .drawing import (
    BLUE,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    RED,
    Line,
    Picture,
    Style,
    gap_scale,
    legend,
    light_grid,
    name_rows,
    picture,
    series,
    shown,
)


@dataclass(frozen=True, eq=False)
class Anytime:
    """Quantiles of one optimiser's runs after each number of evaluations."""

    label: str
    evaluations: Array
    """Shape (points,)."""
    gaps: Array
    """Lower quartile, median and upper quartile over the runs, relative; inf if that many know
    no answer; shape (3, points)."""
    steps: Array
    shares: Array
    """Share of pairs of run and target that are reached, from each step on."""
    runs: int

    @property
    def described(self) -> str:
        """Where its runs end, in words."""
        last = 100 * self.gaps[:, -1]
        if not np.isfinite(last[1]):
            return f"{self.label}: half of its {self.runs} runs or more find no feasible answer"
        upper = f"{last[2]:.3g}" if np.isfinite(last[2]) else "no answer"
        reached = f"{100 * self.shares[-1]:.0f}" if self.shares.size else "0"
        return (
            f"{self.label}: {self.runs} run{'s end' if self.runs > 1 else ' ends'} {last[1]:.3g} % "
            f"above the optimum in the median, quartiles {last[0]:.3g} and {upper} %; {reached} % "
            "of its (run, target) pairs are reached"
        )


def gap_picture(
    optimisers: Sequence[Anytime],
    *,
    title: str,
    uncertainty: float | None,
    budget: int,
    targets: int,
) -> Picture:
    """Anytime gap of each optimiser with its quartiles, and the share of targets reached.

    `optimisers`: their order determines colours and line styles. `uncertainty`: relative width of
    the optimum's certified interval, drawn below zero; None if no lower bound is certified.
    `budget`: evaluations of a run. `targets`: how many gaps from 100 % to 0.0001 % each run was
    asked for.
    """
    if not optimisers:
        raise TrajgapError("gap bands: no runs to draw")
    description = "; ".join(one.described for one in optimisers)
    rows = -(-(len(optimisers) + 2) // 3)
    with picture(title, description, 9.6, 4.2 + 0.22 * rows) as figure:
        bands, shares = figure.subplots(1, 2, width_ratios=(1.25, 1))
        for k, one in enumerate(optimisers):
            colour, line = series(k)
            label = f"{shown(one.label, 34)}, {one.runs} run{'s'[: one.runs > 1]}"
            quartile_band(bands, one.evaluations, 100 * one.gaps, colour, line, label)
            _share_line(shares, one.steps, one.shares, budget, colour, line)
        _gap_axis(bands, optimisers, uncertainty)
        shares.set_ylabel("(run, target) pairs reached, %")
        shares.set_title(f"{targets} targets from 100 % to 0.0001 % for each run")
        for axes in (bands, shares):
            axes.set_xscale("log")
            axes.set_xlim(1, max(budget, 2))
            decades = [10**k for k in range(len(str(budget)))]
            axes.set_xticks(decades, [f"{decade:,}" for decade in decades])
            axes.set_xlabel("evaluations")
            light_grid(axes)
        figure.legend(loc="outside lower left", ncols=3, handlelength=3.0)
    return figure


def quartile_band(
    axes: Axes, x: Array, percent: Array, colour: str, line: Line, label: str
) -> None:
    """Draw the median of runs and the band of their quartiles, `percent` of shape (3, points).

    An infinite quartile has no place on the axis: the band is open above, and a line ends.
    """
    lower, middle = np.where(np.isfinite(percent[:2]), percent[:2], np.nan)
    top = np.where(np.isfinite(percent[2]), percent[2], 1e9)
    axes.fill_between(
        x, lower, top, where=np.isfinite(lower), step="post", color=colour, alpha=0.16, linewidth=0
    )
    axes.plot(
        x, middle, drawstyle="steps-post", color=colour, linestyle=line, linewidth=1.7, label=label
    )


def _share_line(axes: Axes, x: Array, shares: Array, end: float, colour: str, line: Line) -> None:
    """Draw a share in percent that holds from each place on, as far as the end of the axis."""
    x = np.concatenate([x, [end]])
    y = 100 * np.concatenate([shares, shares[-1:] if shares.size else [0.0]])
    axes.plot(x, y, color=colour, linestyle=line, drawstyle="steps-post")
    axes.set_ylim(0, 103)


def _gap_axis(
    axes: Axes, optimisers: Sequence[Anytime], uncertainty: float | None, linear: float = 1e-4
) -> None:
    """Scale gaps up to 100 %: those of first positions may be many times as large.

    `linear`: percent up to which the scale is linear, a millionth: a solver's accuracy.
    """
    ends = np.concatenate([100 * one.gaps.ravel() for one in optimisers])
    good = ends[np.isfinite(ends)]
    low = min(0.0, float(good.min())) if good.size else 0.0
    high = min(100.0, float(good.max())) if good.size else 1.0
    known = "optimum" if uncertainty is not None else "best known, no lower bound proved"
    axes.axhline(0.0, color=INK, linewidth=1.3, label=known)
    if uncertainty:
        width = 100 * uncertainty
        label = f"interval of the optimum: {two_digits(width)} %"
        axes.axhspan(-width, 0.0, facecolor=GRID, linewidth=0, zorder=0, label=label)
        low = min(low, -width)
    axes.set_yscale("symlog", linthresh=linear, linscale=0.4)
    gap_scale(axes.yaxis, 1.01 * max(high, linear), linear, low)
    axes.set_ylim(min(1.6 * low, -0.4 * linear), 1.3 * max(high, linear))
    axes.set_ylabel("gap of best so far, %")
    axes.set_title("median and quartiles over the runs")


def profile_picture(profiles: Mapping[str, tuple[Array, Array]], *, title: str) -> Picture:
    """Performance profiles against the optimum: share of runs within each gap.

    `profiles`: of each optimiser, as `share_within` gives them; colours and line styles in this
    order.
    """
    description = "; ".join(
        f"{label}: {100 * float(shares[ratios <= 1.01].max(initial=0.0)):.0f} % of runs end within "
        "1 % of the optimum"
        for label, (ratios, shares) in profiles.items()
    )
    edge, most = 1e-5, 100.0  # percent; what is smaller is drawn at the edge
    with picture(title, description, 9.6, 3.4 + 0.22 * -(-len(profiles) // 3)) as figure:
        axes = figure.subplots()
        for k, (label, (ratios, shares)) in enumerate(profiles.items()):
            x = np.concatenate([[edge], np.maximum(100 * (ratios - 1), edge)])
            _share_line(axes, x, np.concatenate([[0.0], shares]), most, *series(k))
            axes.lines[-1].set_label(shown(label, 34))
        axes.set_xscale("log")
        gap_scale(axes.xaxis, most, 10 * edge)
        axes.set_xlim(edge, most)
        axes.set_xlabel("gap at the end of the run, %; smaller ones at the left edge")
        axes.set_ylabel("runs within it, %")
        light_grid(axes)
        figure.legend(loc="outside lower left", ncols=3, handlelength=3.0)
    return figure


@dataclass(frozen=True, eq=False)
class BoardPanel:
    """Optimisers of the leaderboard under one handling."""

    title: str
    marked: dict[str, Array]
    """Share of runs within each gap, of optimisers that are told apart, by what they are called;
    shape (gaps,)."""
    others: Sequence[Array]
    """Those that are drawn in grey; shape (gaps,)."""


def leaderboard_picture(
    panels: Sequence[BoardPanel], gaps: Sequence[float], *, title: str
) -> Picture:
    """Share of runs within each of falling relative gaps, a panel for each handling."""
    description = "; ".join(
        f"{panel.title}: {label}, " + ", ".join(
            f"{100 * share:.0f} % of the runs within {100 * gap:g} %"
            for gap, share in zip(gaps, shares, strict=True)
            if gap in (0.01, 1e-4)
        )
        for panel in panels
        for label, shares in panel.marked.items()
    )  # fmt: skip
    with picture(title, description, 9.6, 5.0) as figure:
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axes, panel in zip(grid, panels, strict=True):
            _board(axes, panel, np.asarray(gaps))
        grid[0].set_ylabel("runs that come so near, %")
    return figure


def _board(axes: Axes, panel: BoardPanel, gaps: Array) -> None:
    for at, (label, shares) in enumerate(panel.marked.items()):
        colour, line = series(at)
        style: Style = {"color": colour, "linestyle": line, "linewidth": 2.2, "zorder": 3}
        axes.plot(gaps, 100 * shares, label=shown(label, 52), **style)
    for at, shares in enumerate(panel.others):
        named = f"{len(panel.others)} other optimisers" if at == 0 else None
        axes.plot(gaps, 100 * shares, color=GRID, linewidth=1.0, label=named)
    axes.set_xscale("log")
    axes.set_xlim(gaps[0], gaps[-1])
    ticks = [10.0**k for k in range(0, -7, -1)]
    axes.set_xticks(ticks, [f"{100 * tick:.10g} %" for tick in ticks])
    axes.minorticks_off()
    axes.set_ylim(0, 102)
    axes.set_xlabel("distance from the certified optimum, at most")
    axes.set_title(panel.title)
    light_grid(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.17), handlelength=3.0)


_FILLS: dict[Evidence, Style] = {
    Evidence.CERTIFIED: {"facecolor": BLUE, "edgecolor": BLUE, "hatch": ""},
    Evidence.BEST_KNOWN: {"facecolor": PAPER, "edgecolor": BLUE, "hatch": "////"},
    Evidence.UNCONVERGED: {"facecolor": PAPER, "edgecolor": BLUE, "hatch": "...."},
    Evidence.NONE: {"facecolor": ORANGE, "edgecolor": ORANGE, "hatch": ""},
}
"""Fill of a bar by what stands behind its value."""
_WORDS = {
    Evidence.CERTIFIED: "certified",
    Evidence.BEST_KNOWN: "best known",
    Evidence.UNCONVERGED: "not converged",
    Evidence.NONE: "printed, or derived from it",
}
"""The same in words, for the legend and the description."""


def waterfall_picture(waterfall: Waterfall, *, title: str, narrow: bool = False) -> Picture:
    """Bars from 0 with the seconds written on them, one per step.

    Certified values are solid, best known ones hatched; an interval is drawn over its bar; a step
    without a value says why. `narrow`: for half a page: without steps that have no value, and
    seconds without their interval.
    """
    steps = waterfall.steps
    if narrow:
        steps = tuple(s for s in steps if not isinstance(s.time, Why)) or steps
    # Right edges of the seconds and the percent beside the bars, which end at 1.
    edges = (1.34, 1.58) if narrow else (1.2, 1.36)
    width = 6.2 if narrow else 9.6
    ends = [x for s in steps for x in (s.time, s.high) if not isinstance(x, Why)]
    top = max(ends, default=1.0) or 1.0
    description = "; ".join(
        f"{s.name}: {s.total()}, {s.note if isinstance(s.time, Why) else _WORDS[s.evidence]}"
        for s in steps
    )
    with picture(title, description, width, 1.1 + 0.5 * max(1, len(steps))) as figure:
        axes = figure.subplots()
        for row, step in enumerate(steps):
            _bar(axes, row, step, top, narrow)
            axes.axhline(row + 0.5, color=GRID, linewidth=0.6, zorder=0)
            before = [s.time for s in steps[:row] if not isinstance(s.time, Why)]
            if not isinstance(step.time, Why) and before:
                for edge, text in zip(edges, _beside(before[0], step.time), strict=True):
                    axes.text(edge * top, row, text, va="center", ha="right", fontsize=8)
        names = [shown(s.name, 24 if narrow else 30, 3) for s in steps]
        name_rows(axes, names, 0.6, 0.9)
        axes.set_xlim(0, (edges[-1] + 0.02) * top)
        axes.spines["bottom"].set_visible(False)
        axes.set_xticks([])
        axes.plot([0, 0], [-0.5, len(steps) - 0.5], color=MUTED, linewidth=0.8)
        heading: Style = {"color": MUTED, "fontsize": 8, "va": "center", "ha": "right"}
        axes.text(edges[-1] * top, -0.62, "first step relative to this one", **heading)
        present = [
            e for e in Evidence if any(s.evidence is e and value_or_none(s.time) for s in steps)
        ]
        signs = {_WORDS[e]: Patch(linewidth=0.9, **_FILLS[e]) for e in present}
        place: Style = {"loc": "upper left", "bbox_to_anchor": (0.0, 0.0)}
        legend(axes, signs, ncols=3, handlelength=2.4, **place)
    return figure


def _bar(axes: Axes, row: int, step: Step, top: float, narrow: bool) -> None:
    if isinstance(step.time, Why):
        note = shown(step.note or "not computed", 100, 2)
        axes.text(0.015 * top, row, note, color=MUTED, fontsize=8, style="italic", va="center")
        return
    axes.barh(row, step.time, height=0.62, linewidth=0.9, **_FILLS[step.evidence])
    end, low, high = step.time, value_or_none(step.low), value_or_none(step.high)
    if low is not None and high is not None and high - low > 2e-3 * top:
        end = max(end, high)
        axes.plot([low, high], [row, row], color=INK, linewidth=2.2, zorder=4)
        for x in (low, high):
            axes.plot([x, x], [row - 0.2, row + 0.2], color=INK, linewidth=1.4, zorder=4)
    axes.text(
        0.015 * top if step.time > 0.5 * top else end + 0.015 * top, row,
        step.total(ends=not narrow), va="center", weight="bold", zorder=5,
        bbox={"boxstyle": "round,pad=0.25", "facecolor": PAPER, "edgecolor": "none"},
    )  # fmt: skip


def _beside(first: float, time: float) -> tuple[str, str]:
    """How much longer the first step takes than another one, in seconds and in percent of it."""
    if abs(first - time) <= 5e-5 * min(1.0, time):
        return "0 s", "0 %"
    apart = f"{first - time:+.4f} s".replace("-", "−")
    if time <= 0:  # where nothing limits the total; it has no multiples
        return apart, ""
    many = first / time  # beyond eleven times, a multiple says more than a percentage
    return apart, f"{many:.1f} ×" if many > 11 else f"{100 * (many - 1):+.1f} %".replace("-", "−")


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
    # Twice the longest bar: room for its words.
    top = 2.0 * max([one.highest for one in bars], default=1.0)
    with picture(title, description, 9.6, 1.3 + 0.42 * max(1, len(bars))) as figure:
        axes = figure.subplots()
        axes.set_xscale("log")
        axes.axvline(1.0, color=INK, linewidth=1.3)
        for row, one in enumerate(bars):
            axes.axhline(row, color=GRID, linewidth=0.6, zorder=0)
            fill = RED if one.sure else PAPER
            axes.barh(row, one.highest - 1.0, 0.3, 1.0, facecolor=fill, edgecolor=RED)
            if one.highest > one.lowest:  # the optimum is an interval, and so is the distance
                axes.plot([one.lowest] * 2, [row - 0.3, row + 0.3], color=INK, linewidth=1.2)
            marker = "o" if one.proven else "D"
            axes.plot([1.0], [row], marker=marker, color=BLUE, markersize=6, zorder=3)
            axes.annotate(
                shown(one.said, 46), (one.highest, row), (7, 0), textcoords="offset points",
                va="center", weight="bold",
            )  # fmt: skip
        name_rows(axes, [shown(one.label, 34) for one in bars], 0.5)
        axes.set_xlim(top**-0.02, top)
        named = (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0)
        ticks = [one for one in named if one < top]
        axes.set_xticks(ticks, [f"{one:g} ×" if one > 1 else "optimum" for one in ticks])
        axes.minorticks_off()
        said = (
            "printed total over the shortest known: first problem, default reading, printed digits"
        )
        axes.set_xlabel(said, color=MUTED)
        signs = {
            "optimum, proven": Line2D([], [], color=BLUE, marker="o", linestyle=""),
            "best known, no proof": Line2D([], [], color=BLUE, marker="D", linestyle=""),
            "printed total above it": Patch(facecolor=RED, edgecolor=RED),
            "the same, but rounding may explain it": Patch(facecolor=PAPER, edgecolor=RED),
        }
        legend(figure, signs, ncols=4)
    return figure
