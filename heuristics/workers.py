"""Work spread over processes, of which one may be killed at any moment without loss."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar

from ..problem import ProcessError

T = TypeVar("T")
R = TypeVar("R")

_TRIES = 2
"""How often one piece of work is given to a process: a second death is no accident."""
_END = 5.0
"""Seconds that a process has to end by itself before it is killed."""


@contextmanager
def kept_processes() -> Iterator[None]:
    """Reuse the processes of `in_processes` within this context, and end them when it ends.

    A process spends two seconds on imports before its first work, which is often shorter than that.
    """
    reserve = _Reserve([])
    before = _RESERVE.set(reserve)
    try:
        yield
    finally:
        _RESERVE.reset(before)
        reserve.open = False
        for worker in reserve.idle:
            worker.end()


def in_processes(
    one: Callable[[T], R], items: Sequence[T], workers: int
) -> Generator[R, None, None]:
    """Apply a function to items in several processes; results in the order of the items.

    Every process has its own pipe and one piece of work at a time. If a process is killed, it
    neither blocks the others nor spoils their work (a pool of the standard library loses all work
    in progress, and possibly a lock): a new process repeats its piece of work.

    Parameters
    ----------
    one : callable
        Picklable, as are the items and results.
    items : sequence
    workers : int
        Processes at a time; no more are started than there are items.

    Yields
    ------
    R
        ``one(item)`` of each item, in order.

    Raises
    ------
    ProcessError
        If a process ends twice at the same piece of work, or none can be started.
    Exception
        Whatever ``one`` raises.
    """
    todo = deque(range(len(items)))
    tries = [0] * len(items)
    done: dict[int, R] = {}
    reserve = _RESERVE.get()
    crew = [] if reserve is None else reserve.taken(min(workers, len(items)))
    try:
        for due in range(len(items)):
            while due not in done:
                _assign(crew, one, items, todo, tries, min(workers, len(items)))
                for worker in _ready(crew):
                    at = worker.at
                    answer = worker.answer()
                    if answer is None:
                        crew.remove(worker)
                        if at is not None:
                            _again(at, tries[at], worker, todo)
                        continue
                    assert at is not None
                    finished, value = answer
                    if not finished:
                        raise value
                    done[at] = value
            yield done.pop(due)
    finally:
        for worker in crew:
            # One that still works is not kept: its answer would be taken for that of the next.
            if reserve is not None and reserve.open and worker.at is None:
                reserve.idle.append(worker)
            else:
                worker.end()


@dataclass(eq=False)
class _Worker:
    """A process, our end of its pipe, and the position of the item that it works at."""

    process: BaseProcess
    pipe: Connection[Any, Any]
    at: int | None = None

    @classmethod
    def started(cls) -> _Worker:
        # Spawned, because a fork copies the locks of the compiled libraries.
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        # A daemon, so it cannot outlive us.
        process = context.Process(target=_work, args=(theirs,), daemon=True)
        try:
            process.start()
        except OSError as error:
            ours.close()
            raise ProcessError(
                f"workers: a process cannot be started ({error.strerror}); use fewer workers"
            ) from None
        finally:
            # Theirs alone from now on: when they are gone, our end says so.
            theirs.close()
        return cls(process, ours)

    def give(self, at: int, one: Callable[[Any], object], item: object) -> None:
        """Hand out an item; if the process is gone, its pipe says so when it is read."""
        self.at = at
        with suppress(BrokenPipeError, ConnectionResetError):
            self.pipe.send((one, item))

    def answer(self) -> tuple[bool, Any] | None:
        """Whether the work finished, and its result or exception; None if the process is gone."""
        try:
            answer: tuple[bool, Any] = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            self.pipe.close()
            self.process.join(_END)
            return None
        self.at = None
        return answer

    @property
    def ended(self) -> str:
        """How the process ended."""
        code = self.process.exitcode
        if code is None or code >= 0:
            return f"exit code {code}"
        try:
            return signal.Signals(-code).name
        except ValueError:
            return f"signal {-code}"

    def end(self) -> None:
        """End the process, whatever it does."""
        self.pipe.close()
        self.process.terminate()
        self.process.join(_END)
        if self.process.exitcode is None:
            self.process.kill()
            self.process.join()


@dataclass(eq=False)
class _Reserve:
    """Processes that wait for work, until the `kept_processes` that keeps them is left."""

    idle: list[_Worker]
    open: bool = True

    def taken(self, most: int) -> list[_Worker]:
        """Take out processes for new work, but none that was killed while it waited."""
        taken: list[_Worker] = []
        while self.idle and len(taken) < most:
            worker = self.idle.pop()
            if worker.process.is_alive():
                taken.append(worker)
            else:
                worker.end()
        return taken


_RESERVE: ContextVar[_Reserve | None] = ContextVar("_RESERVE", default=None)
"""Of the innermost `kept_processes` that is open; each thread has its own."""


def _assign(
    crew: list[_Worker],
    one: Callable[[T], R],
    items: Sequence[T],
    todo: deque[int],
    tries: list[int],
    workers: int,
) -> None:
    """Give work to everyone who has none, and fill up the crew."""
    idle = [worker for worker in crew if worker.at is None]
    while todo and (idle or len(crew) < workers):
        if not idle:
            crew.append(_Worker.started())
            idle.append(crew[-1])
        at = todo.popleft()
        tries[at] += 1
        idle.pop().give(at, one, items[at])


def _ready(crew: list[_Worker]) -> list[_Worker]:
    """Wait until some of the crew have answered or are gone."""
    readable = wait([worker.pipe for worker in crew])
    return [worker for worker in crew if worker.pipe in readable]


def _again(at: int, tries: int, worker: _Worker, todo: deque[int]) -> None:
    """Put the work of a dead process back, unless it was not the first to die at it."""
    if tries >= _TRIES:
        raise ProcessError(
            f"workers: {_TRIES} processes ended at the same piece of work ({worker.ended}); "
            "use fewer workers or more memory"
        )
    todo.appendleft(at)


def _work(pipe: Connection[Any, Any]) -> None:
    """What a process does until its pipe is closed."""
    # A terminal sends Ctrl-C to every process of the group; the parent alone answers it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            one, item = pipe.recv()
        except (EOFError, ConnectionResetError):
            return
        try:
            answer: tuple[bool, object] = (True, one(item))
        except Exception as error:
            answer = (False, error)
        try:
            pipe.send(answer)
        except (BrokenPipeError, ConnectionResetError):
            return
        except Exception as error:
            # What cannot be pickled cannot be sent, but it can be named.
            pipe.send((False, RuntimeError(f"{type(answer[1]).__name__}: {answer[1]} ({error})")))
