"""The leaderboard on a page: its picture, its tables, and what they say in four sentences."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ...heuristics import KINDS
from .. import gaps
from ..blocks import Grid, share_cell, table
from ..pictures import BoardPanel, Picture, leaderboard_picture

HANDLINGS = {
    "death-penalty": "Death penalty: a motion beyond a limit is rejected",
    "stretch": "Stretch: a motion beyond a limit is slowed down until it keeps every limit",
}
"""What each handling does, as the title of its panel."""
_MIDDLE = gaps.SOLVED.index(1e-3)
"""Place of the target that sentences speak of: 0.1 %, which printed digits can tell apart."""


@lru_cache(maxsize=1)
def _boards() -> dict[tuple[str, int], gaps.Board]:
    """The committed standings: each part of the page asks for one of them."""
    return {(board.handling, board.budget): board for board in gaps.boards(gaps.leaderboard_rows())}


def board_of(handling: str, budget: int) -> gaps.Board:
    """Standings of one handling and budget."""
    return _boards()[handling, budget]


def papers_own(one: gaps.Ranked) -> bool:
    """Whether an optimiser is an algorithm of the papers, as printed."""
    return one.optimizer in KINDS


def said(penalty: gaps.Board, stretch: gaps.Board) -> tuple[str, ...]:
    """What both boards of one budget mean, in four sentences of numbers alone."""
    strict, loose = penalty.searches, stretch.searches
    best, random = strict[0], _named(penalty, "random")
    reference = _named(penalty, gaps.DESCENT)
    solved = round(reference.solved[2][0] * reference.problems)
    return (
        f"With {penalty.budget:,} evaluations and the papers' death penalty, {best.optimizer} is "
        f"first of {len(strict)} optimisers: {_share(best)} of its runs come within 0.1\N{NBSP}% "
        f"of the certified optimum, against {_share(random)} of random search; the median "
        f"of the optimisers is {_share(*strict)}.",
        "If a motion beyond a limit is slowed down instead of rejected, the median of the "
        f"optimisers is {_share(*loose)}, and the first, {loose[0].optimizer}, reaches "
        f"{_share(loose[0])}.",
        f"The best of the papers' algorithms are {_papers_best(strict)} under the death penalty, "
        f"and {_papers_best(loose)} under the stretch.",
        "A descent that uses the derivatives of the limits ends within 0.01\N{NBSP}% on "
        f"{solved} of {reference.problems} instances.",
    )


def _named(board: gaps.Board, label: str) -> gaps.Ranked:
    return next(one for one in board.standings if one.optimizer == label)


def _share(*standings: gaps.Ranked) -> str:
    """Median share of their runs that come within 0.1 %."""
    middle = float(np.median([one.solved[_MIDDLE][0] for one in standings]))
    return f"{100 * middle:.0f}\N{NBSP}%"


def _papers_best(standings: Sequence[gaps.Ranked]) -> str:
    first = next(one for one in standings if papers_own(one))
    return f"{first.optimizer} ({_share(first)})"


def boards_drawn(panels: Sequence[gaps.Board]) -> Picture:
    """The picture of boards with the same budget and problems, one panel each."""
    first = panels[0]
    runs = max(one.runs // one.problems for one in first.searches)
    title = (
        f"How near {len(first.searches)} optimisers come to the certified optimum in "
        f"{first.budget:,} evaluations ({len(first.problems)} instances, up to {runs} runs each)"
    )
    return leaderboard_picture([_panel(board) for board in panels], gaps.LADDER, title=title)


def _panel(board: gaps.Board) -> BoardPanel:
    standings = board.searches
    own = next(one for one in standings if papers_own(one))
    marked = {
        f"the first: {standings[0].optimizer}": standings[0],
        f"the first of the papers: {own.optimizer}": own,
        "random search": _named(board, "random"),
        "uniform rescaling": _named(board, "uniform rescaling"),
    }
    names = {one.optimizer for one in marked.values()}
    return BoardPanel(
        HANDLINGS[board.handling],
        {label: one.within for label, one in marked.items()},
        [one.within for one in standings if one.optimizer not in names],
    )


def board_parts(
    board: gaps.Board, part_of: Callable[[str], str], order: Callable[[str], Any]
) -> Grid:
    """Share of runs within 0.1 % in each class of instances."""
    classes = {problem: part_of(problem) for problem in board.problems}
    parts = sorted(set(classes.values()), key=order)
    found: dict[tuple[str, str], list[gaps.Summary]] = {}
    for row in gaps.leaderboard_rows():
        asked = (row.budget, row.handling) == (board.budget, board.handling)
        if asked and row.problem in classes:
            found.setdefault((row.optimizer, classes[row.problem]), []).append(row)
    rows = [
        [one.optimizer, *(_share_of(found[one.optimizer, part]) for part in parts)]
        for one in board.standings
    ]
    counts = Counter(classes.values())
    heads = [f"{part} ({counts[part]})" for part in parts]
    return table(("optimiser", *heads), rows, "", "sortable")


def _share_of(rows: Sequence[gaps.Summary]) -> str:
    """Share of the runs within 0.1 %, each problem counting alike, with Wilson's interval."""
    at, runs = gaps.LADDER.index(gaps.SOLVED[_MIDDLE]), sum(row.runs for row in rows)
    share = float(np.mean([row.within[at] / row.runs for row in rows]))
    low, high = gaps.success_interval(round(share * runs), runs)
    return share_cell(share, low, high)
