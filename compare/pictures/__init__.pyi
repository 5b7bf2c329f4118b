from .arm import ArmMotion as ArmMotion, arm_picture as arm_picture
from .bars import (
    PaperBar as PaperBar,
    papers_picture as papers_picture,
    waterfall_picture as waterfall_picture,
)
from .drawing import (
    DARK as DARK,
    KINDS as KINDS,
    THEME as THEME,
    Picture as Picture,
    drawn as drawn,
    embedded as embedded,
    picture_bytes as picture_bytes,
    svg as svg,
    themed as themed,
)
from .gap_bands import (
    Anytime as Anytime,
    BoardPanel as BoardPanel,
    gap_picture as gap_picture,
    leaderboard_picture as leaderboard_picture,
    profile_picture as profile_picture,
)
from .instances import instances_picture as instances_picture
from .joint_panels import (
    jump_picture as jump_picture,
    polygon_picture as polygon_picture,
    velocity_jumps as velocity_jumps,
)
from .motion import checked_picture as checked_picture, motion_picture as motion_picture
from .searches import (
    Runs as Runs,
    convergence as convergence,
    endings as endings,
    reached_picture as reached_picture,
)
from .tent import tent_picture as tent_picture, tent_scatter as tent_scatter
from .totals_map import landscape as landscape
from .workspace import workspace_picture as workspace_picture
