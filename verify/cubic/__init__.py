"""Proofs of lower bounds for C2 cubic splines."""

from .box import Box as Box
from .kind import CubicSpline as CubicSpline
from .system import (
    FINE as FINE,
    Condition as Condition,
    Cubic as Cubic,
    kind_of_ends as kind_of_ends,
)
from .weights import Spot as Spot, least as least
