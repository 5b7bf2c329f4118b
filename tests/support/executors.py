"""An executor that gives its results back out of order."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

import pytest
from trajgap.nlp.proofs import crew


class LastFirst(Executor):
    """Works on what was handed out last, one piece whenever a crew waits."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.held: list[tuple[Future[Any], Callable[[], Any]]] = []
        self.handed: list[Future[Any]] = []
        waited = crew.wait

        def finishing(futures: Any, timeout: float) -> Any:
            self.finish(1)
            return waited(futures, 0.0)

        monkeypatch.setattr(crew, "wait", finishing)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.handed.append(future)
        self.held.append((future, lambda: fn(*args, **kwargs)))
        return future

    def finish(self, most: int) -> None:
        """Do as many pieces as there are, or fewer."""
        for _ in range(min(most, len(self.held))):
            future, work = self.held.pop()
            if future.set_running_or_notify_cancel():
                future.set_result(work())
