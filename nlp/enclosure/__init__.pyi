from .balls import EPS as EPS, Ball as Ball, raised as raised
from .box_bound import (
    Place as Place,
    bound_by_bisection as bound_by_bisection,
    bound_ratio as bound_ratio,
)
from .places import linear_program as linear_program, rows_at as rows_at
