from .optimality_gap import gap, reference_of
from .statistics import (
    SETTLED,
    Spread,
    settled_at,
    share_interval,
    share_of_luck,
    share_of_pairs,
    spread,
)

__all__ = [
    "SETTLED",
    "Spread",
    "gap",
    "reference_of",
    "settled_at",
    "share_interval",
    "share_of_luck",
    "share_of_pairs",
    "spread",
]
