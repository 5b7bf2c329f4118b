"""Sessions and their engines: killed, lost, two at once, with more runs than they could hold."""

import os
import random
import signal
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from support.small_studies import HEAD, optimizers, small_trial, texts, written
from trajgap.compare import gaps
from trajgap.compare.gaps.trials import TrialOutcome
from trajgap.problem import ProcessError


def test_trials_are_read_as_they_are_needed() -> None:
    read = 0

    def trials() -> Iterator[gaps.Trial]:
        nonlocal read
        for seed in range(100):
            read += 1
            yield small_trial(seed=seed)

    with gaps.on_this_machine(2) as engine:
        coming = gaps.outcomes(trials(), engine)
        next(coming)
        assert read <= 6
        coming.close()


def called_here(future: Future[Any], call: Callable[..., Any], *given: Any, **named: Any) -> None:
    future.set_result(call(*given, **named))


class AtOnce(Executor):
    """An executor whose futures end as told, before anybody asks."""

    def __init__(self, end: Callable[..., object] = called_here) -> None:
        self.end = end

    def submit(self, *given: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.end(future, *given, **named)
        return future


def failing(error: Exception) -> AtOnce:
    return AtOnce(lambda future, *_: future.set_exception(error))


def cancelled(future: Future[Any], *_: Any) -> None:
    future.cancel()
    future.set_running_or_notify_cancel()


class KilledWorker(Exception):
    """As Dask names it."""


def test_a_run_at_which_workers_of_dask_die_is_reported() -> None:
    engine = gaps.Engine(failing(KilledWorker()), lambda: 1, "far")
    (outcome,) = gaps.outcomes([small_trial()], engine)
    assert outcome.row.status is gaps.RowStatus.FAILED
    said = "support.optimizers:draws: workers died repeatedly while running it"
    assert outcome.row.message == said


CLOSED = ThreadPoolExecutor(1)
CLOSED.shutdown()


@pytest.mark.parametrize(
    ("executor", "said"),
    [
        (AtOnce(cancelled), r"\(.*cancelled.*\)"),
        (failing(OSError("gone")), r"\(OSError: gone\)"),
        (failing(KeyError("odd")), r"\(KeyError: 'odd'\)"),
        (CLOSED, r"\(RuntimeError: cannot schedule.*\)"),
        (failing(ProcessError("none")), "^none$"),  # cannot start one
    ],
)
def test_an_engine_that_is_lost_ends_the_session(executor: Executor, said: str) -> None:
    said = said if said == "^none$" else f"far: lost {said}; finished runs are stored"
    with pytest.raises(ProcessError, match=said):
        list(gaps.outcomes([small_trial()], gaps.Engine(executor, lambda: 1, "far")))


def test_dask_that_does_not_answer_is_reported() -> None:
    pytest.importorskip("distributed")
    with (
        pytest.raises(ProcessError, match=r"dask: no scheduler answers at tcp://127.0.0.1:9 \("),
        gaps.on_dask("tcp://127.0.0.1:9", patience=0.2),
    ):
        pass


def test_dask_that_is_not_installed_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with (
        pytest.raises(ProcessError, match=r'dask: is not installed; run `.*"trajgap\[dask\]"`'),
        gaps.on_dask("tcp://127.0.0.1:9", patience=0.2),
    ):
        pass


@pytest.mark.filterwarnings("ignore")  # Dask's own, of its ports and its closing connections
@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_rows_though_a_worker_is_killed(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    trials = [small_trial("support.optimizers:dawdles", seed=seed) for seed in range(24)]
    wanted = {trial.key: gaps.run_trial(trial) for trial in trials}
    found: dict[str, TrialOutcome] = {}
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,
            local_directory=str(tmp_path),
        ) as cluster,
        gaps.on_dask(cluster.scheduler_address) as engine,
    ):
        pids = [nanny.pid for nanny in cluster.workers.values()]
        assert engine.slots() == 2
        for outcome in gaps.outcomes(trials, engine):
            found[outcome.row.key] = outcome
            if len(found) == 5:
                os.kill(pids[0], signal.SIGKILL)
        assert [nanny.pid for nanny in cluster.workers.values()] != pids
    assert {key: outcome.row for key, outcome in found.items()} == wanted


PROGRAM = """
import sys
from pathlib import Path
from trajgap.compare.gaps import Store, load_study, on_this_machine, run_study
with Store(Path(sys.argv[2])) as store, on_this_machine(2) as engine:
    show = lambda session: print(session.run, flush=True)
    run_study(load_study(Path(sys.argv[1])), store, engine, progress=show)
"""
"""A session that says how many runs it has stored."""
NAMES = [f"support.optimizers:{name}" for name in ("draws", "dawdles", "raises")]
STUDY = HEAD + optimizers(*NAMES)


def session(study: Path, store: Path) -> subprocess.Popen[str]:
    """A session in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(study), str(store)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def killed_at(running: subprocess.Popen[str], rng: random.Random, most: int) -> bool:
    """Kill a session after a random number of rows and a moment; False if it was done before."""
    with running, running.stdout:
        # One in five is killed while it starts and reads what is there.
        wanted = rng.randint(0, most) if rng.random() > 0.2 else -1
        while wanted >= 0:
            line = running.stdout.readline()
            if not line:
                break
            if int(line) >= wanted:
                break
        time.sleep(rng.uniform(0, 0.05 if wanted >= 0 else 3.0))
        running.send_signal(signal.SIGKILL)
        return running.wait() == -signal.SIGKILL


@pytest.mark.slow
def test_a_study_survives_fifty_kills(tmp_path: Path) -> None:
    """Each killed study ends with the rows of one that was left alone; a done one begins afresh."""
    study = written(tmp_path, STUDY.replace("seeds = 4", "seeds = 20"))
    plan = gaps.load_study(study)
    whole = tmp_path / "whole.sqlite"
    with session(study, whole) as running:
        assert running.communicate()
        assert running.returncode == 0
    wanted = texts(plan, whole)
    assert len(wanted) == len(plan)
    rng, done, fresh = random.Random(7), 0, 0
    while done < 50:
        fresh += 1
        path, before = tmp_path / f"killed-{fresh}.sqlite", 0
        finished = False
        while not finished:
            if done < 50:
                hit = killed_at(session(study, path), rng, most=6)
                done, finished = done + hit, not hit
            else:
                with session(study, path) as running:
                    running.communicate()
                finished = True
                assert running.returncode == 0
            found = texts(plan, path) if path.exists() else []
            # Nothing that was stored is lost, and nothing half-done is there.
            assert len(found) >= before
            assert [text for text in wanted if text in set(found)] == found
            print(f"study {fresh}: {done} kills, {len(found)} of {len(wanted)} rows stored")
            before = len(found)
        assert found == wanted, "the resumed study differs from the uninterrupted one"


ROOM = 2_000_000
"""Bytes that a session may grow by: a tenth of 10,000 rows, each of some 2,000 bytes."""


def at_once(trial: gaps.Trial) -> TrialOutcome:
    """A row as long as those of runs, without a search."""
    trace = tuple((at, 9.0 / at) for at in range(1, 60))
    return TrialOutcome(gaps.Row.begun(trial, trace=trace, evaluations=60), 0.0)


@pytest.mark.slow  # a quick look at the same: test_engines, trials are read as they are needed
def test_memory_does_not_grow_over_ten_thousand_runs(tmp_path: Path) -> None:
    runs = 10_000
    text = f"{HEAD}{optimizers('random')}".replace("seeds = 4", f"seeds = {runs // 2}")
    plan = gaps.load_study(written(tmp_path, text))
    held = 0

    def forget_the_start(session: gaps.StudySession) -> None:
        nonlocal held
        if session.run == runs // 10:
            held = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()

    with gaps.Store(tmp_path / "runs.sqlite") as store:
        next(plan.trials(store))  # the optimum is solved before anything is counted
        tracemalloc.start()
        try:
            engine = gaps.Engine(AtOnce(), lambda: 2, "here", at_once)
            assert gaps.run_study(plan, store, engine, progress=forget_the_start).run == runs
            assert gaps.export_rows(gaps.study_rows(plan, store), tmp_path / "rows.csv") == runs
            assert sum(1 for _ in store.rows()) == runs
            assert tracemalloc.get_traced_memory()[1] - held < ROOM
        finally:
            tracemalloc.stop()
