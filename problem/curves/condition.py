"""One linear condition on the coefficients of a piecewise polynomial."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class ConditionKind(IntEnum):
    """What one linear condition on the coefficients states."""

    LEFT_VALUE = 0
    """A derivative of the segment that ends at the break takes a given value."""
    RIGHT_VALUE = 1
    """A derivative of the segment that starts at the break takes a given value."""
    MATCH = 2
    """A derivative is the same on both sides of the break."""


@dataclass(frozen=True)
class Condition:
    """One condition: at break ``at``, derivative ``order``, of the kind ``kind``."""

    kind: ConditionKind
    at: int
    order: int
