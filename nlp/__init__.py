"""The exact side: the NLP over durations and coefficients, its solutions, and TOPPRA."""

from .formulation import Form, Formulation, Structure, build
from .kkt import KKT, Active, kkt
from .solution import Evidence, Solution, Status
from .solve import solve, structure_of
from .starts import random_starts

__all__ = [
    "KKT",
    "Active",
    "Evidence",
    "Form",
    "Formulation",
    "Solution",
    "Status",
    "Structure",
    "build",
    "kkt",
    "random_starts",
    "solve",
    "structure_of",
]
