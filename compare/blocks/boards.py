"""The leaderboard as a table."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..documents import percent
from ..gaps import Board, Ranked
from .tree import Grid, table

_COLUMNS = (">place", "optimiser", ">runs within 1 %", ">within 0.1 %", ">within 0.01 %",
            ">median gap", ">evaluations to 1 %", ">to 0.1 %", ">to 0.01 %", ">failed")  # fmt: skip
"""What a row of a board says."""
_NO_ROOM = (6, 7, 8, 9)
"""Columns that do not fit a terminal."""


def board_table(board: Board) -> Grid:
    """A row for each optimiser, with the intervals of shares and evaluations."""
    return table(_COLUMNS, [_cells(board, one) for one in board.standings], "", "sortable")


def brief_board(board: Board, marked: Collection[str] = ()) -> Grid:
    """The same without intervals and without what does not fit a terminal; some have a star."""
    rows = [
        [f"* {said}" if said in marked else said.partition("\n")[0] for said in _cells(board, one)]
        for one in board.standings
    ]
    return table(_COLUMNS, rows).without(*_NO_ROOM)


def _cells(board: Board, one: Ranked) -> tuple[str, ...]:
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
