"""Programs of benchmarks/, loaded as modules."""

import importlib.util
import runpy
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType
from typing import Any

from support.checkout import ROOT

FOLDER = ROOT / "benchmarks"


@contextmanager
def _beside() -> Iterator[None]:
    """Programs import others that lie beside them."""
    sys.path.insert(0, str(FOLDER))
    try:
        yield
    finally:
        sys.path.remove(str(FOLDER))


@cache
def benchmark(name: str) -> dict[str, Any]:
    """What a program defines."""
    with _beside():
        return runpy.run_path(str(FOLDER / f"{name}.py"))


def loaded(name: str) -> ModuleType:
    """A program as a module, afresh."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    with _beside():
        spec.loader.exec_module(module)
    return module
