from .balls import EPS, Ball, raised
from .box_bound import Place, bound_by_bisection, bound_ratio
from .places import linear_program, rows_at

__all__ = [
    "EPS",
    "Ball",
    "Place",
    "bound_by_bisection",
    "bound_ratio",
    "linear_program",
    "raised",
    "rows_at",
]
