"""The exact side: the NLP over durations and coefficients, its solutions, and TOPPRA."""

from .family_free import FamilyFree, family_free
from .formulation import Form, Formulation, Structure, build
from .kkt import KKT, Active, kkt
from .per_joint import PerJointSolution, Range, solve_per_joint
from .retime import Retiming, retime, retime_joints
from .solution import Evidence, Solution, Status
from .solve import solve
from .starts import random_starts
from .tracking import structure_of

__all__ = [
    "KKT",
    "Active",
    "Evidence",
    "FamilyFree",
    "Form",
    "Formulation",
    "PerJointSolution",
    "Range",
    "Retiming",
    "Solution",
    "Status",
    "Structure",
    "build",
    "family_free",
    "kkt",
    "random_starts",
    "retime",
    "retime_joints",
    "solve",
    "solve_per_joint",
    "structure_of",
]
