"""Proofs of lower bounds for C2 cubic splines."""

from .box import Box
from .kind import CubicSpline
from .system import FINE, Condition, Cubic, kind_of_ends
from .weights import Spot, least

__all__ = [
    "FINE",
    "Box",
    "Condition",
    "Cubic",
    "CubicSpline",
    "Spot",
    "kind_of_ends",
    "least",
]
