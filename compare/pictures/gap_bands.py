"""Pictures of a bench: gaps over evaluations, targets reached, and where runs end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...problem import Array, TrajgapError
from .drawing import (
    GRID,
    INK,
    MUTED,
    SERIES,
    SKY,
    Line,
    Picture,
    drawing,
    finish,
    light_grid,
    shown,
)

_LINEAR = 1e-4
"""Gaps up to this many percent stand on a linear scale: a millionth, a solver's accuracy."""
_TICKS = (1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)
"""Gaps in percent that the axis may name: decades from the end of the linear part."""
_LARGEST = 100.0
"""Percent up to which gaps are drawn: first positions may be many times the optimum."""
_STYLES: tuple[tuple[str, Line], ...] = (
    *SERIES, (SKY, "-"), (INK, "-."), (MUTED, "--"), (INK, ":"), (MUTED, "-"),
)  # fmt: skip
"""Colour and line style of the optimisers, in order; from the tenth on they come again."""


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


def gap_picture(
    optimisers: Sequence[Anytime],
    *,
    title: str,
    uncertainty: float | None,
    budget: int,
    targets: int,
) -> Picture:
    """Anytime gap of each optimiser with its quartiles, and the share of targets reached.

    Two panels over evaluations on a logarithmic axis. `optimisers`: their order determines colours
    and line styles. `uncertainty`: relative width of the optimum's certified interval, drawn below
    zero; None if no lower bound is certified. `budget`: evaluations of a run. `targets`: how many
    gaps from 100 % to 0.0001 % each run was asked for.
    """
    if not optimisers:
        raise TrajgapError("gap bands: no runs to draw")
    description = "; ".join(_words(one) for one in optimisers)
    rows = -(-(len(optimisers) + 2) // 3)
    with drawing():
        figure = Picture(title, description, 9.6, 4.2 + 0.22 * rows)
        bands, shares = figure.subplots(1, 2, width_ratios=(1.25, 1))
        styles = [_STYLES[i % len(_STYLES)] for i in range(len(optimisers))]
        for one, (colour, line) in zip(optimisers, styles, strict=True):
            _band(bands, one, colour, line)
            steps = np.concatenate([one.steps, [budget]])
            reached = np.concatenate([one.shares, one.shares[-1:] if one.shares.size else [0.0]])
            shares.plot(steps, 100 * reached, color=colour, linestyle=line, drawstyle="steps-post")
        _gap_axis(bands, optimisers, uncertainty, budget)
        shares.set_ylim(0, 103)
        shares.set_ylabel("(run, target) pairs reached, %")
        shares.set_title(f"{targets} targets from 100 % to 0.0001 % for each run")
        for axes in (bands, shares):
            axes.set_xscale("log")
            axes.set_xlim(1, max(budget, 2))
            decades = [10**k for k in range(len(str(budget)))]
            axes.set_xticks(decades, [f"{decade:,}" for decade in decades])
            axes.set_xlabel("evaluations")
            light_grid(axes)
        figure.legend(
            *_legend(optimisers, styles, uncertainty), loc="outside lower left", ncols=3,
            handlelength=3.0,
        )  # fmt: skip
        finish(figure)
    return figure


def _band(axes: Axes, one: Anytime, colour: str, line: Line) -> None:
    percent = 100 * one.gaps
    # A quartile that is infinite has no place on the axis; the others of that moment do.
    lower, middle = np.where(np.isfinite(percent[:2]), percent[:2], np.nan)
    top = np.where(np.isfinite(percent[2]), percent[2], 10 * _LARGEST)
    axes.fill_between(
        one.evaluations, lower, top, where=np.isfinite(lower), step="post", color=colour,
        alpha=0.16, linewidth=0,
    )  # fmt: skip
    axes.plot(
        one.evaluations, middle, color=colour, linestyle=line, linewidth=1.7,
        drawstyle="steps-post",
    )  # fmt: skip


def _gap_axis(
    axes: Axes, optimisers: Sequence[Anytime], uncertainty: float | None, budget: int
) -> None:
    ends = np.concatenate([100 * one.gaps.ravel() for one in optimisers])
    good = ends[np.isfinite(ends)]
    low = min(0.0, float(good.min())) if good.size else 0.0
    high = min(_LARGEST, float(good.max())) if good.size else 1.0
    axes.axhline(0.0, color=INK, linewidth=1.3)
    if uncertainty:
        width = 100 * uncertainty
        axes.axhspan(-width, 0.0, facecolor=GRID, linewidth=0, zorder=0)
        low = min(low, -width)
    axes.set_yscale("symlog", linthresh=_LINEAR, linscale=0.4)
    ticks = sorted(
        [t for t in _TICKS if t <= 1.01 * high] + [-t for t in _TICKS if t <= -low] + [0.0]
    )
    axes.set_yticks(ticks, [_plain(t) for t in ticks])
    axes.minorticks_off()
    axes.set_ylim(min(1.6 * low, -0.4 * _LINEAR), 1.3 * max(high, _LINEAR))
    axes.set_ylabel("gap of best so far, %")
    axes.set_title("median and quartiles over the runs")


def _plain(tick: float) -> str:
    """Percent without an exponent, two digits that count."""
    text = np.format_float_positional(tick, precision=2, fractional=False, trim="-")
    return text.replace("-", "−")


def _legend(
    optimisers: Sequence[Anytime],
    styles: Sequence[tuple[str, Line]],
    uncertainty: float | None,
) -> tuple[list[Line2D | Patch], list[str]]:
    handles: list[Line2D | Patch] = [
        Line2D([], [], color=colour, linestyle=line, linewidth=1.7) for colour, line in styles
    ]
    labels = [f"{shown(one.label, 34)}, {one.runs} run{'s'[: one.runs > 1]}" for one in optimisers]
    handles.append(Line2D([], [], color=INK, linewidth=1.3))
    labels.append("optimum" if uncertainty is not None else "best known, no lower bound proved")
    if uncertainty:
        handles.append(Patch(facecolor=GRID))
        labels.append(f"interval of the optimum: {_plain(100 * uncertainty)} %")
    return handles, labels


def _words(one: Anytime) -> str:
    last = 100 * one.gaps[:, -1]
    if not np.isfinite(last[1]):
        return f"{one.label}: half of its {one.runs} runs or more find no feasible answer"
    upper = f"{last[2]:.3g}" if np.isfinite(last[2]) else "no answer"
    reached = f"{100 * one.shares[-1]:.0f}" if one.shares.size else "0"
    return (
        f"{one.label}: {one.runs} run{'s end' if one.runs > 1 else ' ends'} {last[1]:.3g} % above "
        f"the optimum in the median, quartiles {last[0]:.3g} and {upper} %; {reached} % of "
        "its (run, target) pairs are reached"
    )


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
    with drawing():
        figure = Picture(title, description, 9.6, 3.4 + 0.22 * -(-len(profiles) // 3))
        axes = figure.subplots()
        handles = []
        for i, (ratios, shares) in enumerate(profiles.values()):
            colour, line = _STYLES[i % len(_STYLES)]
            gaps = np.maximum(100 * (ratios - 1), _LINEAR / 10)  # below it all is drawn at the edge
            x = np.concatenate([[_LINEAR / 10], gaps, [_LARGEST]])
            y = 100 * np.concatenate([[0.0], shares, shares[-1:] if shares.size else [0.0]])
            axes.plot(x, y, color=colour, linestyle=line, drawstyle="steps-post")
            handles.append(Line2D([], [], color=colour, linestyle=line, linewidth=1.7))
        axes.set_xscale("log")
        axes.set_xlim(_LINEAR / 10, _LARGEST)
        ticks = [t for t in _TICKS if t <= _LARGEST]
        axes.set_xticks(ticks, [_plain(t) for t in ticks])
        axes.set_ylim(0, 103)
        axes.set_xlabel("gap at the end of the run, %; smaller ones at the left edge")
        axes.set_ylabel("runs within it, %")
        light_grid(axes)
        figure.legend(
            handles, [shown(label, 34) for label in profiles], loc="outside lower left", ncols=3,
            handlelength=3.0,
        )  # fmt: skip
        finish(figure)
    return figure
