"""Kernels on lists of floats give the bits of the same kernels on arrays, and go back to these."""

import math
from importlib import import_module

import numpy as np
import pytest
from trajgap.nlp.optimum import newton
from trajgap.problem import Limits, Problem, piecewise, quintic_spline, three_five_three
from trajgap.problem.curves import by_elements, compilation, interpreted

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
