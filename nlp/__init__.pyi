from .clock import stopping_after as stopping_after
from .optimum import (
    KKT as KKT,
    Active as Active,
    Evidence as Evidence,
    Program as Program,
    Route as Route,
    Solution as Solution,
    Status as Status,
    build as build,
    kkt as kkt,
    random_starts as random_starts,
    weakest as weakest,
    with_other_route as with_other_route,
)
from .per_joint import (
    OPTIMUM_SLACK as OPTIMUM_SLACK,
    PerJointSolution as PerJointSolution,
    Range as Range,
    longest_status as longest_status,
    solve_per_joint as solve_per_joint,
)
from .proofs import (
    Certified as Certified,
    ExactProblem as ExactProblem,
    Outcome as Outcome,
    Progress as Progress,
    ProvedInterval as ProvedInterval,
    certificate as certificate,
    certify as certify,
    exact_problem as exact_problem,
    printed_problem as printed_problem,
    printed_problem_or_none as printed_problem_or_none,
    problem_seal as problem_seal,
    proved as proved,
    shipped as shipped,
    shipped_file as shipped_file,
    solve as solve,
    with_interval as with_interval,
    write_certificate as write_certificate,
)
from .proofs.any_curve import (
    AnyCurveEstimate as AnyCurveEstimate,
    estimate_any_curve as estimate_any_curve,
)
from .retiming import (
    Retiming as Retiming,
    retime as retime,
    retimed_motion as retimed_motion,
)
