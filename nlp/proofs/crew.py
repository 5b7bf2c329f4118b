"""Pieces of a proof worked on here and, once that pays, in other processes too."""

from __future__ import annotations

import pickle
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Any

from ...problem import ProcessError, Processes


@dataclass(eq=False)
class ProofPiece:
    """A piece of work: ``work(common, *arguments)``.

    Attributes
    ----------
    work : callable
        A function of a module, whose result depends on its arguments alone.
    common : Common
    arguments : tuple
    future : Future or None
        Of the answer, once somebody has the piece.
    here : bool
        Whether it was done in this process.
    """

    work: Callable[..., Any]
    common: Common
    arguments: tuple[Any, ...]
    future: Future[Any] | None = None
    here: bool = False

    def run(self) -> Future[Any]:
        """Do it here."""
        self.future, self.here = Future(), True
        try:
            self.future.set_result(self.work(self.common.value, *self.arguments))
        except Exception as error:
            self.future.set_exception(error)
        return self.future

    def taken_back(self) -> bool:
        """Whether nobody has begun it, and nobody else will."""
        return self.future is None or self.future.cancel()


@dataclass(eq=False)
class Common:
    """What many pieces have in common: packed once, and unpacked once by each process."""

    value: Any

    @cached_property
    def packed(self) -> bytes:
        """As a message."""
        return pickle.dumps(self.value)


def worked(work: bytes, common: bytes) -> Any:
    """Do a piece of work elsewhere: ``function(common, *arguments)``, both packed."""
    function, arguments = pickle.loads(work)
    return function(_unpacked(common), *arguments)


@lru_cache(maxsize=4)  # those of search and judging, and some to spare
def _unpacked(common: bytes) -> Any:
    """What pieces have in common is unpacked once: tables that are kept for it are found again."""
    return pickle.loads(common)


class ProofCrew:
    """Who works on the pieces of one run; what comes out does not depend on it.

    Pieces are handed out in the order in which they are begun. Whoever waits for one works on it,
    or on the next that nobody has begun.

    Parameters
    ----------
    workers : int
        This process is one of them; the others are started after `worth` seconds, if there are
        pieces for them.
    executor : concurrent.futures.Executor, optional
        Works on all pieces instead, from the beginning.

    Attributes
    ----------
    worth : float
        Seconds of a run before processes are started: starting one takes about as long, and most
        proofs are over by then.
    look : float
        Seconds between two looks at the clock while pieces are worked on elsewhere.
    ahead : int
        Pieces of `spread` handed out for each worker: the next one is there when it ends one.
    """

    worth, look, ahead = 1.0, 0.1, 3

    def __init__(self, workers: int = 1, executor: Executor | None = None) -> None:
        self.workers, self._executor = workers, executor
        self._processes: Processes | None = None
        self._threads: Executor | None = None
        self._answered = False
        self._waiting: deque[ProofPiece] = deque()
        self._began = time.perf_counter()

    def __enter__(self) -> ProofCrew:
        return self

    def __exit__(self, *error: object) -> None:
        if self._processes is not None:
            self._processes.end()
        if self._threads is not None:
            self._threads.shutdown()

    @property
    def processes(self) -> int:
        """How many were started."""
        return 0 if self._processes is None else self.workers

    def begin(self, work: Callable[..., Any], common: Common, *arguments: Any) -> ProofPiece:
        """A piece that somebody may begin from now on."""
        piece = ProofPiece(work, common, arguments)
        self._waiting.append(piece)
        self._hand_out()
        return piece

    def value(self, piece: ProofPiece, watch: Callable[[], None] = lambda: None) -> Any:
        """The result of a piece.

        Parameters
        ----------
        piece : ProofPiece
        watch : callable
            Called now and then while it is worked on elsewhere; may raise.

        Raises
        ------
        Exception
            Whatever its work raises.
        """
        self._hand_out()
        while piece.future is None or not piece.future.done():
            mine = self._mine(piece)
            if mine is not None:
                mine.run()
            elif piece.future is not None and not wait([piece.future], self.look).done:
                watch()
            self._hand_out()
        self._forget(piece)
        self._answered |= not piece.here
        try:
            return piece.future.result()
        except (ProcessError, CancelledError):  # no process has finished it
            return piece.run().result()

    def drop(self, pieces: Iterable[ProofPiece]) -> None:
        """Give up what nobody has begun."""
        for piece in pieces:
            piece.taken_back()
            self._forget(piece)

    def spread(
        self, work: Callable[..., Any], common: Any, items: Iterable[tuple[Any, ...]]
    ) -> Iterator[Any]:
        """Results of ``work(common, *item)`` in the order of the items, some of them ahead."""
        shared, begun = Common(common), deque[ProofPiece]()
        try:
            for item in items:
                begun.append(self.begin(work, shared, *item))
                if len(begun) > self.ahead * self.workers:
                    yield self.value(begun.popleft())
            while begun:
                yield self.value(begun.popleft())
        finally:
            self.drop(begun)

    def _hand_out(self) -> None:
        """Give pieces to others, if there are others."""
        late = time.perf_counter() - self._began >= self.worth
        if self.workers > 1 and self._executor is None and late and len(self._waiting) > 1:
            self._processes = self._processes or Processes()
            self._threads = self._threads or ThreadPoolExecutor(self.workers)
        others = self._executor or self._threads
        if others is None:
            return
        run = worked if self._processes is None else partial(self._processes.run, worked)
        for piece in self._waiting:
            if piece.future is None:
                work = pickle.dumps((piece.work, piece.arguments))
                piece.future = others.submit(run, work, piece.common.packed)

    def _mine(self, piece: ProofPiece) -> ProofPiece | None:
        """What to do here while waiting for a piece: that one, or the first that is not begun."""
        if piece.future is not None and (self._executor is not None or self._answered):
            return None
        ahead = (other for other in self._waiting if other is not piece)
        return next((one for one in (piece, *ahead) if one.taken_back()), None)

    def _forget(self, piece: ProofPiece) -> None:
        if piece in self._waiting:
            self._waiting.remove(piece)
