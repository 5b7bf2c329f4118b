"""An executor that gives its results back out of order."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any


class LastFirst(Executor):
    """Works on what was handed out last."""

    def __init__(self) -> None:
        self.held: list[tuple[Future[Any], Callable[[], Any]]] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.held.append((future, lambda: fn(*args, **kwargs)))
        return future

    def finish(self, most: int = 10**9) -> None:
        """Do as many pieces as there are, or fewer."""
        for _ in range(min(most, len(self.held))):
            future, work = self.held.pop()
            if future.set_running_or_notify_cancel():
                future.set_result(work())
