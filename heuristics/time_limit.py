"""A time limit for searches that hang: they are interrupted wherever they are."""

from __future__ import annotations

import ctypes
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_AGAIN = 0.5
"""Seconds after which an interruption is repeated, for a search that catches everything."""


class TimeSpent(BaseException):
    """Ends a search whose time is over; like `BudgetSpent` it passes every ``except Exception``."""


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Raise `TimeSpent` in what runs inside, once the time is over.

    In the main thread an alarm interrupts waiting too; in other threads, and where there are no
    alarms, the exception comes at the next step of Python code. Compiled code that never returns
    is not interrupted: only the end of its process ends that.

    Parameters
    ----------
    seconds : float or None
        No limit if None.
    """
    if seconds is None:
        yield
    elif hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        with _alarmed(seconds):
            yield
    else:
        with _watched(seconds):
            yield


@contextmanager
def _alarmed(seconds: float) -> Iterator[None]:
    def over(*_: object) -> None:
        raise TimeSpent

    before = signal.signal(signal.SIGALRM, over)
    try:
        # Inside the try, so even an alarm that comes at once is taken back.
        signal.setitimer(signal.ITIMER_REAL, seconds, _AGAIN)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def _watched(seconds: float) -> Iterator[None]:
    thread = ctypes.c_ulong(threading.get_ident())
    ended = threading.Event()

    def watch() -> None:
        wait = seconds
        while not ended.wait(wait):
            wait = _AGAIN
            ctypes.pythonapi.PyThreadState_SetAsyncExc(thread, ctypes.py_object(TimeSpent))

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
        ctypes.pythonapi.PyThreadState_SetAsyncExc(thread, None)  # one that has not come yet
