from .extension import setup
from .results import Results, distance_of, reached_of

__all__ = ["Results", "distance_of", "reached_of", "setup"]
