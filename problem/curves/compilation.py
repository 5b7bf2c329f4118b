"""Numba's compiler with a cache that follows the sources of everything compiled together."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numba


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
