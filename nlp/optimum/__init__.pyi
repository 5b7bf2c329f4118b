from .clock import call_cap, seconds_left, stopping_after, time_up
from .feasibility import apart
from .formulation import Form, Formulation, Structure, build
from .ipopt import structure_of
from .judgement import KKT_TOLERANCE, SAME
from .optimality import KKT, Active, kkt
from .per_joint import OPTIMUM_SLACK, PerJointSolution, Range, solve_per_joint
from .solution import Evidence, Solution, Status, close, weakest
from .solver import STARTS, solve
from .solver_calls import kept_calls, solved_before
from .starts import random_starts
from .symbolic import ca
from .tracking import free_values

__all__ = [
    "KKT",
    "KKT_TOLERANCE",
    "OPTIMUM_SLACK",
    "SAME",
    "STARTS",
    "Active",
    "Evidence",
    "Form",
    "Formulation",
    "PerJointSolution",
    "Range",
    "Solution",
    "Status",
    "Structure",
    "apart",
    "build",
    "ca",
    "call_cap",
    "close",
    "free_values",
    "kept_calls",
    "kkt",
    "random_starts",
    "seconds_left",
    "solve",
    "solve_per_joint",
    "solved_before",
    "stopping_after",
    "structure_of",
    "time_up",
    "weakest",
]
