"""Kernels of populations: no other bits in other company, and one form of each on disk."""

import subprocess
import sys

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher
from support.samples import DECLARATIONS, FREE
from trajgap.problem import (
    Array,
    ClampedBSpline,
    Curve,
    Interpolant,
    Limits,
    Problem,
    check,
    cubic_spline,
    evaluate,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves import PERM, Asked, interpolant, kernel

JOINTS = 3
CURVES: dict[str, Curve] = {
    **DECLARATIONS,
    **FREE,
    "uniform": uniform_cubic_b_spline(5, "timed"),
    "clamped": ClampedBSpline(5, 5, "averaged-continued"),
    "clamped, chord": ClampedBSpline(5, 4, "averaged-continued", "joint-chord"),
}


def drawn(curve: Curve, seed: int) -> tuple[Array, Array, Array]:
    """Way-points, durations with some that are none, and free derivatives."""
    rng = np.random.default_rng(seed)
    count = len(curve.waypoint_breaks) if isinstance(curve, Interpolant) else curve.segments + 1
    q = np.cumsum(rng.normal(size=(count, JOINTS)), axis=0) + 7.0
    if "each joint" not in curve.name:
        q[:, 1] = q[0, 1]  # a joint that stands still
    h = np.exp(2.0 * rng.normal(size=(40, curve.segments)))
    odd = [0.0, np.nan, np.inf, -1.0, 1e-300, 1e250, 1e-9, 1e9]
    h[: len(odd), -1] = odd
    free = curve.free if isinstance(curve, Interpolant) else 0
    return q, h, rng.normal(size=(free, JOINTS))


@pytest.mark.parametrize("name", CURVES)
def test_no_vector_looks_at_another(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    curve = CURVES[name]
    q, h, free = drawn(curve, 3)
    values = curve.motion_values(q, free if name in FREE else None)
    wanted = np.ones((JOINTS, 4), dtype=bool)
    wanted[2, 1] = False
    asked = Asked(wanted, (0.0, -1.0, 1.0), 0)
    found = curve.batch_reach(values, h, asked)
    assert np.isfinite(found).any()
    assert np.isinf(found[:4]).all()
    finite = found[np.isfinite(found).all(axis=(1, 2, 3))]
    assert finite.any()
    assert not finite[..., 2, 1].any()
    alone = [curve.batch_reach(values, one[None], asked)[0] for one in h]
    np.testing.assert_array_equal(found, alone)
    np.testing.assert_array_equal(curve.batch_reach(values, h[::-1].copy(), asked), found[::-1])
    # Sizes are those of the larger side.
    np.testing.assert_array_equal(found[:, 0], found[:, 1:].max(axis=1))
    monkeypatch.setattr(interpolant, "PART", 20)
    np.testing.assert_array_equal(curve.batch_reach(values, h, asked), found)


Q = np.array([[0.15, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])


def frozen(array: Array) -> Array:
    array = array.copy()
    array.flags.writeable = False
    return array


def test_no_question_compiles_the_kernel_again() -> None:
    """Not what may not be written into, other sides, positions, one vector or many."""
    curve = cubic_spline(3)
    h = np.array([[0.8, 1.3, 0.6], [1.1, 0.7, 0.9]])
    limits = Limits([2.0, 1.5], [9.0, 8.0])
    problem = Problem(Q.copy(), limits, curve)
    own = evaluate(problem, h.copy()).ratios
    check(problem, h[0].copy())
    again = Problem(frozen(Q), limits, curve)
    assert (evaluate(again, frozen(h)).ratios == own).all()
    check(again, frozen(h[0]))
    beyond = Limits([2.0, 1.5], [9.0, 8.0], position_upper=[4.0, 5.0])
    uneven = beyond.with_sides([beyond.derivatives, 2.0 * beyond.derivatives])
    assert evaluate(Problem(Q, uneven, curve), h[:1]).positions.shape == (1, 2)
    evaluate(Problem(Q, limits, curve), np.tile(h, (3000, 1)))
    assert len(kernel.batch_peaks.signatures) == 1


QUESTION = """
import sys
from trajgap.problem import Limits, Problem, check, three_five_three
problem = Problem([[0.0], [0.5], [1.0], [0.2]], Limits(1.0, 2.0), three_five_three())
assert check(problem, [1.0, 1.2, 1.1]).stretch > 0
print("numba" in sys.modules)
"""


def test_a_check_does_without() -> None:
    run = subprocess.run([sys.executable, "-c", QUESTION], capture_output=True, text=True)
    assert run.stdout == "False\n", run.stderr


def test_a_kernel_is_what_numba_makes_of_it() -> None:
    a, cuts = np.array([[-1.0], [0.0], [16.0]]), np.empty((2, 1))
    kernel._lane_turns(a, 0, PERM, 1, cuts)  # −1 + 16 s²
    assert cuts.ravel().tolist() == [0.0, 0.25]
    assert isinstance(kernel._lane_turns, Dispatcher)
    assert kernel._lane_turns.signatures
