"""Kernels are compiled for one form of array, whether or not it may be written into."""

from __future__ import annotations

import numpy as np
import pytest
from trajgap.problem import (
    Array,
    ClampedBSpline,
    Curve,
    Limits,
    Problem,
    check,
    cubic_spline,
    evaluate,
    uniform_cubic_b_spline,
)
from trajgap.problem.curves import clamped_kernel, kernel, spline, timed_kernel

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
