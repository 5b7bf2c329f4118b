"""Pictures of totals as bars: the steps from a printed total down, and the audited papers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...nlp import Evidence
from ..documents import Step, Waterfall, Why, value_or_none
from .drawing import (
    BLUE,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    RED,
    Picture,
    Style,
    drawing,
    finish,
    name_rows,
    shown,
)

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
    description = "; ".join(f"{s.name}: {s.total()}, {_evidence(s)}" for s in steps)
    with drawing():
        figure = Picture(title, description, width, 1.1 + 0.5 * max(1, len(steps)))
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
        axes.legend(
            [Patch(linewidth=0.9, **_FILLS[e]) for e in present], [_WORDS[e] for e in present],
            loc="upper left", bbox_to_anchor=(0.0, 0.0), ncols=3, handlelength=2.4,
        )  # fmt: skip
        finish(figure)
    return figure


def _evidence(step: Step) -> str:
    return step.note if isinstance(step.time, Why) else _WORDS[step.evidence]


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
    with drawing():
        figure = Picture(title, description, 9.6, 1.3 + 0.42 * max(1, len(bars)))
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
        figure.legend(list(signs.values()), list(signs), loc="outside lower left", ncols=4)
        finish(figure)
    return figure
