"""Batches while nothing is compiled: the bits of the compiled kernels, and a closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
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
    evaluate_leading,
    keeps_limits,
    rest_to_rest,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves import (
    Deferred,
    clamped,
    clamped_kernel,
    interpreted,
    kernel,
    lanes,
    leading_kernel,
    spline,
    timed_kernel,
    uniform,
)

JOINTS = 3
CURVES = {**DECLARATIONS, **FREE}


def never(function: Any, plainly: Callable[..., Any] | None = None) -> Deferred:
    """One that is not compiled in this test, though it lies on disk."""
    waiting = Deferred(function, 1e9, plainly)
    waiting._look = 1e9
    return waiting


def drawn(curve: Curve, seed: int) -> tuple[Array, Array, Array]:
    """Way-points, durations with some that are none, and free derivatives."""
    rng = np.random.default_rng(seed)
    count = len(curve.waypoint_breaks) if isinstance(curve, Interpolant) else curve.segments + 1
    q = np.cumsum(rng.normal(size=(count, JOINTS)), axis=0) + 7.0
    q[:, 1] = q[0, 1]  # a joint that stands still
    h = np.exp(2.0 * rng.normal(size=(40, curve.segments)))
    odd = [0.0, np.nan, np.inf, -1.0, 1e-300, 1e250, 1e-9, 1e9]
    h[: len(odd), -1] = odd
    free = curve.free if isinstance(curve, Interpolant) else 0
    return q, h, rng.normal(size=(free, JOINTS))


@pytest.mark.parametrize("side", [0.0, 1.0, -1.0])
@pytest.mark.parametrize("name", CURVES)
def test_numpy_finds_the_peaks_of_the_compiled_kernel_to_the_last_bit(
    name: str, side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    curve = CURVES[name]
    q, h, free = drawn(curve, 3)
    values = spline.motion_values(curve, q, free if name in FREE else None)
    wanted = np.ones((JOINTS, 3), dtype=bool)
    wanted[2, 1] = False
    found = []
    for way in (kernel.batch_peaks, never(kernel.batch_peaks, lanes.batch_peaks)):
        monkeypatch.setattr(spline, "_peaks_of_many", way)
        if way is kernel.batch_peaks:
            monkeypatch.setattr(spline, "_THREAD_WORK", np.inf)
        found.append(spline.batch_peaks(curve, values, h, wanted, side))
    assert np.isfinite(found[0]).any()
    np.testing.assert_array_equal(found[0], found[1])
    monkeypatch.setattr(lanes, "_LANES", 2 * JOINTS)  # two vectors at a time
    np.testing.assert_array_equal(spline.batch_peaks(curve, values, h, wanted, side), found[0])


def stretches(peaks: Array, limits: Array) -> Array:
    """Largest stretch that the peaks of each vector ask for."""
    with np.errstate(all="ignore"):
        asked = np.where(np.isfinite(limits), peaks / limits, 0.0).max(axis=1)
    return np.max([asked[:, 0], np.sqrt(asked[:, 1]), np.cbrt(asked[:, 2])], axis=0)


@pytest.mark.parametrize("floor", [0.0, 0.8])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (0.01, 1.0, 1.0), (1.0, 1e-6, 1.0)])
@pytest.mark.parametrize("name", CURVES)
def test_peaks_that_lead_ask_for_the_stretch_of_all_to_the_last_bit(
    name: str, scale: tuple[float, float, float], floor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    curve = CURVES[name]
    q, h, free = drawn(curve, 6)
    values = spline.motion_values(curve, q, free if name in FREE else None)
    limits = np.array([[2.0, 9.0, 80.0], [2.5, np.inf, 60.0], [3.0, 7.0, np.inf]]) * scale
    wanted = np.isfinite(limits)
    every = spline.batch_peaks(curve, values, h, wanted)
    due = np.maximum(stretches(every, limits), floor)
    monkeypatch.setattr(spline, "_leading_of_many", leading_kernel.leading_peaks)
    monkeypatch.setattr(spline, "_THREAD_WORK", np.inf)
    found = spline.leading_peaks(curve, values, h, wanted, limits, floor)
    assert np.isfinite(due).any()
    assert (found < every).any()  # something was left out
    assert (found <= every).all()
    np.testing.assert_array_equal(np.maximum(stretches(found, limits), floor), due)
    waiting = never(leading_kernel.leading_peaks, lanes.leading_peaks)
    monkeypatch.setattr(spline, "_leading_of_many", waiting)
    plain = spline.leading_peaks(curve, values, h, wanted, limits, floor)
    np.testing.assert_array_equal(plain, every)


@pytest.mark.parametrize("least", [2.0, 0.0])
def test_stretches_and_kept_limits_are_those_of_all_peaks(least: float) -> None:
    curve = DECLARATIONS["cubic"]
    q, h, _ = drawn(curve, 7)
    limits = Limits([least, 3.0, 4.0], [9.0, 8.0, 7.0], position_upper=[9.0, 8.0, 8.5])
    problem = Problem(q, limits, curve)
    due, found = evaluate(problem, h), evaluate_leading(problem, h)
    np.testing.assert_array_equal(found.stretch, due.stretch)
    np.testing.assert_array_equal(found.positions, due.positions)
    with np.errstate(invalid="ignore"):
        h = h * due.stretch[:, None] * np.linspace(0.9, 1.3, len(h))[:, None]
    every = evaluate(problem, h)
    kept = (every.ratios <= 1.0).all(axis=(1, 2)) & (every.positions <= 1.0).all(axis=1)
    assert kept.any() == (least > 0)
    assert not kept.all()
    np.testing.assert_array_equal(keeps_limits(problem, h, 0.0), kept)


@pytest.mark.parametrize("name", CURVES)
def test_numpy_fits_the_coefficients_of_the_compiled_kernel_to_the_last_bit(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    curve = CURVES[name]
    q, h, free = drawn(curve, 4)
    found = []
    for way in (kernel.fit_coefficients, never(kernel.fit_coefficients, lanes.fit_coefficients)):
        monkeypatch.setattr(spline, "_fit_many", way)
        nodal = free if name in FREE else None
        found.append(spline.batch_coefficients(curve, q, h[8:], nodal))
    np.testing.assert_array_equal(found[0], found[1])


@pytest.mark.parametrize(
    ("curve", "module", "compiled"),
    [
        (uniform_cubic_b_spline(5, "timed"), uniform, timed_kernel.batch_peaks),
        (ClampedBSpline(5, 5, "averaged-continued"), clamped, clamped_kernel.batch_peaks),
        (ClampedBSpline(5, 4, "averaged-continued", "chord"), clamped, clamped_kernel.batch_peaks),
    ],
    ids=["uniform", "clamped, degree 5", "clamped, degree 4"],
)
def test_b_splines_have_the_same_bits_interpreted(
    curve: Curve, module: Any, compiled: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    q, h, _ = drawn(curve, 5)
    problem = Problem(q, Limits([2.0, 3.0, 4.0], [9.0, 8.0, 7.0], [40.0, 50.0, 60.0]), curve)
    found = []
    for way in (compiled, never(compiled), interpreted(compiled)):
        monkeypatch.setattr(module, "_peaks_of_many", way)
        with np.errstate(all="ignore"):
            found.append(evaluate(problem, h).ratios)
    assert np.isfinite(found[0]).any()
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


def test_minimum_jerk_by_numpy_has_the_peaks_of_its_closed_form(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    waiting = never(kernel.batch_peaks, lanes.batch_peaks)
    monkeypatch.setattr(spline, "_peaks_of_many", waiting)
    limits = Limits([2.0], [3.0], [5.0])
    h = np.array([[0.7], [1.3]])
    found = evaluate(Problem(np.array([[0.4], [-0.9]]), limits, rest_to_rest(1, 5)), h).ratios
    # |v| = 15/8 d/T, |a| = 10/√3 d/T², |j| = 60 d/T³
    peaks = 1.3 * np.array([15 / 8, 10 / np.sqrt(3), 60]) / h ** np.array([1, 2, 3])
    np.testing.assert_allclose(found[:, 0], peaks / np.array([2.0, 3.0, 5.0]), rtol=1e-12)
    assert not waiting.compiled


# --- what may not be written into -----------------------------------------------------------------


Q = np.array([[0.15, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
COMPILED = (
    kernel.batch_peaks,
    kernel.fit_coefficients,
    clamped_kernel.batch_peaks,
    timed_kernel.batch_peaks,
)


def frozen(array: Array) -> Array:
    array = array.copy()
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "curve",
    [
        cubic_spline(3),
        ClampedBSpline(4, 5, "averaged-continued"),
        ClampedBSpline(4, 5, "averaged-continued", "chord"),
        uniform_cubic_b_spline(4, "timed"),
    ],
    ids=str,
)
def test_what_may_not_be_written_into_compiles_nothing_again(
    curve: Curve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spline, "_fit_one", kernel.fit_coefficients)
    h = np.array([[0.8, 1.3, 0.6], [1.1, 0.7, 0.9]])
    limits = Limits([2.0, 1.5], [9.0, 8.0])
    problem = Problem(Q.copy(), limits, curve)
    own = evaluate(problem, h.copy()).ratios
    check(problem, h[0].copy())
    before = [len(one.signatures) for one in COMPILED]
    again = Problem(frozen(Q), limits, curve)
    assert (evaluate(again, frozen(h)).ratios == own).all()
    check(again, frozen(h[0]))
    assert [len(one.signatures) for one in COMPILED] == before
