from .adapters import External, differential_evolution, dual_annealing, one_by_one, shgo
from .algorithm import Algorithm, Search, State
from .algorithms import (
    GA,
    KINDS,
    MNAMPSO,
    PSO,
    WOA,
    ConstrainedPSO,
    ImprovedGA,
    ImprovedWOA,
    from_settings,
    open_choices,
)
from .baseline import uniform_rescaling
from .hazards import TentCollapse, tent_collapse
from .loop import run, run_many, run_many_per_joint, run_per_joint, states
from .objective import Bounds, Counted, DeathPenalty, Objective
from .repair import Handling, Stretch
from .result import JointRuns, Run
from .workers import in_processes

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
    "TentCollapse",
    "differential_evolution",
    "dual_annealing",
    "from_settings",
    "in_processes",
    "one_by_one",
    "open_choices",
    "run",
    "run_many",
    "run_many_per_joint",
    "run_per_joint",
    "shgo",
    "states",
    "tent_collapse",
    "uniform_rescaling",
]
