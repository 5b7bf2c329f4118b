"""Proofs of lower bounds for C4 quintic splines: the one kind that needs numpy."""

from .kind import QuinticSpline

__all__ = ["QuinticSpline"]
