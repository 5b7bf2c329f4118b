from .optimality_gap import gap, reference_of
from .statistics import SETTLED, settled_at, share_of_luck, share_of_pairs, spread

__all__ = [
    "SETTLED",
    "gap",
    "reference_of",
    "settled_at",
    "share_of_luck",
    "share_of_pairs",
    "spread",
]
