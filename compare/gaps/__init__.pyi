from .optimality_gap import Gap, GapKind, Reference, gap
from .statistics import SETTLED, settled_at, share_of_pairs, spread

__all__ = [
    "SETTLED",
    "Gap",
    "GapKind",
    "Reference",
    "gap",
    "settled_at",
    "share_of_pairs",
    "spread",
]
