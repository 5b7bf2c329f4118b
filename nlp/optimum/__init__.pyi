from .descent import ROWS_KEPT
from .feasibility import apart
from .judgement import SAME_TOTAL
from .limit_rows import NEAR, exact_rows
from .optimality import KKT, KKT_TOLERANCE, Active, kkt
from .other_route import with_other_route
from .pieces import ca
from .program import Program, free_values
from .rounds import IPOPT_OPTIONS, build, constraints, near_rows
from .solution import Evidence, Route, SearchResult, Solution, Status, close, weakest
from .solver import STARTS, solve
from .starts import random_starts

__all__ = [
    "IPOPT_OPTIONS",
    "KKT",
    "KKT_TOLERANCE",
    "NEAR",
    "ROWS_KEPT",
    "SAME_TOTAL",
    "STARTS",
    "Active",
    "Evidence",
    "Program",
    "Route",
    "SearchResult",
    "Solution",
    "Status",
    "apart",
    "build",
    "ca",
    "close",
    "constraints",
    "exact_rows",
    "free_values",
    "kkt",
    "near_rows",
    "random_starts",
    "solve",
    "weakest",
    "with_other_route",
]
