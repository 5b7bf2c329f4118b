"""Numba's compiler with a cache that follows the sources of everything compiled together.

The rule is one: what is asked of one curve is array code. What loops over a population, over the
rows of a long system or over the boxes of a proof is compiled at its first call, and lies on disk
for the next process. Nothing is interpreted meanwhile and nothing measures itself, so no loop
stops in its middle. Whoever calls such a function imports its module there and not before, because
numba takes a while.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

Function = Callable[..., Any]


def compiler(*sources: Path) -> Callable[[Function], Function]:
    """Make a decorator for functions to be compiled, and cached where there is a writable place.

    numba's cache looks at the file of the function alone, so a function would go on calling an
    old callee from another file. Functions that call each other are compiled by one decorator, and
    the hash of all their files stands in their names.

    The sources are every file with functions that this decorator compiles.
    """
    import numba

    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]

    def compiled(function: Function) -> Function:
        function.__qualname__ = f"{function.__qualname__}_{stamp}"
        try:
            made = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
        except RuntimeError:  # no writable place for the cache: compile in memory
            made = numba.njit(nogil=True, error_model="numpy")(function)
        return made

    return compiled
