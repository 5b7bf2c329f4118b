from .benching import (
    SECONDS as SECONDS,
    SEEDS as SEEDS,
    BenchPlan as BenchPlan,
    Runs as Runs,
    bench as bench,
    measure_gaps as measure_gaps,
    overall as overall,
    plan_bench as plan_bench,
    relative_rows as relative_rows,
    run_bench as run_bench,
)
from .engines import (
    Engine as Engine,
    on_dask as on_dask,
    on_this_machine as on_this_machine,
    outcomes as outcomes,
    run_apart as run_apart,
)
from .exports import (
    COLUMNS as COLUMNS,
    check_export as check_export,
    export_rows as export_rows,
    rows_text as rows_text,
)
from .leaderboard import (
    LADDER as LADDER,
    LEADERBOARD as LEADERBOARD,
    SIZES as SIZES,
    SOLVED as SOLVED,
    Board as Board,
    Ranked as Ranked,
    Summary as Summary,
    boards as boards,
    curve_of as curve_of,
    leaderboard_rows as leaderboard_rows,
    leaderboard_study as leaderboard_study,
    size_of as size_of,
    summaries_text as summaries_text,
    summed_up as summed_up,
)
from .optimality_gap import (
    gap as gap,
    known_optimum as known_optimum,
    reference_of as reference_of,
)
from .rows import (
    Bracket as Bracket,
    Row as Row,
    RowStatus as RowStatus,
    Trial as Trial,
    against as against,
    canonical as canonical,
    failed as failed,
)
from .sessions import (
    StudySession as StudySession,
    run_study as run_study,
    study_rows as study_rows,
    unfinished as unfinished,
)
from .standings import (
    target_reached as target_reached,
    totals_of as totals_of,
)
from .statistics import (
    SETTLED as SETTLED,
    Spread as Spread,
    quantiles as quantiles,
    settled_at as settled_at,
    share_interval as share_interval,
    share_of_luck as share_of_luck,
    share_of_pairs as share_of_pairs,
    spread as spread,
)
from .store import Store as Store
from .studies import (
    StudyPlan as StudyPlan,
    StudyProblem as StudyProblem,
    load_study as load_study,
    parse_study as parse_study,
    study_of as study_of,
)
from .targets import (
    CURVE_TARGETS as CURVE_TARGETS,
    band as band,
    hit as hit,
    share_of_targets as share_of_targets,
    share_within as share_within,
    success_interval as success_interval,
)
from .trials import (
    DESCENT as DESCENT,
    run_trial as run_trial,
)
