from .clock import seconds_left, stopping_after, time_up
from .descent import KEPT
from .feasibility import apart
from .judgement import SAME
from .limit_rows import exact_rows
from .optimality import KKT, KKT_TOLERANCE, Active, kkt
from .other_route import with_other_route
from .per_joint import (
    LEFT,
    OPTIMUM_SLACK,
    Near,
    PerJointSolution,
    Range,
    longest_status,
    nearby,
    solve_per_joint,
)
from .pieces import ca
from .program import Program, free_values
from .rounds import build
from .solution import Evidence, Route, Solution, Status, close, weakest
from .solver import STARTS, solve
from .starts import random_starts

__all__ = [
    "KEPT",
    "KKT",
    "KKT_TOLERANCE",
    "LEFT",
    "OPTIMUM_SLACK",
    "SAME",
    "STARTS",
    "Active",
    "Evidence",
    "Near",
    "PerJointSolution",
    "Program",
    "Range",
    "Route",
    "Solution",
    "Status",
    "apart",
    "build",
    "ca",
    "close",
    "exact_rows",
    "free_values",
    "kkt",
    "longest_status",
    "nearby",
    "random_starts",
    "seconds_left",
    "solve",
    "solve_per_joint",
    "stopping_after",
    "time_up",
    "weakest",
    "with_other_route",
]
