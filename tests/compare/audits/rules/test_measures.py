"""Means and integrals of a printed motion, against closed forms of a quintic from rest to rest."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from scipy.integrate import quad
from support.findings import finding
from support.made_up import claim, paper, row
from trajgap.compare.audits.rules.measures import NAMES, measured
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import Curve, cubic_spline, fit, uniform_cubic_b_spline

H = 1.25
# Of q(s) = 10 s^3 - 15 s^4 + 6 s^5 rad with s = t/h.
CLOSED = {
    ("velocity", "mean"): 1 / H,
    ("velocity", "rms"): sqrt(10 / 7) / H,
    ("velocity", "integral"): 1.0,
    ("velocity", "integral-square"): 10 / 7 / H,
    ("acceleration", "mean"): 2 * 15 / 8 / H**2,
    ("jerk", "integral-square"): 720 / H**5,
    ("jerk", "rms"): sqrt(720) / H**3,
}


def verdict_on(derivative: str, measure: str, value: str, time: str = "1.2500") -> ClaimVerdict:
    keys = {"derivative": derivative, "measure": measure, "of": "d", "value": value}
    text = paper([[0, 1]], row("d", time), claim("m", "measure", **keys), velocity=9)
    found = finding(text, "m", "TG208")
    assert NAMES[measure] in found.message
    return found.verdict


@pytest.mark.parametrize(("derivative", "measure"), CLOSED)
def test_a_measure_is_its_closed_form(derivative: str, measure: str) -> None:
    exact = CLOSED[derivative, measure]
    assert verdict_on(derivative, measure, f"{exact:.4f}") is ClaimVerdict.SUPPORTED
    assert verdict_on(derivative, measure, f"{0.9 * exact:.4f}") is ClaimVerdict.INCONSISTENT


def test_what_samples_give_is_supported_and_digits_leave_room() -> None:
    times = np.linspace(0, 1, 100)
    jerk = (60 - 360 * times + 360 * times**2) / H**3
    coarse = float(np.sqrt((jerk**2).mean()))
    assert coarse > 1.01 * CLOSED["jerk", "rms"]
    assert verdict_on("jerk", "rms", f"{coarse:.4f}") is ClaimVerdict.SUPPORTED
    assert verdict_on("jerk", "rms", f"{1.2 * coarse:.4f}") is ClaimVerdict.INCONSISTENT
    # 1.2499 s, cut off to 1.2: four per cent away.
    mean = f"{1 / 1.2499:.4f}"
    assert verdict_on("velocity", "mean", mean, "1.2") is ClaimVerdict.SUPPORTED
    assert verdict_on("velocity", "mean", mean, "1.200") is ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(("derivative", "measure"), CLOSED)
@pytest.mark.parametrize("time", [0.0151, 0.0249])
def test_a_duration_of_few_last_digits_leaves_more_than_the_first_order(
    derivative: str, measure: str, time: float
) -> None:
    """Both are printed as 0.02 s: the square of jerk changes by a factor of 12 between them."""
    power = {"velocity": 1, "acceleration": 2, "jerk": 3}[derivative]
    power = 2 * power - 1 if measure == "integral-square" else power
    power = 0 if measure == "integral" else power
    exact = CLOSED[derivative, measure] * (H / time) ** power
    assert verdict_on(derivative, measure, f"{exact:.4f}", "0.02") is ClaimVerdict.SUPPORTED
    if 0 < power < 5:  # beyond, numbers are refused for their size
        far = f"{exact * (time / 0.008) ** power:.4f}"
        assert verdict_on(derivative, measure, far, "0.02") is ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(
    "curve", [cubic_spline(3, ((2, 0.0),)), uniform_cubic_b_spline(4, "timed")]
)
def test_measures_are_those_of_adaptive_quadrature(curve: Curve) -> None:
    points = np.array([[0.1, 0.5], [0.9, -0.2], [-0.3, 0.1], [0.4, 1.0]])
    motion = fit(curve, points, np.array([0.8, 1.1, 0.9]))
    breaks = motion.breaks
    for order in (1, 2):
        found = measured(motion, order, "integral")

        def norm(t: float, order: int = order) -> float:
            return float(np.linalg.norm(motion(t, order)))

        whole = quad(norm, breaks[0], breaks[-1], points=breaks[1:-1], limit=400)[0]
        assert found.norm == pytest.approx(whole, rel=1e-6)
        own = quad(lambda t, o=order: abs(motion(t, o)[1]), *breaks[[0, -1]], limit=400)[0]
        assert found.joints[1] == pytest.approx(own, rel=1e-6)


def test_one_number_of_several_joints_may_be_their_norm_largest_or_mean() -> None:
    motion = fit(cubic_spline(1), np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([2.0]))
    found = measured(motion, 1, "mean")
    assert found.meant(None) == {
        " of the norm over the joints": pytest.approx(2.5),
        " of the largest joint": pytest.approx(2.0),
        " of the joints in the mean": pytest.approx(1.75),
    }
