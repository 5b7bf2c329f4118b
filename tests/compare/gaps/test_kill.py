"""Sessions that are killed, two at once, and with more runs than they could hold."""

import tracemalloc
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest
from support.killed_study import STUDY, kill_and_resume, session, texts
from support.small_studies import HEAD, written
from trajgap.compare.gaps import (
    Engine,
    Row,
    Store,
    StudySession,
    Trial,
    TrialOutcome,
    export_rows,
    load_study,
    run_study,
    study_rows,
)


@pytest.mark.slow
def test_a_study_survives_fifty_kills(tmp_path: Path) -> None:
    lines: list[str] = []
    kill_and_resume(tmp_path, kills=50, seeds=20, most=6, report=lines.append)
    print("\n".join(lines))
    assert sum("kill" in line for line in lines) == 50
    assert "row for row" in lines[-1]


@pytest.mark.slow
def test_two_sessions_on_one_store_end_with_the_same_rows(tmp_path: Path) -> None:
    study = written(tmp_path, STUDY)
    with session(study, tmp_path / "one.sqlite") as alone:
        alone.communicate()
    both = [session(study, tmp_path / "two.sqlite") for _ in range(2)]
    for one in both:
        with one:
            one.communicate()
    assert [one.returncode for one in (alone, *both)] == [0, 0, 0]
    plan = load_study(study)
    wanted = texts(plan, tmp_path / "one.sqlite")
    assert len(wanted) == len(plan)
    assert texts(plan, tmp_path / "two.sqlite") == wanted


ROOM = 2_000_000
"""Bytes that a session may grow by: a tenth of 10,000 rows, each of some 2,000 bytes."""


class Here(Executor):
    """An executor that calls at once."""

    def submit(self, call: Callable[..., Any], *given: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(call(*given, **named))
        return future


def at_once(trial: Trial) -> TrialOutcome:
    """A row as long as those of runs, without a search."""
    trace = tuple((at, 9.0 / at) for at in range(1, 60))
    return TrialOutcome(Row.begun(trial, trace=trace, evaluations=60), 0.0)


@pytest.mark.slow  # a quick look at the same: test_engines, trials are read as they are needed
def test_memory_does_not_grow_over_ten_thousand_runs(tmp_path: Path) -> None:
    runs = 10_000
    text = f'{HEAD}[[optimizers]]\nname = "random"\n'.replace("seeds = 4", f"seeds = {runs // 2}")
    plan = load_study(written(tmp_path, text))
    held = 0

    def forget_the_start(session: StudySession) -> None:
        nonlocal held
        if session.run == runs // 10:
            held = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()

    with Store(tmp_path / "runs.sqlite") as store:
        next(plan.trials(store))  # the optimum is solved before anything is counted
        tracemalloc.start()
        try:
            engine = Engine(Here(), lambda: 2, "here", at_once)
            assert run_study(plan, store, engine, progress=forget_the_start).run == runs
            assert export_rows(study_rows(plan, store), tmp_path / "rows.csv") == runs
            assert sum(1 for _ in store.rows()) == runs
            assert tracemalloc.get_traced_memory()[1] - held < ROOM
        finally:
            tracemalloc.stop()
