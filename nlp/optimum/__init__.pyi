from .descent import KEPT as KEPT
from .feasibility import apart as apart
from .judgement import SAME_TOTAL as SAME_TOTAL
from .limit_rows import NEAR as NEAR, exact_rows as exact_rows
from .optimality import KKT as KKT, KKT_TOLERANCE as KKT_TOLERANCE, Active as Active, kkt as kkt
from .other_route import with_other_route as with_other_route
from .pieces import ca as ca
from .program import Program as Program, free_values as free_values
from .rounds import (
    IPOPT_OPTIONS as IPOPT_OPTIONS,
    build as build,
    constraints as constraints,
    near_rows as near_rows,
)
from .solution import (
    Evidence as Evidence,
    Route as Route,
    SearchResult as SearchResult,
    Solution as Solution,
    Status as Status,
    close as close,
    weakest as weakest,
)
from .solver import STARTS as STARTS, solve as solve
from .starts import random_starts as random_starts
