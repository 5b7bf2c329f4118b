"""Processes that run tests together compile each function once: the others wait, and load it."""

import os
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from pathlib import Path
from typing import Any

from numba.core.dispatcher import Dispatcher

try:
    import fcntl
except ImportError:  # without such locks each process compiles for itself, to the same end
    fcntl = None  # type: ignore[assignment]


@cache
def _lock_file(folder: Path) -> int:
    """A file beside what is compiled; closing it anywhere would let go of all its locks."""
    return os.open(folder / "compiling.lock", os.O_RDWR | os.O_CREAT, 0o600)


@contextmanager
def alone(folder: Path, name: str) -> Iterator[None]:
    """No other process is here for the same name; one that ends, however, lets others in."""
    file, place = _lock_file(folder), zlib.crc32(name.encode())
    fcntl.lockf(file, fcntl.LOCK_EX, 1, place)
    try:
        yield
    finally:
        fcntl.lockf(file, fcntl.LOCK_UN, 1, place)


def _waiting(compiling: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(compiling)
    def compiled(self: Any, sig: Any) -> Any:
        folder = self.stats.cache_path
        if folder is None:  # what stays in memory is of no use to others
            return compiling(self, sig)
        # Functions do not call each other in circles, so no two processes wait for each other.
        with alone(Path(folder), self.py_func.__qualname__):
            return compiling(self, sig)

    return compiled


def share_compiling() -> None:
    """From now on this process compiles nothing that another one is compiling."""
    if fcntl is not None:
        Dispatcher.compile = _waiting(Dispatcher.compile)
