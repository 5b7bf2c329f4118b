from .extension import setup
from .leaderboard import board_of, boards_drawn
from .papers import COLUMNS, distance_of, paper_row, paper_rows, papers_drawn
from .results import Results

__all__ = [
    "COLUMNS",
    "Results",
    "board_of",
    "boards_drawn",
    "distance_of",
    "paper_row",
    "paper_rows",
    "papers_drawn",
    "setup",
]
