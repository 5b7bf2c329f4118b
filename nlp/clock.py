"""One clock for every time limit: what is left of one, and when the searches within are to end.

A search that is stopped returns the best that it has. Nothing is interrupted. Where no limit is
set, no search depends on the clock.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from copy import copy


class RunClock:
    """What is left of a time limit.

    Parameters
    ----------
    seconds : float
        The limit; inf for none.
    """

    spare = 1.0
    """Seconds that judging may take beyond the limit: what takes no time is judged without one."""
    least = 0.5
    """Seconds that judging has whenever it begins: a certificate of usual size takes a tenth."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._began = time.perf_counter()

    @property
    def used(self) -> float:
        """Seconds since it began."""
        return time.perf_counter() - self._began

    @property
    def left(self) -> float:
        """Seconds until the limit; 0 where it is over."""
        return max(0.0, self.seconds - self.used)

    @property
    def judging(self) -> float:
        """Seconds that judging may take: until `spare` after the limit, and `least` at least."""
        return max(self.least, self.seconds + self.spare - self.used)

    def share(self, part: float) -> RunClock:
        """A clock that began with this one and ends after a part of what is left."""
        ends = copy(self)
        ends.seconds = self.used + part * self.left
        return ends


_LIMIT: ContextVar[RunClock] = ContextVar("limit")
"""The clock at which the searches of this thread end: none without `stopping_after`."""


@contextmanager
def stopping_after(seconds: float) -> Iterator[None]:
    """End every local search within this context after a number of seconds, at its next step.

    If limits are nested, the earlier one applies.

    Parameters
    ----------
    seconds : float
        0 or less: at the first step.
    """
    token = _LIMIT.set(RunClock(min(seconds_left(), seconds)))
    try:
        yield
    finally:
        _LIMIT.reset(token)


def seconds_left() -> float:
    """Time until the searches of this thread end, s; infinite without a limit."""
    limit = _LIMIT.get(None)
    return math.inf if limit is None else limit.left


def time_up() -> bool:
    """Whether the searches of this thread are to end."""
    return seconds_left() <= 0.0
