from .clues import held_otherwise, reading_clues
from .condition_count import count_conditions
from .kept_limits import said_to_keep
from .linear_blends import blended, judge_row
from .on_instances import HANDLED, attributed, placed
from .plain_words import EXPLAINED, Explained
from .printed_vertices import Vertex, has_vertices, vertices
from .registry import GROUPS, NOT_COMPUTED, RULES

__all__ = [
    "EXPLAINED",
    "GROUPS",
    "HANDLED",
    "NOT_COMPUTED",
    "RULES",
    "Explained",
    "Vertex",
    "attributed",
    "blended",
    "count_conditions",
    "has_vertices",
    "held_otherwise",
    "judge_row",
    "placed",
    "reading_clues",
    "said_to_keep",
    "vertices",
]
