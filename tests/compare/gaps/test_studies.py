from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from support.refusals import Refusal, each_refusal
from support.small_studies import HEAD, OPTIMIZERS, RUNS, STUDY, texts, written
from trajgap.compare.gaps import (
    Bracket,
    Engine,
    RowStatus,
    Store,
    StudyPlan,
    StudySession,
    load_study,
    on_this_machine,
    parse_study,
    run_study,
    study_rows,
)
from trajgap.nlp import solve
from trajgap.problem import CaseError, ProcessError, load_case
from trajgap.problem.suite import load_instance


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> StudyPlan:
    return load_study(written(tmp_path_factory.mktemp("study")))


@pytest.fixture(scope="module")
def engine() -> Iterator[Engine]:
    with on_this_machine(1) as one:
        yield one


@pytest.fixture(scope="module")
def whole(plan: StudyPlan, engine: Engine, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a study that ran through without interruption."""
    path = tmp_path_factory.mktemp("whole") / "few.sqlite"
    with Store(path) as store:
        run_study(plan, store, engine)
    return path


def test_every_combination_is_a_row_in_the_order_of_the_file(plan: StudyPlan, whole: Path) -> None:
    with Store(whole) as store:
        rows = list(study_rows(plan, store))
    assert Counter(row.status for row in rows) == {RowStatus.FINISHED: 24, RowStatus.FAILED: 8}
    assert b"numpy" in whole.read_bytes()
    assert len(rows) == len(plan) == RUNS
    assert [row.seed for row in rows[:4]] == [0, 1, 2, 3]
    assert [row.handling for row in rows[:8]] == ["death-penalty"] * 4 + ["stretch"] * 4
    assert [row.optimizer for row in rows[::8]] == [
        "pso", "pso", "support.optimizers:draws", "support.optimizers:raises",
    ]  # fmt: skip
    assert {row.budget for row in rows} == {120}
    assert len({row.key for row in rows}) == RUNS
    bad = [row for row in rows if row.status is RowStatus.FAILED]
    assert {row.optimizer for row in bad} == {"support.optimizers:raises"}


def test_without_a_budget_algorithms_make_their_own_iterations(plan: StudyPlan) -> None:
    """What MNAM-PSO, constrained PSO and the whales print: 200, 100 and 500 iterations."""
    named = 'format = 1\nseeds = 1\n[[problems]]\ncase = "mine.toml"\n'
    kinds = ("mnam-pso", "constrained-pso", "woa", "random")
    text = named + "".join(f'[[optimizers]]\nname = "{kind}"\n' for kind in kinds)
    whole = parse_study(text, "few.toml", Path(plan.file).parent)
    budgets = {trial.optimizer: trial.budget for trial in whole.trials()}
    assert budgets == dict(zip(kinds, (6231, 3030, 15030, 6000), strict=True))
    assert whole.notes[0] == "mnam-pso: 200 iterations, the algorithm's own, in 6,231 evaluations."
    assert plan.notes == ()


def test_runs_of_different_optimisers_draw_from_different_streams(plan: StudyPlan) -> None:
    trials = list(plan.trials())
    assert len({(trial.seed, trial.stream) for trial in trials}) == RUNS


def test_gaps_are_set_against_the_optimum_of_the_case(plan: StudyPlan, whole: Path) -> None:
    case = load_case(Path(plan.file).parent / "mine.toml")
    best = solve(case.problem("main", "plain", "shared")).best
    with Store(whole) as store:
        rows = [row for row in study_rows(plan, store) if row.feasible_time is not None]
    assert rows
    for row in rows:
        assert row.reference_upper == pytest.approx(best, rel=1e-9)
        assert row.feasible_gap[0] == pytest.approx(row.feasible_time / best - 1, rel=1e-6)
        assert row.feasible_gap[0] > 0


def test_a_study_that_is_done_runs_nothing(plan: StudyPlan, engine: Engine, whole: Path) -> None:
    before = texts(plan, whole)
    with Store(whole) as store:
        session = run_study(plan, store, engine)
        assert session == StudySession(total=RUNS, resumed=RUNS)
        again = run_study(plan, store, engine, retry=True)
        assert (again.resumed, again.run, again.failed) == (RUNS - 8, 8, 8)
    assert texts(plan, whole) == before


def test_a_session_that_ends_early_is_gone_on_with(
    plan: StudyPlan, engine: Engine, whole: Path, tmp_path: Path
) -> None:
    path = tmp_path / "few.sqlite"

    def stop(session: StudySession) -> None:
        assert session.left == RUNS - session.resumed - session.run
        if session.run == 5:
            raise KeyboardInterrupt

    with Store(path) as store, pytest.raises(KeyboardInterrupt):
        run_study(plan, store, engine, progress=stop)
    assert len(texts(plan, path)) == 5
    with Store(path) as store:
        session = run_study(plan, store, engine)
    assert (session.resumed, session.run, session.left) == (5, RUNS - 5, 0)
    assert texts(plan, path) == texts(plan, whole)


def test_a_longer_study_runs_only_what_is_new(
    plan: StudyPlan, engine: Engine, whole: Path, tmp_path: Path
) -> None:
    folder = Path(plan.file).parent
    longer = parse_study(STUDY.replace("seeds = 4", "seeds = 5"), "longer.toml", folder)
    path = tmp_path / "few.sqlite"
    path.write_bytes(whole.read_bytes())
    with Store(path) as store:
        session = run_study(longer, store, engine)
    assert (session.resumed, session.run) == (RUNS, len(longer) - RUNS)


def test_each_joint_is_a_problem_where_the_case_says_so(tmp_path: Path) -> None:
    text = STUDY.replace('coupling = "shared"\n', "")
    plan = load_study(written(tmp_path, text))
    assert [one.name for one in plan.problems] == ["mine/main, joint a", "mine/main, joint b"]
    first, *_, last = plan.trials()
    assert (len(first.problem.joints), first.stream[1:], last.stream[1:]) == (1, (0,), (1,))
    assert len(plan) == 2 * RUNS
    assert "Some durations have no upper bound" in plan.problems[0].notes[0]


def test_optimisers_without_draws_run_once(tmp_path: Path) -> None:
    text = HEAD + '[[optimizers]]\nname = "rescale"\n'
    plan = load_study(written(tmp_path, text))
    assert [trial.seed for trial in plan.trials()] == [0, 0]
    assert len(plan) == 2


def test_instances_of_the_suite_are_problems_with_their_own_bounds(tmp_path: Path) -> None:
    text = STUDY.replace("mine.toml", "suite:septic-puma*,353-puma560")
    found = parse_study(text, "study.toml", tmp_path)
    assert [one.name for one in found.problems] == ["353-puma560/main", "septic-puma560/main"]
    for one in found.problems:
        known = load_instance(one.name.partition("/")[0])
        assert one.solve() == Bracket(known.upper, known.lower)
    with pytest.raises(CaseError, match=r"problems\[0\]\.case: .*no instance 'x-353'"):
        parse_study(text.replace("353-puma560", "x-353"), "study.toml", tmp_path)


def test_published_cases_are_named_by_their_ids(tmp_path: Path) -> None:
    text = HEAD.replace("mine.toml", "puma560-mnam-pso-353") + OPTIMIZERS
    text = text.replace('coupling = "shared"', 'readings = "durations-positive"')
    plan = load_study(written(tmp_path, text))
    assert {one.reading for one in plan.problems} == {"durations-positive"}
    assert len(plan.problems) == 6


def test_a_fault_inside_a_list_is_named_alone(tmp_path: Path) -> None:
    """The list is not empty for it: pydantic says so of what is left after its faults."""
    path = written(tmp_path, STUDY.replace('coupling = "shared"', 'coupling = "share"'))
    with pytest.raises(CaseError, match=r"problems\[0\].coupling: 'share' is not") as caught:
        load_study(path)
    assert "is empty" not in str(caught.value)
    written(tmp_path, "format = 1\nproblems = []\noptimizers = []\n")
    with pytest.raises(CaseError, match=r"problems: is empty; .*optimizers: is empty"):
        load_study(path)


@each_refusal("studies")
def test_each_fault_is_one_line_with_file_and_field(one: Refusal, tmp_path: Path) -> None:
    path = written(tmp_path, one.text(STUDY))
    one.said_by(lambda: load_study(path), f"{path}: ")


def test_a_problem_that_the_objective_cannot_judge_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path)
    case = (tmp_path / "mine.toml").read_text()
    free = '{ family = "polynomials", degrees = [5, 5, 5], free = 4 }'
    (tmp_path / "mine.toml").write_text(
        case.replace('{ family = "3-5-3" }', free) + "durations = { upper = 9000 }\n"
    )
    words = r"problems\[0\]: main, plain: interpolant 5-5-5 .* leaves 4"
    with pytest.raises(CaseError, match=words):
        load_study(path)
    # A position limit is judged.
    held = case.replace("[limits]", "[limits]\nposition_upper = 3")
    (tmp_path / "mine.toml").write_text(held + "durations = { upper = 9000 }\n")
    assert load_study(path).problems[0].problem.limits.limits_position


def test_a_lost_engine_leaves_what_is_finished(plan: StudyPlan, tmp_path: Path) -> None:
    path = tmp_path / "few.sqlite"
    with on_this_machine(1) as engine, Store(path) as store:

        def lose(session: StudySession) -> None:
            if session.run == 3:
                engine.executor.shutdown(wait=False)

        with pytest.raises(ProcessError, match=r"1 process: lost \(.*the same command continues"):
            run_study(plan, store, engine, progress=lose)
    assert len(texts(plan, path)) >= 3


def test_rows_against_a_session_without_a_store_have_no_gaps(plan: StudyPlan) -> None:
    first = next(plan.trials())
    with Store(Path(plan.file).with_suffix(".other")) as store:
        known = next(plan.trials(store))
    assert first.reference is None
    assert known.reference is not None
    assert replace(known, reference=None).key == first.key
