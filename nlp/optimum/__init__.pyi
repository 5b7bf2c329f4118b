from .formulation import Form, Formulation, Structure, build
from .judgement import KKT_TOLERANCE, SAME
from .optimality import KKT, Active, kkt
from .per_joint import OPTIMUM_SLACK, PerJointSolution, Range, solve_per_joint
from .solution import Evidence, Solution, Status, weakest
from .solver import STARTS, solve
from .starts import random_starts
from .tracking import free_values, structure_of

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
    "build",
    "free_values",
    "kkt",
    "random_starts",
    "solve",
    "solve_per_joint",
    "structure_of",
    "weakest",
]
