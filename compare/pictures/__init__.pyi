from .arm import (
    ArmMotion as ArmMotion,
    arm_picture as arm_picture,
)
from .checked import checked_picture as checked_picture
from .drawing import (
    DARK as DARK,
    KINDS as KINDS,
    THEME as THEME,
    Picture as Picture,
    embedded as embedded,
    picture_bytes as picture_bytes,
    svg as svg,
    themed as themed,
)
from .gap_bands import (
    Anytime as Anytime,
    gap_picture as gap_picture,
    profile_picture as profile_picture,
)
from .instances import instances_picture as instances_picture
from .jumps import (
    jump_picture as jump_picture,
    velocity_jumps as velocity_jumps,
)
from .leaderboard import (
    BoardPanel as BoardPanel,
    leaderboard_picture as leaderboard_picture,
)
from .motion import motion_picture as motion_picture
from .papers import (
    PaperBar as PaperBar,
    papers_picture as papers_picture,
)
from .polygon import polygon_picture as polygon_picture
from .searches import (
    Runs as Runs,
    convergence as convergence,
    endings as endings,
    reached_picture as reached_picture,
)
from .tent import (
    tent_picture as tent_picture,
    tent_scatter as tent_scatter,
)
from .totals_map import landscape as landscape
from .waterfall import (
    waterfall_picture as waterfall_picture,
)
from .workspace import workspace_picture as workspace_picture
