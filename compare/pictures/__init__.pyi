from .arm import ArmMotion, arm_picture
from .drawing import DARK, THEME, Picture, embedded, svg, themed
from .gap_bands import Anytime, gap_picture, profile_picture
from .instances import instances_picture
from .jumps import jump_picture, velocity_jumps
from .leaderboard import BoardPanel, leaderboard_picture
from .motion import motion_picture
from .papers import PaperBar, papers_picture
from .polygon import polygon_picture
from .searches import Runs, convergence, endings, reached_picture
from .tent import tent_picture, tent_scatter
from .totals_map import landscape
from .waterfall import seconds, waterfall_picture
from .workspace import workspace_picture

__all__ = [
    "DARK",
    "THEME",
    "Anytime",
    "ArmMotion",
    "BoardPanel",
    "PaperBar",
    "Picture",
    "Runs",
    "arm_picture",
    "convergence",
    "embedded",
    "endings",
    "gap_picture",
    "instances_picture",
    "jump_picture",
    "landscape",
    "leaderboard_picture",
    "motion_picture",
    "papers_picture",
    "polygon_picture",
    "profile_picture",
    "reached_picture",
    "seconds",
    "svg",
    "tent_picture",
    "tent_scatter",
    "themed",
    "velocity_jumps",
    "waterfall_picture",
    "workspace_picture",
]
