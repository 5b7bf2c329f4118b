"""Picture of a waterfall: where the time goes, from a printed total down to any curve at all."""

from __future__ import annotations

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ...nlp import Evidence
from ..documents import Step, Waterfall, Why, given
from .drawing import (
    BLUE,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PAPER,
    Picture,
    drawing,
    finish,
    shown,
)

_COLUMNS = (("to the step above", -1, 1.23, 1.36), ("to the first step", 0, 1.55, 1.68))
"""Heading, which earlier step, right edges of the seconds and the percent (bars end at 1)."""
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


def waterfall_picture(waterfall: Waterfall, *, title: str) -> Picture:
    """Bars from 0 with the seconds written on them, one per step.

    Parameters
    ----------
    waterfall : Waterfall
    title : str

    Returns
    -------
    Picture
        Certified values are solid, best known ones hatched; an interval is drawn over its bar; a
        step without a value says why.
    """
    steps = waterfall.steps
    ends = [x for s in steps for x in (s.time, s.high) if not isinstance(x, Why)]
    top = max(ends, default=1.0) or 1.0
    description = "; ".join(f"{s.name}: {seconds(s)}, {_evidence(s)}" for s in steps)
    with drawing():
        figure = Picture(title, description, 9.6, 1.1 + 0.5 * max(1, len(steps)))
        axes = figure.subplots()
        for row, step in enumerate(steps):
            _bar(axes, row, step, top)
            axes.axhline(row + 0.5, color=GRID, linewidth=0.6, zorder=0)
            before = [s.time for s in steps[:row] if not isinstance(s.time, Why)]
            if not isinstance(step.time, Why) and before:
                for _, which, *places in _COLUMNS:
                    for place, text in zip(places, _change(step.time, before[which]), strict=True):
                        axes.text(place * top, row, text, va="center", ha="right", fontsize=8)
        axes.set_yticks(range(len(steps)), [shown(s.name, 30, 2) for s in steps])
        axes.tick_params(axis="y", length=0)
        axes.set_ylim(len(steps) - 0.4, -0.9)
        axes.set_xlim(0, 1.7 * top)
        axes.spines[["left", "bottom"]].set_visible(False)
        axes.set_xticks([])
        axes.plot([0, 0], [-0.5, len(steps) - 0.5], color=MUTED, linewidth=0.8)
        for text, _, _, place in _COLUMNS:
            axes.text(place * top, -0.62, text, color=MUTED, fontsize=8, va="center", ha="right")
        present = [e for e in Evidence if any(s.evidence is e and given(s.time) for s in steps)]
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


def seconds(step: Step) -> str:
    """A step's value, with its interval where it is one.

    Parameters
    ----------
    step : Step

    Returns
    -------
    str
        Such as "3.3595 s (3.3324 to 3.4128)", or "not computed".
    """
    if isinstance(step.time, Why):
        return "not computed"
    digits = 4 if step.time >= 0.1 else 6
    text = f"{step.time:.{digits}f} s"
    low, high = step.low, step.high
    if not isinstance(low, Why) and not isinstance(high, Why):
        width = high - low
        if width > 1e-9:
            digits = min(9, max(digits, math.ceil(1 - math.log10(width))))
            text += f" ({low:.{digits}f} to {high:.{digits}f})"
    return text


def _bar(axes: Axes, row: int, step: Step, top: float) -> None:
    if isinstance(step.time, Why):
        note = shown(step.note or "not computed", 100, 2)
        axes.text(0.015 * top, row, note, color=MUTED, fontsize=8, style="italic", va="center")
        return
    axes.barh(row, step.time, height=0.62, linewidth=0.9, **_fill(step.evidence))
    end, low, high = step.time, given(step.low), given(step.high)
    if low is not None and high is not None and high - low > 2e-3 * top:
        end = max(end, high)
        axes.plot([low, high], [row, row], color=INK, linewidth=2.2, zorder=4)
        for x in (low, high):
            axes.plot([x, x], [row - 0.2, row + 0.2], color=INK, linewidth=1.4, zorder=4)
    axes.text(
        0.015 * top if step.time > 0.5 * top else end + 0.015 * top,
        row,
        seconds(step),
        va="center",
        weight="bold",
        zorder=5,
        bbox={"boxstyle": "round,pad=0.25", "facecolor": PAPER, "edgecolor": "none"},
    )


def _change(time: float, base: float) -> tuple[str, str]:
    if abs(time - base) <= 5e-5 * min(1.0, base):
        return "0 s", "0 %"
    # A step of 0 s, where nothing limits the total, has no multiples.
    share = f"{100 * (time / base - 1):+.1f} %" if base > 0 else ""
    texts = f"{time - base:+.4f} s", share
    return texts[0].replace("-", "−"), texts[1].replace("-", "−")
