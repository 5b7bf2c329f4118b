"""Numba's compiler with a cache that follows the sources of everything compiled together."""

from __future__ import annotations

import hashlib
import math
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, cast

import numba
import numpy as np
from numba.core.registry import CPUDispatcher

LOOK = 0.1
"""Share of the time of compiling after which it is looked again whether another process did it."""


def compiler(*sources: Path) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that compiles functions, cached on disk where there is a writable place.

    numba's cache looks at the file of the function alone, so that a function would go on calling an
    old callee from another file. Functions that call each other are compiled by one decorator, and
    the hash of all their files stands in their names.

    Parameters
    ----------
    *sources : Path
        Every file with functions that this decorator compiles.

    Returns
    -------
    callable
    """
    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]

    def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
        function.__qualname__ = f"{function.__qualname__}_{stamp}"
        try:
            jitted = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
        except RuntimeError:  # no writable place for the cache: compile in memory
            jitted = numba.njit(nogil=True, error_model="numpy")(function)
        return cast(Callable[..., Any], jitted)

    return compiled


@cache
def interpreted(function: Any) -> Callable[..., Any]:
    """A compiled function as Python itself runs it, with all that it calls.

    Parameters
    ----------
    function : numba dispatcher

    Returns
    -------
    callable
        The same numbers to the last bit, where only the functions of `math` are called: neither
        way reorders or fuses an operation.
    """
    plain = getattr(function, "py_func", function)  # plain already where compiling is switched off
    names = {
        name: interpreted(value) if isinstance(value, CPUDispatcher) else value
        for name, value in plain.__globals__.items()
        if name in plain.__code__.co_names
    }
    return FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__)


class Deferred:
    """A compiled function that Python runs until compiling it is worth the wait.

    What was compiled before, in this process or by another one that left it on disk, is used at
    once. Otherwise calls are interpreted until they have taken as long as compiling would: so
    nothing ever takes more than twice the time of the better way.

    Parameters
    ----------
    function : numba dispatcher
    seconds : float
        Time that compiling it takes.
    left : callable, optional
        How much time there is. It is compiled only where that is enough to compile it.
    """

    def __init__(
        self, function: Any, seconds: float, left: Callable[[], float] = lambda: math.inf
    ) -> None:
        self._function, self._left = function, left
        self._seconds, self._spent, self._look = seconds, 0.0, 0.0
        self._ready = False

    @property
    def compiled(self) -> bool:
        """Whether the last call was one of the compiled function."""
        return self._ready

    def __call__(self, *arguments: Any) -> Any:
        """Call the function, one way or the other."""
        if not self._ready and self._spent >= self._look:
            worth = self._spent >= self._seconds and self._left() > self._seconds
            self._ready = worth or at_hand(self._function)
            self._look = self._spent + LOOK * self._seconds
        if self._ready:
            return self._function(*arguments)
        began = time.thread_time()
        with np.errstate(all="ignore"):
            found = interpreted(self._function)(*arguments)
        self._spent += time.thread_time() - began
        return found


def at_hand(function: Any) -> bool:
    """Whether a compiled form of a function is in this process or on disk.

    Parameters
    ----------
    function : numba dispatcher

    Returns
    -------
    bool
    """
    if not isinstance(function, CPUDispatcher):
        return True  # compiling is switched off: it is a plain function
    if function.signatures:
        return True
    place = function.stats.cache_path
    name = f"*{function.py_func.__qualname__}-*py{sys.version_info[0]}{sys.version_info[1]}*.nbi"
    return place is not None and any(Path(place).glob(name))
