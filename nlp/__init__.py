"""The exact side: the NLP over durations and coefficients, its solutions, and TOPPRA."""

from .formulation import Form, Formulation, Structure, build
from .kkt import KKT, Active, kkt
from .per_joint import PerJointSolution, Range, solve_per_joint
from .solution import Evidence, Solution, Status
from .solve import solve
from .starts import random_starts
from .tracking import structure_of

__all__ = [
    "KKT",
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
    "kkt",
    "random_starts",
    "solve",
    "solve_per_joint",
    "structure_of",
]
