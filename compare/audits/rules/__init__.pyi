from .clues import held_otherwise as held_otherwise, reading_clues as reading_clues
from .following_numbers import (
    in_digits as in_digits,
    recomputed as recomputed,
    repeated_total as repeated_total,
    summed as summed,
)
from .linear_blends import blended as blended, judge_row as judge_row
from .on_instances import HANDLED as HANDLED, attributed as attributed, placed as placed
from .peaks import (
    box_reach as box_reach,
    largest as largest,
    peak_beside as peak_beside,
)
from .registry import (
    EXPLAINED as EXPLAINED,
    GROUPS as GROUPS,
    NOT_COMPUTED as NOT_COMPUTED,
    RULES as RULES,
)
from .rule_group import Explained as Explained, RuleGroup as RuleGroup
from .stated_curve import (
    Vertex as Vertex,
    count_conditions as count_conditions,
    has_vertices as has_vertices,
    vertices as vertices,
)
