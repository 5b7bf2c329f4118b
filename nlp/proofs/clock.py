"""The time limit of a certification."""

from __future__ import annotations

import time


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
        """A clock for a part of what is left, from now on."""
        return RunClock(part * self.left)
