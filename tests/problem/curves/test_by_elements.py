"""Kernels on lists of floats give the bits of the same kernels on arrays, and go back to these."""

from __future__ import annotations

import math
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from trajgap.nlp.optimum import newton
from trajgap.problem import Limits, Problem, piecewise, quintic_spline, three_five_three
from trajgap.problem.curves import Deferred, by_elements, compilation, interpreted, kernel

MARKED = {
    "problem.curves.kernel": {"_bracketed_root", "roots_in_unit"},
    "nlp.optimum.newton_curve": {"curve_at", "rows_at", "add_curvature"},
    "nlp.optimum.newton_program": {"inverted", "least_step", "filled"},
    "nlp.optimum.newton_kernel": {"_shares", "_known"},
}
"""The kernels that interpreting a first solve spends its time in."""


def on_arrays(function):
    """The function as Python runs it on arrays, with all that it calls."""
    plain = getattr(function, "py_func", function)
    names = {
        name: on_arrays(value) if hasattr(value, "writes") else value
        for name, value in compilation._globals_of(plain)
    }
    return type(plain)(plain.__code__, names, plain.__name__, plain.__defaults__)


def test_the_kernels_that_take_the_time_are_marked():
    for name, wanted in MARKED.items():
        own = vars(import_module(f"trajgap.{name}"))
        full = f"trajgap.{name}"
        found = {
            key
            for key, value in own.items()
            if hasattr(value, "writes") and getattr(value, "__module__", full) == full
        }
        assert found == wanted, name


def test_every_parameter_that_is_written_exists():
    for name, keys in MARKED.items():
        for key in keys:
            function = getattr(import_module(f"trajgap.{name}"), key)
            plain = getattr(function, "py_func", function)
            assert set(function.writes) <= set(plain.__code__.co_varnames), key


@pytest.mark.parametrize("curve", [three_five_three(), piecewise((4, 3, 4)), quintic_spline(3)])
def test_descents_end_at_the_same_bits(curve, monkeypatch):
    """Every marked kernel takes part; positions and jerk are limited, one joint is shifted."""
    waypoints = np.array([[0.1, -0.5], [0.7, 0.25], [1.25, -0.375], [0.9, 0.3125]])
    limits = Limits([1.0, 1.5], [2.0, 1.25], [9.0, np.inf], [-1.0, -0.75], [1.5, np.inf])
    problem = Problem(waypoints, limits, curve, duration_lower=[0.1, 0.2, 0.1])
    found = []
    for way in (interpreted, on_arrays):
        monkeypatch.setattr(newton, "_descents", quiet(way(newton.kernel.descents)))
        starts = np.log([[0.9, 1.2, 0.8], [2.0, 0.3, 1.0], [0.2, 3.0, 0.4]])
        low, high = np.log(problem.duration_lower), np.full(3, 4.0)
        found.append(newton.Descents(problem).run(starts, low, high, 60))
    (ends, status), (plain_ends, plain_status) = found
    assert np.isfinite(ends).all()
    assert (status[:, 0] == newton.kernel.CONVERGED).any()
    assert ends.tobytes() == plain_ends.tobytes()
    assert status.tobytes() == plain_status.tobytes()


def quiet(run):
    """What is not finite is no reason for a warning, as in `Deferred`."""

    def called(*arguments):
        with np.errstate(all="ignore"):
            return run(*arguments)

    return called


def _reciprocals(a, b, out):
    for i in range(a.size):
        out[i, 0] = a[i] / b[i, 1]
        out[i, 1] = math.sqrt(b[i, 0])
    return a.shape[0] + b.size


def test_where_floats_raise_arrays_go_on():
    function = by_elements("out")(_reciprocals)
    run = interpreted(function)
    a, b = np.array([1.0, -2.0]), np.array([[4.0, 0.5], [9.0, 4.0]])
    out = np.full((2, 3), 7.0)
    with np.errstate(all="ignore"):
        assert run(a, b, out) == 6
        assert out.tolist() == [[2.0, 2.0, 7.0], [-0.5, 3.0, 7.0]]
        b[1, 1] = 0.0
        assert run(a, b, out[::-1]) == 6
    assert out.tolist() == [[-math.inf, 3.0, 7.0], [2.0, 2.0, 7.0]]


def _unwritten(a, room):
    for i in range(a.size):
        room[i] = a[i]
    return room[0]


def test_what_is_room_may_be_left_as_it_was():
    room = np.zeros(2)
    assert interpreted(by_elements()(_unwritten))(np.array([3.0, 4.0]), room) == 3.0
    assert room.tolist() == [0.0, 0.0]


# --- numba is imported late -----------------------------------------------------------------------


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
