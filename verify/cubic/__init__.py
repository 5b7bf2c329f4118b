"""Proofs of lower bounds for C2 cubic splines."""

from .kind import CubicSpline

__all__ = ["CubicSpline"]
