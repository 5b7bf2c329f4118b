"""The exact side: the NLP over durations and coefficients, its solutions, and TOPPRA."""

from .certificate import certificate, shipped, write_certificate
from .certified import Certified, Outcome, Progress
from .certify import certify
from .evidence import Interval, proved, stated_exactly, with_certificate, with_certificates
from .exact import ExactProblem, exact_problem, printed_problem
from .family_free import FamilyFree, family_free
from .formulation import Form, Formulation, Structure, build
from .kkt import KKT, Active, kkt
from .per_joint import PerJointSolution, Range, solve_per_joint
from .retime import Retiming, retime, retime_joints
from .solution import Evidence, Solution, Status, weakest
from .solve import solve
from .starts import random_starts
from .tracking import structure_of
from .verify import Subject, verify

__all__ = [
    "KKT",
    "Active",
    "Certified",
    "Evidence",
    "ExactProblem",
    "FamilyFree",
    "Form",
    "Formulation",
    "Interval",
    "Outcome",
    "PerJointSolution",
    "Progress",
    "Range",
    "Retiming",
    "Solution",
    "Status",
    "Structure",
    "Subject",
    "build",
    "certificate",
    "certify",
    "exact_problem",
    "family_free",
    "kkt",
    "printed_problem",
    "proved",
    "random_starts",
    "retime",
    "retime_joints",
    "shipped",
    "solve",
    "solve_per_joint",
    "stated_exactly",
    "structure_of",
    "verify",
    "weakest",
    "with_certificate",
    "with_certificates",
    "write_certificate",
]
