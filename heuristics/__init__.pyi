from .algorithm import Algorithm as Algorithm, Search as Search, State as State
from .algorithms import (
    GA as GA,
    KINDS as KINDS,
    MNAMPSO as MNAMPSO,
    PSO as PSO,
    WOA as WOA,
    ConstrainedPSO as ConstrainedPSO,
    ImprovedGA as ImprovedGA,
    ImprovedWOA as ImprovedWOA,
    TentCollapse as TentCollapse,
    from_settings as from_settings,
    open_choices as open_choices,
    tent_collapse as tent_collapse,
)
from .baseline import search_box as search_box, uniform_rescaling as uniform_rescaling
from .loop import (
    AskedRun as AskedRun,
    joined_runs as joined_runs,
    run as run,
    run_as_left as run_as_left,
    run_asked as run_asked,
    run_many as run_many,
    run_many_per_joint as run_many_per_joint,
    run_per_joint as run_per_joint,
    states as states,
)
from .objective import (
    Bounds as Bounds,
    Counted as Counted,
    DeathPenalty as DeathPenalty,
    Objective as Objective,
)
from .optimizers import (
    BASELINES as BASELINES,
    BUDGET as BUDGET,
    Borrowed as Borrowed,
    BorrowedTask as BorrowedTask,
    evaluations_of as evaluations_of,
    find_optimizer as find_optimizer,
    optimizer_name as optimizer_name,
)
from .repair import Handling as Handling, Stretch as Stretch, judge_of as judge_of
from .result import JointRuns as JointRuns, Run as Run
from .within_budget import BudgetedRun as BudgetedRun, run_within as run_within
