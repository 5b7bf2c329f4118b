"""The generator of the suite, as benchmarks/suite_cases.py defines it."""

import runpy
import sys
from functools import cache
from pathlib import Path
from typing import Any

from support.checkout import ROOT


@cache
def benchmark(name: str) -> dict[str, Any]:
    """What a benchmark of the suite defines."""
    folder = str(Path(ROOT, "benchmarks"))
    sys.path.insert(0, folder)
    try:
        return runpy.run_path(str(Path(folder, f"{name}.py")))
    finally:
        sys.path.remove(folder)
