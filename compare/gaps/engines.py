"""Where trials run: anything that is a ``concurrent.futures.Executor``, near or far."""

from __future__ import annotations

import atexit
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache, partial

from ...problem import LostWork, ProcessError, Processes, TrajgapError
from .rows import Trial, failed
from .store import Store
from .trials import TrialOutcome, measured_trial, run_trial


@lru_cache(maxsize=1)
def _processes() -> Processes:
    """For whoever calls `run_apart` itself, such as a worker of Dask."""
    found = Processes()
    atexit.register(found.end)
    return found


def run_apart(trial: Trial, processes: Processes | None = None, grace: float = 5.0) -> TrialOutcome:
    """Run a trial in another process, which is kept for the next one.

    A run whose process ends is repeated once in a new process. The run has failed if that process
    ends too, or if the run takes longer than the trial allows. A ProcessError says that no process
    can be started.
    """
    begun = time.monotonic()
    limit = trial.seconds + grace
    try:
        return (processes or _processes()).run(measured_trial, trial, seconds=limit)
    except LostWork as lost:
        why = f"took longer than {trial.seconds:g} s; raise the time limit, or look where it hangs"
        if lost.ended:
            why = f"its process ended 2 times ({lost.ended})"
    return TrialOutcome(failed(trial, f"{trial.optimizer}: {why}"), time.monotonic() - begun)


@dataclass(frozen=True)
class Engine:
    """An executor, and how many trials it runs at a time."""

    executor: Executor
    slots: Callable[[], int]
    """Number of workers at the moment."""
    name: str
    """Words for people."""
    run: Callable[[Trial], TrialOutcome] = run_apart
    """Function that the executor calls with each trial."""


@contextmanager
def on_this_machine(workers: int) -> Iterator[Engine]:
    """Run trials in processes of this machine; one worker runs one after another."""
    name = f"{workers} {'process' if workers == 1 else 'processes'}"
    # The processes end first: a thread that waits for an answer could not be joined.
    with ThreadPoolExecutor(workers, thread_name_prefix="trial") as threads, Processes() as own:
        yield Engine(threads, lambda: workers, name, partial(run_apart, processes=own))


@contextmanager
def on_dask(address: str, patience: float = 30.0) -> Iterator[Engine]:
    """Run trials on the Dask cluster whose scheduler has an address like "tcp://node1:8786".

    `patience`: s in which the scheduler must answer.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ProcessError(
            'dask: is not installed; run `python -m pip install "trajgap[dask]"`'
        ) from None
    try:
        client = Client(address, timeout=patience, set_as_default=False)
    except (OSError, ValueError) as error:
        said = " ".join(str(error).split())
        raise ProcessError(
            f"dask: no scheduler answers at {address} ({said}); check the address"
        ) from None
    with client:
        executor = client.get_executor()
        yield Engine(
            executor, lambda: max(1, sum(client.nthreads().values())), f"Dask at {address}"
        )


def outcomes(
    trials: Iterable[Trial], engine: Engine | None = None, store: Store | None = None
) -> Iterator[TrialOutcome]:
    """Run trials, in this process without an engine; outcomes come as they finish, in any order.

    Each row is stored before it is handed over. Trials are read one by one, as workers become free,
    so memory does not grow with their number. A ProcessError says that the engine itself failed;
    trials that have not returned are then not done.
    """
    alone = (TrialOutcome(run_trial(trial), 0.0) for trial in trials)
    for outcome in alone if engine is None else _run(trials, engine):
        if store is not None:
            store.put(outcome.row, outcome.seconds)
        yield outcome


def _run(trials: Iterable[Trial], engine: Engine) -> Iterator[TrialOutcome]:
    pending: dict[Future[TrialOutcome], Trial] = {}
    try:
        for trial in trials:
            # Two for each worker: the next one is there when it ends one.
            if len(pending) >= 2 * engine.slots():
                yield from _finished(pending, engine)
            pending[_submitted(engine, trial)] = trial
        while pending:
            yield from _finished(pending, engine)
    finally:
        for future in pending:
            future.cancel()


def _submitted(engine: Engine, trial: Trial) -> Future[TrialOutcome]:
    try:
        return engine.executor.submit(engine.run, trial)
    except RuntimeError as error:
        raise _lost(engine, error) from None


def _finished(pending: dict[Future[TrialOutcome], Trial], engine: Engine) -> Iterator[TrialOutcome]:
    """Wait until something is finished, and hand it over."""
    done, _ = wait(pending, return_when=FIRST_COMPLETED)
    for future in done:
        trial = pending.pop(future)
        error = None if future.cancelled() else future.exception()
        if error is None and not future.cancelled():
            yield future.result()
        elif type(error).__name__ == "KilledWorker":
            # Dask has tried on several workers, and each has died.
            why = f"{trial.optimizer}: workers died repeatedly while running it"
            yield TrialOutcome(failed(trial, why), 0)
        elif isinstance(error, TrajgapError):
            raise error
        else:
            raise _lost(engine, error)


def _lost(engine: Engine, error: BaseException | None) -> ProcessError:
    said = "cancelled" if error is None else f"{type(error).__name__}: {error}"
    return ProcessError(
        f"{engine.name}: lost ({' '.join(said.split())}); finished runs are stored, and the same "
        "command continues"
    )
