from .extension import setup
from .results import Results, distance_of

__all__ = ["Results", "distance_of", "setup"]
