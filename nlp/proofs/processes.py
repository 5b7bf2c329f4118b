"""Processes that work on pieces of a proof: each has pipes of its own and one piece at a time."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import lru_cache
from queue import SimpleQueue
from typing import IO, Any

_BEGIN = (
    "import pickle, sys; sys.path[:], room = pickle.load(sys.stdin.buffer); "
    "import importlib; importlib.import_module(room).serve()"
)
"""What a process runs: the modules of its parent, and nothing of the program that asked for it, so
no program needs a guard around its beginning."""


class ProcessGone(Exception):
    """A process ended in the midst of its work, by the system or by hand."""


class Processes(ThreadPoolExecutor):
    """Runs pieces in other processes; each is started for its first piece.

    Parameters
    ----------
    count : int
    """

    def __init__(self, count: int) -> None:
        super().__init__(count, thread_name_prefix="proof")
        self._idle: SimpleQueue[subprocess.Popen[bytes] | None] = SimpleQueue()
        self._started: list[subprocess.Popen[bytes]] = []
        self._over, self._starting = False, threading.Lock()
        for _ in range(count):
            self._idle.put(None)

    def run(self, work: bytes, common: bytes) -> bytes:
        """The answer of a process; runs in one of our threads.

        Raises
        ------
        ProcessGone
            If the process ends without one, or none can be started.
        """
        process = self._idle.get()
        try:
            if process is None or process.poll() is not None:
                process = self._start()
            assert process.stdin is not None
            assert process.stdout is not None
            _send(process.stdin, (work, common))
            answer: bytes = pickle.load(process.stdout)
            return answer
        except (OSError, EOFError, pickle.UnpicklingError) as error:  # the last: cut off
            process = None
            raise ProcessGone(str(error)) from None
        finally:
            self._idle.put(process)

    def _start(self) -> subprocess.Popen[bytes]:
        with self._starting:  # none begins while `end` goes through those that have begun
            if self._over or not sys.executable:
                raise OSError("no process can be started")
            process = subprocess.Popen(
                [sys.executable, "-c", _BEGIN],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                # A terminal sends Ctrl-C to every process of the group; the parent alone answers.
                start_new_session=True,
            )
            self._started.append(process)
        assert process.stdin is not None
        pickle.dump((sys.path, __name__), process.stdin)
        return process

    def end(self) -> None:
        """End the processes, whatever they do."""
        with self._starting:
            self._over = True
            for process in self._started:
                process.kill()
        self.shutdown(wait=True, cancel_futures=True)
        for process in self._started:
            for pipe in (process.stdin, process.stdout):
                with suppress(OSError):  # what was not yet sent
                    if pipe is not None:
                        pipe.close()
            process.wait()


def packed(work: Callable[..., Any], arguments: tuple[Any, ...]) -> bytes:
    """A piece of work as one message."""
    return pickle.dumps((work, arguments))


def worked(work: bytes, common: bytes) -> bytes:
    """What ``work(common, *arguments)`` returns or raises, from and to messages."""
    try:
        function, arguments = pickle.loads(work)
        answer = (True, function(_unpacked(common), *arguments))
    except Exception as error:
        answer = (False, error)
    try:
        return pickle.dumps(answer)
    except Exception as error:  # what cannot be packed can be named
        return pickle.dumps((False, RuntimeError(f"{type(answer[1]).__name__}: {error}")))


@lru_cache(maxsize=4)  # those of search and judging, and some to spare
def _unpacked(common: bytes) -> Any:
    """What pieces have in common is unpacked once: tables that are kept for it are found again."""
    return pickle.loads(common)


def serve() -> None:
    """What a process does until its parent is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # What a library prints must not stand between two answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            _send(answers, worked(*pickle.load(sys.stdin.buffer)))
        except (EOFError, OSError, pickle.UnpicklingError):
            return


def _send(pipe: IO[bytes], message: Any) -> None:
    pickle.dump(message, pipe)
    pipe.flush()
