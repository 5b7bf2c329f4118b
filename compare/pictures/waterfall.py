"""Picture of a waterfall: where the time goes, from a printed total down to any curve at all."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ...nlp import Evidence
from ..documents import Step, Waterfall, Why, value_or_none
from .drawing import BLUE, GRID, INK, MUTED, ORANGE, PAPER, Picture, drawing, finish, shown

_HEADING = "first step relative to this one"
"""Above the column that sets the first step beside each: one percentage per distance."""
_EDGES = (1.2, 1.36)
"""Right edges of the seconds and the percent in that column (bars end at 1)."""
_MANY = 10
"""Distance, as a share, beyond which a multiple says more than a percentage."""
_NARROW = (1.34, 1.58)
"""The same for half a page, where type is as large and bars are shorter."""
_FILLS = {
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
    edges = _NARROW if narrow else _EDGES
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
        axes.set_yticks(range(len(steps)), [shown(s.name, 24 if narrow else 30, 3) for s in steps])
        axes.tick_params(axis="y", length=0)
        axes.set_ylim(len(steps) - 0.4, -0.9)
        axes.set_xlim(0, (edges[-1] + 0.02) * top)
        axes.spines[["left", "bottom"]].set_visible(False)
        axes.set_xticks([])
        axes.plot([0, 0], [-0.5, len(steps) - 0.5], color=MUTED, linewidth=0.8)
        place = edges[-1] * top
        axes.text(place, -0.62, _HEADING, color=MUTED, fontsize=8, va="center", ha="right")
        present = [
            e for e in Evidence if any(s.evidence is e and value_or_none(s.time) for s in steps)
        ]
        axes.legend(
            [Patch(linewidth=0.9, **_fill(e)) for e in present],
            [_WORDS[e] for e in present],
            loc="upper left",
            bbox_to_anchor=(0.0, 0.0),
            ncols=3,
            handlelength=2.4,
        )
        finish(figure)
    return figure


def _fill(evidence: Evidence) -> dict[str, Any]:
    return _FILLS[evidence]


def _evidence(step: Step) -> str:
    return step.note if isinstance(step.time, Why) else _WORDS[step.evidence]


def _bar(axes: Axes, row: int, step: Step, top: float, narrow: bool) -> None:
    if isinstance(step.time, Why):
        note = shown(step.note or "not computed", 100, 2)
        axes.text(0.015 * top, row, note, color=MUTED, fontsize=8, style="italic", va="center")
        return
    axes.barh(row, step.time, height=0.62, linewidth=0.9, **_fill(step.evidence))
    end, low, high = step.time, value_or_none(step.low), value_or_none(step.high)
    if low is not None and high is not None and high - low > 2e-3 * top:
        end = max(end, high)
        axes.plot([low, high], [row, row], color=INK, linewidth=2.2, zorder=4)
        for x in (low, high):
            axes.plot([x, x], [row - 0.2, row + 0.2], color=INK, linewidth=1.4, zorder=4)
    axes.text(
        0.015 * top if step.time > 0.5 * top else end + 0.015 * top,
        row,
        step.total(ends=not narrow),
        va="center",
        weight="bold",
        zorder=5,
        bbox={"boxstyle": "round,pad=0.25", "facecolor": PAPER, "edgecolor": "none"},
    )


def _beside(first: float, time: float) -> tuple[str, str]:
    """How much longer the first step takes than another one, in seconds and in percent of it."""
    if abs(first - time) <= 5e-5 * min(1.0, time):
        return "0 s", "0 %"
    # A step of 0 s, where nothing limits the total, has no multiples.
    share = first / time - 1 if time > 0 else None
    if share is None:
        shown = ""
    elif share > _MANY:
        shown = f"{1 + share:.1f} ×"
    else:
        shown = f"{100 * share:+.1f} %"
    return f"{first - time:+.4f} s".replace("-", "−"), shown.replace("-", "−")
