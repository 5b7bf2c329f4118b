from .continuous_time import said_to_keep
from .on_instances import HANDLED, attributed, placed
from .printed_vertices import Vertex, vertices
from .registry import GROUPS, NOT_COMPUTED, RULES

__all__ = [
    "GROUPS",
    "HANDLED",
    "NOT_COMPUTED",
    "RULES",
    "Vertex",
    "attributed",
    "placed",
    "said_to_keep",
    "vertices",
]
