"""Programs of benchmarks/, loaded as modules."""

import importlib.util
import runpy
import sys
from functools import cache
from types import ModuleType
from typing import Any

from support.checkout import ROOT


@cache
def benchmark(name: str) -> dict[str, Any]:
    """What a program defines, which may import others that lie beside it."""
    folder = ROOT / "benchmarks"
    sys.path.insert(0, str(folder))
    try:
        return runpy.run_path(str(folder / f"{name}.py"))
    finally:
        sys.path.remove(str(folder))


def loaded(name: str) -> ModuleType:
    """A program as a module, afresh."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module
