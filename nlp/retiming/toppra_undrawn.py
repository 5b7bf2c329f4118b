"""toppra without matplotlib, which takes most of its import and only draws."""

from __future__ import annotations

import builtins
import importlib
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType, SimpleNamespace
from typing import Any

_DRAWING = ("toppra.algorithm.algorithm", "toppra.parametrizer")
"""Modules of toppra that begin with `import matplotlib.pyplot as plt`, and use it in methods."""
_PYPLOT = "matplotlib.pyplot"
"""What they import."""


class _Later:
    """A module that is imported when something in it is asked for."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(importlib.import_module(self._name), attribute)


def _import(name: str, scope: Mapping[str, object] | None = None, *arguments: Any) -> Any:
    """What `import` calls in those modules: pyplot comes later, the rest as ever."""
    if name == _PYPLOT:
        return SimpleNamespace(pyplot=_Later(_PYPLOT))
    return builtins.__import__(name, scope, *arguments)


class _Undrawn(Loader):
    """Runs a module with its own `import`: no other module and no list of modules is touched."""

    def __init__(self, usual: Loader) -> None:
        self._usual = usual

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self._usual.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__["__builtins__"] = {**vars(builtins), "__import__": _import}
        self._usual.exec_module(module)


class _Finder(MetaPathFinder):
    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(fullname, path, target) if fullname in _DRAWING else None
        if spec is not None and spec.loader is not None:
            spec.loader = _Undrawn(spec.loader)
        return spec


@contextmanager
def undrawn() -> Iterator[None]:
    """Import toppra inside this, and matplotlib is imported when toppra is asked to draw.

    toppra that is imported already stays as it is; so does all else that imports matplotlib.
    """
    finder = _Finder()
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
