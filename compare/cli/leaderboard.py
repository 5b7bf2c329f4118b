"""Lines of the leaderboard on the terminal."""

from __future__ import annotations

import math

from ..documents import percent
from ..gaps import SOLVED, Board

BOARD_COLUMNS = (
    ">place",
    "optimiser",
    *(f">runs within {100 * gap:g} %" for gap in SOLVED),
    ">median gap",
)
"""What a line says of an optimiser."""


def board_cells(board: Board) -> list[tuple[str, ...]]:
    """A line for each optimiser, as `BOARD_COLUMNS`."""
    return [
        (
            str(board.place(one) or "–"),
            one.optimizer,
            *(f"{100 * share:.0f} %" for share, _, _ in one.solved),
            percent(one.median) if math.isfinite(one.median) else "none",
        )
        for one in board.standings
    ]
