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
from .loop import (
    AskedRun,
    joined_runs,
    run,
    run_as_left,
    run_asked,
    run_many,
    run_many_per_joint,
    run_per_joint,
    states,
)
from .objective import Bounds, Counted, DeathPenalty, Objective
from .optimizers import (
    BASELINES,
    BUDGET,
    Borrowed,
    BorrowedTask,
    evaluations_of,
    find_optimizer,
    optimizer_name,
)
from .repair import Handling, Stretch, judge_of
from .result import JointRuns, Run
from .search_boxes import search_box
from .within_budget import BudgetedRun, run_within

__all__ = [
    "BASELINES",
    "BUDGET",
    "GA",
    "KINDS",
    "MNAMPSO",
    "PSO",
    "WOA",
    "Algorithm",
    "AskedRun",
    "Borrowed",
    "BorrowedTask",
    "Bounds",
    "BudgetedRun",
    "ConstrainedPSO",
    "Counted",
    "DeathPenalty",
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
    "evaluations_of",
    "find_optimizer",
    "from_settings",
    "joined_runs",
    "judge_of",
    "open_choices",
    "optimizer_name",
    "run",
    "run_as_left",
    "run_asked",
    "run_many",
    "run_many_per_joint",
    "run_per_joint",
    "run_within",
    "search_box",
    "states",
    "tent_collapse",
    "uniform_rescaling",
]
