"""Processes that do one piece of work at a time; the death of one loses no other piece."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import partial
from importlib import import_module
from queue import SimpleQueue
from typing import IO, Any, TypeVar

from .descendants import KEEPS, SIGNALLED, keep
from .errors import ProcessError

T = TypeVar("T")
R = TypeVar("R")

_TRIES = 2
"""How often one piece of work is given to a process: a second death is no accident."""
_END = 5.0
"""Seconds that a process has to end by itself before it is killed."""
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
"""Each process computes on one core: there are as many processes as cores, and sums of several
threads may round otherwise."""
_PROGRAM = "import sys; sys.path[:] = {path!a}; from {module} import serve; serve({main!a})"
"""What a process runs: nothing of the program that asks, which needs no guard around its entry."""


class LostWork(ProcessError):
    """A piece of work that no process finished.

    Parameters
    ----------
    ended : str
        How the last process ended, such as "SIGKILL"; empty if the work took too long.
    """

    def __init__(self, ended: str) -> None:
        super().__init__(ended)
        self.ended = ended

    def __str__(self) -> str:
        if not self.ended:
            return "workers: a piece of work took too long; raise the time limit"
        return (
            f"workers: {_TRIES} processes ended at the same piece of work ({self.ended}); "
            "use fewer workers or more memory"
        )


class Processes:
    """Processes that work for threads: each has pipes of its own, and one piece of work at a time.

    One is started if a thread asks and none is idle. All of them end with this object, with all
    their descendants, but idle ones of a `kept_processes` serve the next object in it.
    """

    def __init__(self) -> None:
        kept = _KEPT.get()
        self._idle, self._kept = kept or _Idle(), kept is not None
        self._busy: set[_Process] = set()
        self._over, self._changing = False, threading.Lock()

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, *error: object) -> None:
        self.end()

    def run(self, function: Callable[..., R], *arguments: Any, seconds: float = float("inf")) -> R:
        """``function(*arguments)``, computed in another process while this thread waits.

        Parameters
        ----------
        function : callable
            Picklable, as are the arguments and the result.
        seconds : float
            Limit of one attempt. A process that takes longer is killed with its descendants.

        Raises
        ------
        LostWork
            If a process ends at it and a second one too, or if it takes too long.
        ProcessError
            If no process can be started, or `end` was called.
        Exception
            Whatever the function raises.
        """
        work = pickle.dumps((function, arguments))
        module = getattr(function, "__module__", __name__)
        for _ in range(_TRIES):
            with self._taken() as process:
                # What takes long to import takes no time of the work.
                if not process.ready(module):
                    self._check()
                    raise ProcessError(
                        f"workers: a process ends at once ({process.ended}); see why: "
                        f'{sys.executable} -c "import {module}"'
                    )
                begun = time.monotonic()
                answer = process.answer(work, seconds)
            if answer is not None:
                finished, value = pickle.loads(answer)
                if not finished:
                    raise value
                found: R = value
                return found
            self._check()
            if time.monotonic() - begun >= seconds:
                raise LostWork("")
        raise LostWork(process.ended)

    def end(self) -> None:
        """End the processes, whatever they do; none is started after that."""
        with self._changing:
            self._over = True
            for process in self._busy:
                process.kill()
        if not self._kept:
            self._idle.end()

    @contextmanager
    def _taken(self) -> Iterator[_Process]:
        with self._changing:  # none begins while `end` goes through those that have begun
            self._check()
            process = self._idle.take() or _Process()
            self._busy.add(process)
        try:
            yield process
        finally:
            with self._changing:
                self._busy.discard(process)
            self._idle.put(process)

    def _check(self) -> None:
        if self._over:
            raise ProcessError("workers: stopped")


def in_processes(
    one: Callable[[T], R], items: Sequence[T], workers: int
) -> Generator[R, None, None]:
    """Apply a function to items in several processes; results in the order of the items.

    Parameters
    ----------
    one : callable
        Picklable, as are the items and results.
    workers : int
        Processes at a time; no more are started than there are items. With 1 this process works.

    Yields
    ------
    R
        ``one(item)`` of each item, in order.

    Raises
    ------
    ProcessError, Exception
        As `Processes.run`.
    """
    if min(workers, len(items)) < 2:
        yield from map(one, items)
        return
    # The processes end first: a thread that waits for an answer could not be joined.
    with ThreadPoolExecutor(min(workers, len(items))) as threads, Processes() as processes:
        yield from threads.map(partial(processes.run, one), items)


@contextmanager
def kept_processes() -> Iterator[None]:
    """Keep idle processes of every `Processes` inside for the next one, and end them at the end.

    A process spends two seconds on imports before its first work, which is often shorter than that.
    """
    idle = _Idle()
    before = _KEPT.set(idle)
    try:
        yield
    finally:
        _KEPT.reset(before)
        idle.end()


class _Process:
    """A process, and our ends of its pipes."""

    def __init__(self) -> None:
        if _LOADS.is_set():
            raise ProcessError(
                "workers: what they need is defined in a program that starts workers wherever it "
                'is loaded; guard its entry point with `if __name__ == "__main__":`'
            )
        path = [str(folder) for folder in sys.path]
        program = _PROGRAM.format(path=path, module=__name__, main=_main())
        try:
            self._process = subprocess.Popen(
                [sys.executable or "", "-c", program],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, **_ONE_THREAD},
                # A group of its own, which Ctrl-C at a terminal does not reach.
                start_new_session=True,
            )
        except OSError as error:
            raise ProcessError(
                f"workers: a process cannot be started ({error.strerror}); use fewer workers"
            ) from None
        self._fresh = True
        self._answered = False

    @property
    def waits(self) -> bool:
        """Whether it lives and has answered whatever it was asked."""
        return self._answered and self._process.poll() is None

    @property
    def ended(self) -> str:
        """How the process ended."""
        code = self._process.wait()
        with suppress(ValueError):
            return signal.Signals(-code if code < 0 else code - SIGNALLED).name
        return f"exit code {code}"

    def ready(self, module: str) -> bool:
        """Whether it works, which the first thing that it does shows: importing a module."""
        if self._fresh:
            self._fresh = False
            self.answer(pickle.dumps((import_module, (module,))))
        return self._answered

    def answer(self, work: bytes, seconds: float = float("inf")) -> bytes | None:
        """Whether the work finished, and its result or exception; None if the process is gone."""
        asked, said = self._process.stdin, self._process.stdout
        assert asked is not None
        assert said is not None
        self._answered = False
        alarm = threading.Timer(seconds, self.kill)
        if seconds < threading.TIMEOUT_MAX:
            alarm.start()
        try:
            _send(asked, work)
            found: bytes = pickle.load(said)
        except (OSError, EOFError, pickle.UnpicklingError):  # the last: cut off
            return None
        finally:
            alarm.cancel()
        self._answered = True
        return found

    def kill(self) -> None:
        """End the process and whatever it started."""
        if KEEPS:
            self._process.terminate()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_END)
        elif hasattr(os, "killpg"):
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.wait()

    def close(self) -> None:
        """End it and close its pipes; only where nobody waits for its answer."""
        self.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            with suppress(OSError):  # what was not yet sent
                assert pipe is not None
                pipe.close()


class _Idle:
    """Processes that wait for work, until they are let go."""

    def __init__(self) -> None:
        self._waiting: list[_Process] = []
        self._open, self._changing = True, threading.Lock()

    def take(self) -> _Process | None:
        """One that waits, but none that was killed meanwhile."""
        with self._changing:
            while self._waiting:
                process = self._waiting.pop()
                if process.waits:
                    return process
                process.close()
        return None

    def put(self, process: _Process) -> None:
        """Let one wait; one that still works or is gone is ended."""
        with self._changing:
            if self._open and process.waits:
                self._waiting.append(process)
                return
        process.close()

    def end(self) -> None:
        """End them all, and whatever comes later."""
        with self._changing:
            self._open = False
            waiting = self._waiting
        for process in waiting:
            process.close()


_KEPT: ContextVar[_Idle | None] = ContextVar("_KEPT", default=None)
"""Of the innermost `kept_processes` that is open; each thread has its own."""
_LOADS = threading.Event()
"""Set in a process while it loads the program that asks."""


def _main() -> dict[str, str]:
    """Where a process finds the program that runs here, as `multiprocessing.spawn` takes it."""
    main = sys.modules["__main__"]
    found = {
        "init_main_from_name": getattr(getattr(main, "__spec__", None), "name", None),
        "init_main_from_path": getattr(main, "__file__", None),
    }
    return {key: str(where) for key, where in found.items() if where}


def _send(pipe: IO[bytes], message: bytes) -> None:
    pickle.dump(message, pipe)
    pipe.flush()


# --- in the process -------------------------------------------------------------------------------


def serve(main: dict[str, str]) -> None:
    """Work until the input is closed.

    Parameters
    ----------
    main : dict
        Where the program that asks is found, if work needs something that it defines itself.
    """
    keep()
    # Both pipes are ours: what a piece of work prints is not an answer, and what it reads is empty.
    asked, said = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    if hasattr(os, "register_at_fork"):
        # A process that is forked and left behind must not hold our pipes open.
        os.register_at_fork(after_in_child=lambda: _forget(asked, said))
    # A terminal sends Ctrl-C to every process of the group; the parent alone answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    works: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_wait_for, args=(asked, works), daemon=True).start()
    with suppress(OSError):  # the parent is gone
        while True:
            _send(said, _worked(works.get(), main))


def _wait_for(asked: IO[bytes], works: SimpleQueue[bytes]) -> None:
    with suppress(OSError, EOFError, pickle.UnpicklingError):
        while True:
            works.put(pickle.load(asked))
    # The parent is gone or wants no more. Work may hang, or have started others, so that this
    # thread ends the process and its group.
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(0, signal.SIGKILL)
    os._exit(0)


def _worked(work: bytes, main: dict[str, str]) -> bytes:
    try:
        try:
            function, arguments = pickle.loads(work)
        except AttributeError:  # of something that the program itself defines
            _load(main)
            function, arguments = pickle.loads(work)
        answer = (True, function(*arguments))
    except Exception as error:
        answer = (False, error)
    try:
        return pickle.dumps(answer)
    except Exception as error:  # what cannot be pickled can be named
        named = RuntimeError(f"{type(answer[1]).__name__}: {answer[1]} ({error})")
        return pickle.dumps((False, named))


def _load(main: dict[str, str]) -> None:
    """Load the program that asks, under another name than ``__main__``."""
    from multiprocessing import spawn  # which few processes need

    _LOADS.set()
    try:
        spawn.prepare(main)
    finally:
        _LOADS.clear()


def _forget(*pipes: IO[bytes]) -> None:
    for pipe in pipes:
        with suppress(OSError):
            os.close(pipe.fileno())
