"""The papers' side: metaheuristics as printed, one algorithm a file, and the loop they share."""

from .adapters import External, differential_evolution, dual_annealing, one_by_one, shgo
from .algorithm import Algorithm, Search, State
from .baseline import uniform_rescaling
from .constrained_pso import ConstrainedPSO
from .ga import GA
from .improved_ga import ImprovedGA
from .improved_woa import ImprovedWOA
from .mnam_pso import MNAMPSO
from .objective import Bounds, Counted, DeathPenalty, Objective
from .pso import PSO
from .registry import KINDS, from_settings, open_choices
from .repair import Handling, Stretch
from .result import JointRuns, Run
from .run import run, run_many, run_many_per_joint, run_per_joint, states
from .woa import WOA

__all__ = [
    "GA",
    "KINDS",
    "MNAMPSO",
    "PSO",
    "WOA",
    "Algorithm",
    "Bounds",
    "ConstrainedPSO",
    "Counted",
    "DeathPenalty",
    "External",
    "Handling",
    "ImprovedGA",
    "ImprovedWOA",
    "JointRuns",
    "Objective",
    "Run",
    "Search",
    "State",
    "Stretch",
    "differential_evolution",
    "dual_annealing",
    "from_settings",
    "one_by_one",
    "open_choices",
    "run",
    "run_many",
    "run_many_per_joint",
    "run_per_joint",
    "shgo",
    "states",
    "uniform_rescaling",
]
