from .clues import held_otherwise, reading_clues
from .condition_count import count_conditions
from .following_numbers import in_digits, recomputed, repeated_total, summed
from .linear_blends import blended, judge_row
from .on_instances import HANDLED, attributed, placed
from .peaks import box_reach, largest
from .printed_vertices import Vertex, has_vertices, vertices
from .registry import EXPLAINED, GROUPS, NOT_COMPUTED, RULES
from .rule_group import Explained, RuleGroup

__all__ = [
    "EXPLAINED",
    "GROUPS",
    "HANDLED",
    "NOT_COMPUTED",
    "RULES",
    "Explained",
    "RuleGroup",
    "Vertex",
    "attributed",
    "blended",
    "box_reach",
    "count_conditions",
    "has_vertices",
    "held_otherwise",
    "in_digits",
    "judge_row",
    "largest",
    "placed",
    "reading_clues",
    "recomputed",
    "repeated_total",
    "summed",
    "vertices",
]
