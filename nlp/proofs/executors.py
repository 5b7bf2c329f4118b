"""Where the parts of a proof run: here, in threads of this process, or on a given executor."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any


class Here(Executor):
    """Runs everything at once, in the caller's own thread."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """A future that is finished; what ``fn`` raises comes out at once, Ctrl-C too."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


@contextmanager
def executor_for(given: Executor | None, workers: int) -> Iterator[Executor]:
    """An executor for parts of a proof.

    Parameters
    ----------
    given : concurrent.futures.Executor or None
        Taken as it is, and left open.
    workers : int
        Without one: threads, since compiled searches do not hold the interpreter's lock.

    Yields
    ------
    Executor
    """
    if given is not None:
        yield given
    elif workers == 1:
        yield Here()
    else:
        with ThreadPoolExecutor(workers, thread_name_prefix="proof") as pool:
            yield pool
