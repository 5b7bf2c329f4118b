from .extension import setup
from .papers import COLUMNS, distance_of, paper_row, paper_rows, papers_drawn
from .results import Results

__all__ = [
    "COLUMNS",
    "Results",
    "distance_of",
    "paper_row",
    "paper_rows",
    "papers_drawn",
    "setup",
]
