"""The time limit of a certification, which compiling does not eat."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


class RunClock:
    """What is left of a time limit; while it stands still, as in compiling, nothing of it goes.

    Parameters
    ----------
    seconds : float
        The limit; inf for none.
    within : RunClock, optional
        A clock that stands still where this one does.
    """

    spare = 1.0
    """Seconds that judging may take beyond the limit: what takes no time is judged without one."""
    least = 0.5
    """Seconds that judging has whenever it begins: a certificate of usual size takes a tenth."""

    def __init__(self, seconds: float, within: RunClock | None = None) -> None:
        self.seconds, self._within = seconds, within
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
        """A clock for a part of what is left, from now on."""
        return RunClock(part * self.left, self)

    @contextmanager
    def standing(self) -> Iterator[None]:
        """Within, the clock stands still."""
        began = time.perf_counter()
        try:
            yield
        finally:
            self.put_off(time.perf_counter() - began)

    def put_off(self, seconds: float) -> None:
        """End so much later."""
        self._began += seconds
        if self._within is not None:
            self._within.put_off(seconds)
