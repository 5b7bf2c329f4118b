"""Anybody's own function as an optimiser: ``module:function``, found from the working folder."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ...problem import TrajgapError
from .borrowed import BorrowedTask


def load_function(name: str) -> Callable[..., object]:
    """Import ``module:function``; modules of the working folder are found too.

    Raises
    ------
    TrajgapError
        If a file is named instead of a module, or the module cannot be imported or holds no such
        callable.
    """
    module, _, attribute = name.partition(":")
    if module.endswith(".py"):
        plain = ".".join(Path(module).with_suffix("").parts)
        raise TrajgapError(
            f"{name}: names a file; write {plain}:{attribute}, in the folder that holds {module}"
        )
    here = str(Path.cwd())
    if here not in sys.path and "" not in sys.path:
        sys.path.insert(0, here)
    try:
        found: Any = importlib.import_module(module)
    except Exception as error:
        raise TrajgapError(
            f"{name}: module {module!r} cannot be imported ({type(error).__name__}: {error}); "
            "run this in the folder that holds it, or install it"
        ) from None
    for part in attribute.split("."):
        if not hasattr(found, part):
            raise TrajgapError(f"{name}: module {module!r} has no {attribute!r}; check its name")
        found = getattr(found, part)
    if not callable(found):
        raise TrajgapError(f"{name}: is no function f(fun, bounds, budget, rng)")
    function: Callable[..., object] = found
    return function


def call_function(name: str, options: Mapping[str, Any], task: BorrowedTask) -> object:
    """Call ``f(fun, bounds, budget, rng)``, imported in whichever process it runs."""
    return load_function(name)(task.fun, task.box, task.budget, task.rng, **options)


def call_given(
    function: Callable[..., object], options: Mapping[str, Any], task: BorrowedTask
) -> object:
    """Call a function that was handed over itself."""
    return function(task.fun, task.box, task.budget, task.rng, **options)
