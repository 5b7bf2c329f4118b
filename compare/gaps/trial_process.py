"""A process that runs one trial after another, so nothing an optimiser does can end a study.

The process itself is `main`: it reads trials from its standard input and writes rows to its
standard output, until its input is closed.
"""

from __future__ import annotations

import atexit
import os
import pickle
import queue
import signal
import struct
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import IO

from ...problem import Problem, ProcessError
from . import descendants
from .rows import Row, Trial, failed
from .trials import run_trial

_TRIES = 2
"""How often a trial is given to a process: a second death is no accident."""
_GRACE = 5.0
"""Seconds after its time limit in which a process may end a trial by itself."""
_LENGTH = struct.Struct("!Q")
"""What precedes each message: its number of bytes."""
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
"""Each process computes on one core: there are as many processes as cores, and sums of several
threads may round otherwise."""
_PROGRAM = f"from {descendants.__name__} import keep; keep(); from {__name__} import main; main()"
"""What a process runs; not as ``-m``, under which its rows would be of another class than ours.
It forks before it imports what takes memory."""
_PROBLEMS = 64
"""Problems that a process remembers: what is compiled for a curve belongs to its object."""


@dataclass(frozen=True)
class TrialOutcome:
    """A row, and the measured time, which differs from run to run.

    Attributes
    ----------
    row : Row
    seconds : float
        Duration of the run.
    """

    row: Row
    seconds: float


# --- this side ------------------------------------------------------------------------------------


class _Ended(Exception):
    """The process is gone."""


class _Late(Exception):
    """The process did not answer in time."""


class _Child:
    """A process of one thread, and the thread that reads what it says."""

    def __init__(self) -> None:
        paths = os.pathsep.join(path for path in sys.path if path)
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _PROGRAM],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, **_ONE_THREAD, "PYTHONPATH": paths},
                # A group of its own, which can be ended as a whole where there is no keeper.
                start_new_session=True,
            )
        except OSError as error:
            raise ProcessError(
                f"workers: a process cannot be started ({error.strerror}); use fewer workers"
            ) from None
        self._answers: queue.SimpleQueue[object] = queue.SimpleQueue()
        said = self._process.stdout
        assert said is not None
        self._listener = threading.Thread(target=_listen, args=(said, self._answers), daemon=True)
        self._listener.start()
        if self._answers.get() is None:
            self.end()
            raise ProcessError(
                f'workers: a process ends at once; to see why, run python -c "{_PROGRAM}"'
            )

    def ask(self, trial: Trial) -> TrialOutcome:
        """Have a trial run.

        Raises
        ------
        _Ended, _Late
        """
        asked = self._process.stdin
        assert asked is not None
        with suppress(OSError, ValueError):  # if it is gone, there will be no answer
            _send(asked, trial)
        limit = trial.seconds + _GRACE
        try:
            answer = self._answers.get(timeout=limit if limit < threading.TIMEOUT_MAX else None)
        except queue.Empty:
            raise _Late from None
        if not isinstance(answer, TrialOutcome):
            try:
                code = self._process.wait(_GRACE)
            except subprocess.TimeoutExpired:
                raise _Ended("it closed the pipe for its answers") from None
            raise _Ended(f"exit code {code}" if code >= 0 else _signal(-code))
        return answer

    def end(self) -> None:
        """End the process and whatever it started."""
        if descendants.KEEPS:
            self._process.terminate()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_GRACE)
        elif hasattr(os, "killpg"):
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.wait()
        # One that outlives it may still hold the other end: its pipe is then left open, since
        # closing it would wait for the thread that reads.
        self._listener.join(_GRACE)
        pipes = [self._process.stdin]
        if not self._listener.is_alive():
            pipes.append(self._process.stdout)
        for pipe in pipes:
            with suppress(OSError):
                assert pipe is not None
                pipe.close()


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _listen(said: IO[bytes], answers: queue.SimpleQueue[object]) -> None:
    """Pass on what a process says, and None at its end."""
    with suppress(OSError, ValueError):
        while (message := _receive(said)) is not None:
            answers.put(message)
    answers.put(None)


class Crew:
    """Processes that belong to the threads of one executor: each thread has its own."""

    def __init__(self) -> None:
        self._own = threading.local()
        self._children: set[_Child] = set()
        self._stopped, self._changing = False, threading.Lock()

    def run(self, trial: Trial) -> TrialOutcome:
        """Run a trial in the process of this thread, as `run_apart` says."""
        begun = time.monotonic()
        why, tries = "", 0
        while tries < _TRIES:
            tries += 1
            child = self._child()
            try:
                return child.ask(trial)
            except _Late:
                tries = _TRIES
                why = (
                    f"took longer than {trial.seconds:g} s; raise the time limit, or find where "
                    "it hangs"
                )
            except _Ended as end:
                why = f"its process ended {_TRIES} times ({end})"
            self._own.child = None
            with self._changing:
                self._children.discard(child)
            child.end()
        return TrialOutcome(failed(trial, f"{trial.optimizer}: {why}"), time.monotonic() - begun)

    def _child(self) -> _Child:
        if self._stopped:
            raise ProcessError("workers: stopped")
        child: _Child | None = getattr(self._own, "child", None)
        if child is None:
            child = _Child()
            with self._changing:  # `end` may have come while it began
                stopped = self._stopped
                if not stopped:
                    self._children.add(child)
            if stopped:
                child.end()
                raise ProcessError("workers: stopped")
            self._own.child = child
        return child

    def end(self) -> None:
        """End every process; none is started after that."""
        with self._changing:
            self._stopped = True
            children = list(self._children)
        for child in children:
            child.end()


_crew = Crew()
"""The processes of whoever calls `run_apart` itself, such as a worker of Dask."""
atexit.register(_crew.end)


def run_apart(trial: Trial) -> TrialOutcome:
    """Run a trial in the process of this thread, which is started at the first trial.

    Returns
    -------
    TrialOutcome
        A run whose process ends is repeated once in a new process. The run has failed if that
        process ends too, or if the run takes longer than the trial allows.

    Raises
    ------
    ProcessError
        If no process can be started.
    """
    return _crew.run(trial)


# --- messages -------------------------------------------------------------------------------------


def _send(pipe: IO[bytes], message: object) -> None:
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    pipe.write(_LENGTH.pack(len(data)) + data)
    pipe.flush()


def _receive(pipe: IO[bytes]) -> object | None:
    """The next message; None at the end, and if the last one is cut off."""
    head = pipe.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    data = pipe.read(length)
    found: object = pickle.loads(data) if len(data) == length else None
    return found


# --- the other side -------------------------------------------------------------------------------


def main() -> None:
    """Answer trials until the input is closed."""
    # What an optimiser prints goes nowhere, and what it reads is empty: both pipes are ours.
    asked, said = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):
        os.dup2(nothing, stream)
    if hasattr(os, "register_at_fork"):
        # A process that an optimiser forks and leaves behind must not hold our pipes open.
        os.register_at_fork(after_in_child=lambda: _forget(asked, said))
    # A terminal sends Ctrl-C to every process of the group; the parent alone answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    trials: queue.SimpleQueue[Trial] = queue.SimpleQueue()
    threading.Thread(target=_wait_for, args=(asked, trials), daemon=True).start()
    _send(said, "ready")
    problems: dict[str, Problem] = {}
    while True:
        trial = trials.get()
        begun = time.monotonic()
        row = run_trial(_known(trial, problems))
        _send(said, TrialOutcome(row, time.monotonic() - begun))


def _wait_for(asked: IO[bytes], trials: queue.SimpleQueue[Trial]) -> None:
    while isinstance(trial := _receive(asked), Trial):
        trials.put(trial)
    # The parent is gone or wants no more. A search may hang, or have started others, so this
    # thread ends the process and its group.
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(0, signal.SIGKILL)
    os._exit(0)


def _forget(*pipes: IO[bytes]) -> None:
    for pipe in pipes:
        with suppress(OSError):
            os.close(pipe.fileno())


def _known(trial: Trial, problems: dict[str, Problem]) -> Trial:
    """The trial with the problem object that was used before, for what is remembered of it."""
    if len(problems) > _PROBLEMS:
        problems.clear()
    return replace(trial, problem=problems.setdefault(trial.problem_sha256, trial.problem))
