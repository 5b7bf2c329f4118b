"""What runs say of optimisers: on one problem, over all of a bench, and on the leaderboard."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

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
from ..gaps import Board, Ranked
from .tree import Block, Grid, Prose, table

ONE_BY_ONE = 6
"""Problems up to which each has its own tables; of more there is one table, and files have all."""


def overall_blocks(standings: Sequence[OverallStanding]) -> tuple[Block, ...]:
    """Which optimiser comes within 1 % most often, and a row for each."""
    rows = []
    for one in standings:
        shown = [t for t in one.targets if t.gap in SHOWN_GAPS]
        gaps = gap_cell(one.median), gap_cell(one.worst)
        shares = [f"{100 * target.rate:.0f} %" for target in shown]
        solved = [f"{target.solved} of {one.problems}" for target in shown]
        rows.append((one.optimizer, *gaps, one.first, *shares, *solved))
    columns = (
        "optimizer",
        ">median of median gaps",
        ">worst",
        ">first on",
        ">runs ≤ 1 %",
        ">runs ≤ 0.01 %",
        ">solved to 1 %",
        ">solved to 0.01 %",
    )
    return Prose(_most_solved(standings), "lead"), table(columns, rows)


def _most_solved(standings: Sequence[OverallStanding]) -> str:
    """Which optimiser comes within 1 % most often, in a sentence."""
    first = standings[0]
    share, *others = [
        f"{100 * target.rate:.0f} %"
        for one in standings
        for target in one.targets
        if target.gap == SHOWN_GAPS[0]
    ]
    said = (
        f"Within 1 % of the optimum most often: {first.optimizer}, in {share} of its runs over "
        f"{first.problems} problems"
    )
    return said + (f"; next {standings[1].optimizer} with {others[0]}." if others else ".")


def bench_blocks(result: BenchResult) -> tuple[Block, ...]:
    """Which optimiser is closest, what is known of the optimum, a row for each, and notes."""
    return (
        Prose(result.verdict, "lead"),
        Prose(_optimum_said(result.optimum)),
        table(BENCH_COLUMNS, map(bench_cells, result.standings)),
        *(Prose(message, "warning") for message in result.messages),
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
        "below the value from which gaps are measured."
    )


_BOARD = (">place", "optimiser", ">runs within 1 %", ">within 0.1 %", ">within 0.01 %",
            ">median gap", ">evaluations to 1 %", ">to 0.1 %", ">to 0.01 %", ">failed")  # fmt: skip
"""What a row of a board says."""


def board_table(board: Board) -> Grid:
    """A row for each optimiser, with the intervals of shares and evaluations."""
    return table(_BOARD, [_board_cells(board, one) for one in board.standings], "", "sortable")


def brief_board(board: Board, marked: Collection[str] = ()) -> Grid:
    """The same without intervals and without what does not fit a terminal; some have a star."""
    rows = [
        [
            f"* {said}" if said in marked else said.partition("\n")[0]
            for said in _board_cells(board, one)
        ]
        for one in board.standings
    ]
    return table(_BOARD, rows).without(6, 7, 8, 9)


def _board_cells(board: Board, one: Ranked) -> tuple[str, ...]:
    place = board.place(one)
    return (
        str(place or "–"),
        one.optimizer if place else f"{one.optimizer} (reference, no black box)",
        *(
            f"{100 * share:.0f} %\n({100 * low:.0f} to {100 * high:.0f})"
            for share, low, high in one.solved
        ),
        percent(one.median) if np.isfinite(one.median) else "no answer",
        *(_evaluations(ends) if place else "–" for ends in one.expected),
        str(one.failed),
    )


def _evaluations(ends: tuple[float, float, float]) -> str:
    """Expected evaluations with their interval; an end without bound is ∞."""
    value, low, high = ("∞" if np.isinf(end) else f"{end:.0f}" for end in ends)
    return "–" if value == "∞" else f"{value}\n({low} to {high})"
