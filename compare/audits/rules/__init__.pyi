from .on_instances import HANDLED, attributed, placed
from .printed_vertices import Vertex, vertices
from .registry import GROUPS, RULES

__all__ = [
    "GROUPS",
    "HANDLED",
    "RULES",
    "Vertex",
    "attributed",
    "placed",
    "vertices",
]
