"""The papers' side: metaheuristics as printed, one algorithm a file, and the loop they share."""

from .algorithm import Algorithm, State
from .baseline import uniform_rescaling
from .constrained_pso import ConstrainedPSO
from .mnam_pso import MNAMPSO
from .objective import Bounds, Counted, DeathPenalty, Objective
from .pso import PSO
from .registry import KINDS, from_settings, open_choices
from .result import JointRuns, Run
from .run import run, run_many, run_many_per_joint, run_per_joint, states

__all__ = [
    "KINDS",
    "MNAMPSO",
    "PSO",
    "Algorithm",
    "Bounds",
    "ConstrainedPSO",
    "Counted",
    "DeathPenalty",
    "JointRuns",
    "Objective",
    "Run",
    "State",
    "from_settings",
    "open_choices",
    "run",
    "run_many",
    "run_many_per_joint",
    "run_per_joint",
    "states",
    "uniform_rescaling",
]
