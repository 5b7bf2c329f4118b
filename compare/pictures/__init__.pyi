from .arm import ArmMotion as ArmMotion, arm_picture as arm_picture
from .drawing import (
    KINDS as KINDS,
    THEME as THEME,
    Picture as Picture,
    embedded as embedded,
    picture_bytes as picture_bytes,
    pictured as pictured,
    svg as svg,
    themed as themed,
)
from .exhibits import (
    jump_picture as jump_picture,
    polygon_picture as polygon_picture,
    tent_picture as tent_picture,
    tent_scatter as tent_scatter,
    velocity_jumps as velocity_jumps,
)
from .gap_bands import (
    Anytime as Anytime,
    BoardPanel as BoardPanel,
    PaperBar as PaperBar,
    gap_picture as gap_picture,
    leaderboard_picture as leaderboard_picture,
    papers_picture as papers_picture,
    profile_picture as profile_picture,
    waterfall_picture as waterfall_picture,
)
from .motion import checked_picture as checked_picture, motion_picture as motion_picture
from .searches import (
    Runs as Runs,
    convergence as convergence,
    endings as endings,
    instances_picture as instances_picture,
    reached_picture as reached_picture,
)
from .totals_map import landscape as landscape
from .workspace import workspace_picture as workspace_picture
