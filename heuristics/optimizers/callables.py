"""Anybody's own function as an optimiser: ``module:function``, found from the working folder."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ...problem import TrajgapError
from ..settings import nearest
from .borrowed import BorrowedTask

_ARGUMENTS = ("fun", "bounds", "budget", "rng")
"""What every function of somebody else's is called with, in this order."""


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
        raise TrajgapError(f"{name}: is not a function f(fun, bounds, budget, rng)")
    function: Callable[..., object] = found
    return function


def check_call(name: str, function: Callable[..., object], settings: Mapping[str, object]) -> None:
    """Find out whether ``f(fun, bounds, budget, rng, **settings)`` can be called.

    What Python cannot tell the signature of, such as a builtin, is left to the call.

    Raises
    ------
    TrajgapError
        If it has no such setting, which names the nearest, or takes other arguments.
    """
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return
    kinds = inspect.Parameter
    every = list(enumerate(signature.parameters.values()))
    if all(one.kind != kinds.VAR_KEYWORD for _, one in every):
        known = [
            one.name
            for at, one in every
            if one.kind == kinds.KEYWORD_ONLY
            or (at >= len(_ARGUMENTS) and one.kind == kinds.POSITIONAL_OR_KEYWORD)
        ]
        check_settings(name, settings, known)
    try:
        signature.bind(*_ARGUMENTS, **settings)
    except TypeError as error:
        raise TrajgapError(
            f"{name}: is called with fun, bounds, budget and rng; it takes {signature} ({error})"
        ) from None


def check_settings(name: str, settings: Mapping[str, object], known: Iterable[str]) -> None:
    """Find out whether a function has settings of these names.

    Raises
    ------
    TrajgapError
        If not; names the nearest.
    """
    there = list(known)
    for key in settings:
        if key not in there:
            said = nearest(key, there) if there else "it has none"
            raise TrajgapError(f"{name}: {key}: unknown setting; {said}")


def call_function(name: str, options: Mapping[str, Any], task: BorrowedTask) -> object:
    """Call ``f(fun, bounds, budget, rng)``, imported in whichever process it runs."""
    return load_function(name)(task.fun, task.box, task.budget, task.rng, **options)


def call_object(
    function: Callable[..., object], options: Mapping[str, Any], task: BorrowedTask
) -> object:
    """Call a function that was handed over itself."""
    return function(task.fun, task.box, task.budget, task.rng, **options)
