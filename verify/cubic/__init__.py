"""Proofs of lower bounds for C2 cubic splines."""

from .box import Box as Box
from .kind import CubicSpline as CubicSpline
from .system import FINE as FINE
from .system import Condition as Condition
from .system import Cubic as Cubic
from .system import kind_of_ends as kind_of_ends
from .weights import Spot as Spot
from .weights import least as least
