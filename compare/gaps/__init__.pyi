from .benching import BenchPlan, Entrant, Runs, bench, measure_gaps, plan_bench, run_bench
from .engines import Engine, on_dask, on_this_machine, outcomes
from .exports import COLUMNS, check_export, export_rows, rows_text
from .many_problems import overall, relative_rows
from .optimality_gap import gap, reference_of
from .pairs import compare_pairs, vargha_delaney
from .rows import Bracket, Row, RowStatus, Trial, against, canonical, checkpoints, failed, trace_of
from .sessions import StudySession, run_study, study_rows, unfinished
from .standings import bench_result, target_reached, totals_of
from .statistics import (
    SETTLED,
    Spread,
    quantiles,
    settled_at,
    share_interval,
    share_of_luck,
    share_of_pairs,
    spread,
)
from .store import Store
from .studies import StudyPlan, StudyProblem, load_study, parse_study
from .targets import (
    CURVE_TARGETS,
    TARGETS,
    band,
    expected_running_time,
    hit,
    share_of_targets,
    share_within,
)
from .trial_process import TrialOutcome, run_apart
from .trials import origin_of, run_trial

__all__ = [
    "COLUMNS",
    "CURVE_TARGETS",
    "SETTLED",
    "TARGETS",
    "BenchPlan",
    "Bracket",
    "Engine",
    "Entrant",
    "Row",
    "RowStatus",
    "Runs",
    "Spread",
    "Store",
    "StudyPlan",
    "StudyProblem",
    "StudySession",
    "Trial",
    "TrialOutcome",
    "against",
    "band",
    "bench",
    "bench_result",
    "canonical",
    "check_export",
    "checkpoints",
    "compare_pairs",
    "expected_running_time",
    "export_rows",
    "failed",
    "gap",
    "hit",
    "load_study",
    "measure_gaps",
    "on_dask",
    "on_this_machine",
    "origin_of",
    "outcomes",
    "overall",
    "parse_study",
    "plan_bench",
    "quantiles",
    "reference_of",
    "relative_rows",
    "rows_text",
    "run_apart",
    "run_bench",
    "run_study",
    "run_trial",
    "settled_at",
    "share_interval",
    "share_of_luck",
    "share_of_pairs",
    "share_of_targets",
    "share_within",
    "spread",
    "study_rows",
    "target_reached",
    "totals_of",
    "trace_of",
    "unfinished",
    "vargha_delaney",
]
