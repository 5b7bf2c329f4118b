from .extension import setup as setup
from .leaderboard import board_of as board_of, boards_drawn as boards_drawn
from .papers import (
    COLUMNS as COLUMNS,
    distance_of as distance_of,
    paper_row as paper_row,
    paper_rows as paper_rows,
    papers_drawn as papers_drawn,
)
from .results import Results as Results
