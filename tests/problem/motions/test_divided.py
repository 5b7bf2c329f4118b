"""Divided differences beside exact ones, window by window."""

from fractions import Fraction
from math import factorial, prod

import numpy as np
import pytest
from trajgap.problem import Array
from trajgap.problem.motions import divided
from trajgap.problem.motions.divided import divided_extremes

NOISE = np.array([0.0, 3e-4])
ROUNDING = Fraction(1, 10**10)
"""Of values up to 45 at times with steps of 1e-2: what the error may have beyond the noise."""


def samples(seed: int, count: int = 23) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    times = 7.0 + np.cumsum(rng.uniform(0.01, 0.3, count))
    return times, rng.normal(size=(count, 2)) + np.array([5.0, -40.0])


def exact(times: Array, values: Array, order: int, stride: int) -> list[tuple[Fraction, Fraction]]:
    """Of each window the order-th derivative and the sum of its absolute weights, in rationals."""
    found = []
    for k in range(times.size - order * stride):
        t = [Fraction(x) for x in times[k::stride][: order + 1].tolist()]
        q = [Fraction(x) for x in values[k::stride][: order + 1].tolist()]
        weights = [
            factorial(order) / prod((a - b for b in t if b != a), start=Fraction(1)) for a in t
        ]
        value = sum((w * x for w, x in zip(weights, q, strict=True)), Fraction(0))
        found.append((value, sum(map(abs, weights), Fraction(0))))
    return found


@pytest.mark.parametrize("order", range(4))
@pytest.mark.parametrize("stride", [1, 2, 5])
def test_the_window_that_proves_most_and_its_error(order: int, stride: int) -> None:
    times, values = samples(10 * order + stride)
    found, widest = divided_extremes(times, values, order, stride, NOISE)
    for j, noise in enumerate(map(Fraction, NOISE.tolist())):
        truth = exact(times, values[:, j], order, stride)
        for side, sign in enumerate((1, -1)):
            # What noise leaves of each window; the smallest on side 0, the largest on side 1.
            proofs = [value + sign * noise * weight for value, weight in truth]
            best = (min, max)[side](proofs)
            k = proofs.index(best)
            value, error, middle = found[j, side]
            assert abs(Fraction(float(value)) - truth[k][0]) <= Fraction(float(error))
            assert float(error) >= float(noise * truth[k][1])
            assert float(error) <= float((noise + ROUNDING) * truth[k][1])
            assert middle == pytest.approx((times[k] + times[k + order * stride]) / 2, rel=1e-15)
        most = max(float(noise * weight) for _, weight in truth)
        assert most <= widest[j] <= most + max(float(ROUNDING * weight) for _, weight in truth)


def test_parts_that_are_looked_at_together_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    times, values = samples(3, 200)
    whole = [divided_extremes(times, values, r, s, NOISE) for r in range(4) for s in (1, 8)]
    monkeypatch.setattr(divided, "_TOGETHER", 13)
    parts = [divided_extremes(times, values, r, s, NOISE) for r in range(4) for s in (1, 8)]
    for (found, widest), (again, wide) in zip(whole, parts, strict=True):
        np.testing.assert_array_equal(found, again)
        np.testing.assert_array_equal(widest, wide)


def test_of_windows_that_prove_the_same_the_first_is_named() -> None:
    times = np.arange(8.0)
    values = np.array([0.0, 2, 2, 4, 4, 5, 5, 4])[:, None]
    found, _ = divided_extremes(times, values, 1, 1, np.zeros(1))
    np.testing.assert_array_equal(found[0, :, 0], [-1.0, 2.0])
    np.testing.assert_array_equal(found[0, :, 2], [6.5, 0.5])


def test_what_overflows_proves_nothing() -> None:
    """A difference of 2e308 is no number; the window after it is one."""
    times = np.array([0.0, 1.0, 2.0])
    values = np.array([-1e308, 1e308, 9e307])[:, None]
    found, _ = divided_extremes(times, values, 1, 1, np.zeros(1))
    assert found[0, 0, 0] == pytest.approx(-1e307)
    assert np.isnan(found).sum() == 0


@pytest.mark.parametrize("order", range(1, 4))
def test_shaken_times_and_values_are_within_the_error(order: int) -> None:
    """Each at one end of its noise or the other, window by window in rationals."""
    rng = np.random.default_rng(order)
    clock, noise = 2e-4, np.array([0.0, 1e-5])
    for seed in range(20):
        times, values = samples(seed, order + 1)
        found, _ = divided_extremes(times, values, order, 1, noise, clock)
        for j in range(2):
            shifts = [rng.choice([-1.0, 1.0], order + 1) * x for x in (clock, noise[j])]
            t, q = (
                [Fraction(float(x)) + Fraction(float(d)) for x, d in zip(one, by, strict=True)]
                for one, by in zip((times, values[:, j]), shifts, strict=True)
            )
            truth = sum(
                x * factorial(order) / prod((a - b for b in t if b != a), start=Fraction(1))
                for a, x in zip(t, q, strict=True)
            )
            value, error, _ = found[j, 0]
            assert abs(truth - Fraction(float(value))) <= Fraction(float(error))
            assert error < 30 * np.abs(value) + 1


def test_samples_whose_order_is_not_known_prove_nothing() -> None:
    times, values = np.array([0.0, 1.0, 1.5]), np.array([[0.0], [1.0], [9.0]])
    found, widest = divided_extremes(times, values, 1, 1, np.zeros(1), 0.3)
    np.testing.assert_array_equal(found[0, 1, :1], [1.0])
    assert widest[0] == np.inf
