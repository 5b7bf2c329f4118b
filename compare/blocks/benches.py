"""What a bench says of optimisers, on one problem and over all of them."""

from __future__ import annotations

from collections.abc import Sequence

from ...problem import shown_bound
from ..documents import (
    BENCH_COLUMNS,
    SHOWN_GAPS,
    BenchResult,
    OverallStanding,
    Reference,
    bench_cells,
    gap_cell,
    percent,
    value_or_none,
)
from .tree import Block, Prose, table

_OVERALL = (
    "optimizer", ">median of median gaps", ">worst", ">first on", ">runs ≤ 1 %", ">runs ≤ 0.01 %",
    ">solved to 1 %", ">solved to 0.01 %",
)  # fmt: skip
"""What a table says of each optimiser over all problems."""
_LEADING_GAP = 0.01
"""Gap of the sentence that leads over many problems: what a paper's digits can tell apart."""


def overall_blocks(standings: Sequence[OverallStanding]) -> tuple[Block, ...]:
    """Which optimiser comes within 1 % most often, and a row for each."""
    rows = []
    for one in standings:
        shown = [t for t in one.targets if t.gap in SHOWN_GAPS]
        gaps = gap_cell(one.median), gap_cell(one.worst)
        shares = [f"{100 * target.rate:.0f} %" for target in shown]
        solved = [f"{target.solved} of {one.problems}" for target in shown]
        rows.append((one.optimizer, *gaps, one.first, *shares, *solved))
    return Prose(_most_solved(standings), "lead"), table(_OVERALL, rows)


def _most_solved(standings: Sequence[OverallStanding]) -> str:
    """Which optimiser comes within 1 % most often, in a sentence."""
    first = standings[0]
    share, *others = [
        f"{100 * target.rate:.0f} %"
        for one in standings
        for target in one.targets
        if target.gap == _LEADING_GAP
    ]
    said = (
        f"Within 1 % of the optimum most often: {first.optimizer}, in {share} of its runs over "
        f"{first.problems} problems"
    )
    return said + (f"; next {standings[1].optimizer} with {others[0]}." if others else ".")


def bench_blocks(result: BenchResult) -> tuple[Block, ...]:
    """Which optimiser is closest, what is known of the optimum, a row for each, and notes."""
    messages = [(one.optimizer, message) for one in result.standings for message in one.messages]
    return (
        Prose(result.verdict, "lead"),
        Prose(_optimum_said(result.optimum)),
        table(BENCH_COLUMNS, map(bench_cells, result.standings)),
        *(Prose(f"{name}: {message}", "warning") for name, message in messages),
        *(Prose(note, "note") for note in result.notes),
    )


def _optimum_said(optimum: Reference) -> str:
    """What is known of the optimum, in a sentence."""
    lower = value_or_none(optimum.lower)
    if lower is None:
        return f"Optimum: {optimum.upper:.6f} s, {optimum.evidence}; true gaps may be larger."
    width = percent(1 - lower / optimum.upper)
    far = width.replace("<", "less than") if width.startswith("<") else f"up to {width}"
    return (
        f"Optimum: {shown_bound(lower, 'lower', places=7)} to "
        f"{shown_bound(optimum.upper, 'upper', places=7)} s, {optimum.evidence}; it may lie {far} "
        "below the value that gaps are set against."
    )
