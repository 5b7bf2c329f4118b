from .rows import PLACES
from .search import THREE_PIECE

__all__ = ["PLACES", "THREE_PIECE"]
