"""Proofs of lower bounds for C2 cubic splines."""

from .kind import CubicSpline
from .system import Cubic, kind_of_ends

__all__ = ["Cubic", "CubicSpline", "kind_of_ends"]
