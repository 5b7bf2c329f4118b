"""numba is imported when something compiled is worth loading, and not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from trajgap.problem.curves import Deferred, compilation, kernel

QUESTION = """
import sys
from trajgap.problem import Limits, Problem, check, evaluate, three_five_three
problem = Problem([[0.0], [0.5], [1.0], [0.2]], Limits(1.0, 2.0), three_five_three())
assert check(problem, [1.0, 1.2, 1.1]).stretch > 0
assert evaluate(problem, [[1.0, 1.2, 1.1]] * 5).stretch.shape == (5,)
print("numba" in sys.modules)
"""


def test_a_check_does_without() -> None:
    run = subprocess.run([sys.executable, "-c", QUESTION], capture_output=True, text=True)
    assert run.stdout == "False\n", run.stderr


class Counted:
    """Stands in for a kernel with a compiled form in this process."""

    signatures = ("one",)

    def __init__(self) -> None:
        self.calls = 0

    def py_func(self, x: float) -> float:
        return x

    def __call__(self, x: float) -> float:
        self.calls += 1
        return x


@pytest.mark.parametrize(
    ("waited", "in_use", "compiled"),
    [(0.0, False, 0), (compilation.LOADING, False, 1), (0.0, True, 1)],
)
def test_what_is_at_hand_waits_until_loading_it_pays(
    waited: float, in_use: bool, compiled: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Deferred, "_waited", waited)
    monkeypatch.setattr(Deferred, "_in_use", in_use)
    function = Counted()
    assert Deferred(function, 10.0, lambda x: x)(2.0) == 2.0
    assert function.calls == compiled


def test_time_counts_only_where_a_compiled_form_is_at_hand(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(Deferred, "_waited", 0.0)
    monkeypatch.setattr(Deferred, "_in_use", False)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    own = compilation.Kernel(kernel.roots_in_unit.py_func)
    polynomial = np.array([-0.25, 0.0, 1.0])
    for on_disk in (False, True):
        if on_disk:
            version = f"py{sys.version_info[0]}{sys.version_info[1]}"
            (tmp_path / f"kernel.{own.py_func.__qualname__}-63.{version}.nbi").touch()
        Deferred(own, 10.0, lambda a: np.roots(a[::-1]))(polynomial)
        assert (Deferred._waited > 0.0) == on_disk


def test_a_kernel_is_what_numba_makes_of_it() -> None:
    function = kernel.roots_in_unit
    assert function.dispatcher.py_func is function.py_func
    assert function.dispatcher.writes == function.writes == ("roots",)
    assert all(
        not isinstance(x, compilation.Kernel) for _, x in compilation._globals_of(function.py_func)
    )
