"""A time limit that every step of a local search looks at, however deep it lies.

A search that is stopped returns the best that it has. Nothing is interrupted. Where no limit is
set, no search depends on the clock.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_END: ContextVar[float] = ContextVar("end", default=math.inf)
"""Reading of the clock at which the searches of this thread end: none without `stopping_after`."""


@contextmanager
def stopping_after(seconds: float) -> Iterator[None]:
    """Let every local search within end after so many seconds, at its next step.

    A limit within another one ends with the earlier.

    Parameters
    ----------
    seconds : float
        0 or less: at the first step.
    """
    end = min(_END.get(), time.perf_counter() + seconds)
    token = _END.set(end)
    try:
        yield
    finally:
        _END.reset(token)


def seconds_left() -> float:
    """Time until the searches of this thread end, s; infinite without a limit."""
    end = _END.get()
    return end - time.perf_counter() if end < math.inf else math.inf


def time_up() -> bool:
    """Whether the searches of this thread are to end."""
    return seconds_left() <= 0.0
