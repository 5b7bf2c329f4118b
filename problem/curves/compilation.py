"""Numba's compiler with a cache that follows the sources of everything compiled together.

The rule is one: what is asked of one curve is array code. What loops over a population, over the
rows of a long system or over the boxes of a proof is compiled at its first call, and lies on disk
for the next process. Nothing is interpreted meanwhile and nothing measures itself, so that no loop
stops in its middle.
"""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable
from functools import update_wrapper
from pathlib import Path
from types import FunctionType
from typing import Any, cast

_MAKING = threading.RLock()
"""Held while a function is handed to numba: two threads make one dispatcher."""


def compiler(*sources: Path) -> Callable[[Callable[..., Any]], Kernel]:
    """Make a decorator for functions to be compiled, and cached where there is a writable place.

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

    def compiled(function: Callable[..., Any]) -> Kernel:
        function.__qualname__ = f"{function.__qualname__}_{stamp}"
        return Kernel(function)

    return compiled


class Kernel:
    """A function that numba compiles, and that brings numba in only when it is called or compiled.

    Parameters
    ----------
    function : callable

    Attributes
    ----------
    py_func : function
        The function itself, as of numba's dispatchers.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = cast(FunctionType, function)
        self._dispatcher: Any = None
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function."""
        made = self._dispatcher or self.dispatcher
        return made(*arguments)

    @property
    def dispatcher(self) -> Any:
        """What numba makes of the function, and the function itself where it is switched off."""
        with _MAKING:
            if self._dispatcher is None:
                # numba knows dispatchers alone where a function calls another one.
                own = self.py_func.__globals__
                for name in self.py_func.__code__.co_names:
                    if isinstance(own.get(name), Kernel):
                        own[name] = own[name].dispatcher
                self._dispatcher = _jitted(self.py_func)
        return self._dispatcher

    @property
    def signatures(self) -> list[Any]:
        """Forms of arguments that it is compiled for in this process."""
        return [] if self._dispatcher is None else list(getattr(self._dispatcher, "signatures", ()))


def _jitted(function: FunctionType) -> Any:
    import numba

    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # no writable place for the cache: compile in memory
        return numba.njit(nogil=True, error_model="numpy")(function)
