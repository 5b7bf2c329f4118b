"""What samples prove without interpolation: never a false accusation, and sharp where it can be."""

from fractions import Fraction
from math import factorial, prod

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from trajgap.problem import Array, TrajgapError, Verdict
from trajgap.problem.motions import JointLimits, Samples, check_samples, divided
from trajgap.problem.motions.divided import divided_extremes, neighbours

NAMES = ("1", "2")


def waves(rng, count=4):
    """A smooth motion with its derivatives, and rigorous bounds of each."""
    size, speed = rng.uniform(0.1, 2.0, (2, count)), rng.uniform(0.3, 9.0, (2, count))
    phase = rng.uniform(0, 6, (2, count))

    def value(t, order):
        turn = speed * t[:, None, None] + phase + order * np.pi / 2
        return (size * speed**order * np.sin(turn)).sum(axis=2)

    dense = np.linspace(0.0, 6.0, 20_001)
    steps = 6.0 / 20_000 / 2
    bounds = [
        np.abs(value(dense, r)).max(axis=0) + steps * (size * speed ** (r + 1)).sum(axis=1)
        for r in range(4)
    ]
    return value, bounds


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_a_motion_that_keeps_its_limits_is_never_accused(seed):
    rng = np.random.default_rng(seed)
    value, bounds = waves(rng)
    rows = int(rng.integers(2, 400))
    time = np.sort(rng.uniform(0.0, 6.0, rows)) + float(rng.choice([0.0, 1e3]))
    time = time[np.append(True, np.diff(time) > 1e-7)]
    if time.size < 2:
        return
    from_start = time - (1e3 if time[0] > 100 else 0.0)
    noise = float(rng.choice([0.0, 1e-9, 1e-4, 1e-2]))
    q = value(from_start, 0) + noise * rng.uniform(-1, 1, (time.size, 2))
    more = [value(from_start, r) if rng.random() < 0.5 else None for r in (1, 2)]
    limits = JointLimits.from_values(
        NAMES, *(b * (1 + 1e-6) for b in bounds[1:]), (-bounds[0], bounds[0])
    )
    # Times that were shifted are rounded: what they stand for is off by their last digit.
    found = check_samples(Samples(NAMES, time, q, *more, noise=noise + 2e-12), limits)
    assert found.verdict is Verdict.UNDECIDED
    assert found.stretch == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(("order", "word"), [(1, "velocity"), (2, "acceleration"), (3, "jerk")])
def test_dense_samples_prove_a_violation_that_is_there(order, word):
    rng = np.random.default_rng(order)
    value, _ = waves(rng)
    time = np.linspace(0.0, 6.0, 20_001)
    peak = np.abs(value(time, order)).max(axis=0)
    sizes = [np.inf] * 3
    sizes[order - 1] = 0.999 * peak.min()
    it = check_samples(Samples(NAMES, time, value(time, 0)), JointLimits.from_values(NAMES, *sizes))
    assert it.verdict is Verdict.VIOLATED
    assert it.worst.quantity == word
    assert it.worst.ratio == pytest.approx(peak.max() / sizes[order - 1], rel=2e-3)
    assert it.stretch == pytest.approx((peak.max() / sizes[order - 1]) ** (1 / order), rel=2e-3)
    assert it.feasible_time is None


def test_noise_is_averaged_over_wider_windows():
    time = np.linspace(0.0, 4.0, 4001)
    q = 1.3 * time[:, None] + 1e-3 * np.random.default_rng(5).uniform(-1, 1, (4001, 1))
    for noise, limit, verdict in (
        (1e-3, 1.28, Verdict.VIOLATED),  # neighbours alone would allow 1.3 ± 2
        (0.0, 1.6, Verdict.VIOLATED),  # of the noise, which was not stated
        (1e-3, 1.6, Verdict.UNDECIDED),
    ):
        limits = JointLimits.from_values(("1",), velocity=limit)
        assert check_samples(Samples(("1",), time, q, noise=noise), limits).verdict is verdict


def test_stated_derivatives_are_judged_themselves():
    v = np.array([[0.0], [2.5], [0.0]])
    samples = Samples(("1",), np.array([0.0, 1.0, 2.0]), np.zeros((3, 1)), v)

    def found(**limits):
        return check_samples(samples, JointLimits.from_values(("1",), **limits))

    speed = found(velocity=2.0)
    assert (speed.verdict, speed.worst.value, speed.worst.time) == (Verdict.VIOLATED, 2.5, 1.0)
    assert abs(found(acceleration=2.4).worst.value) == pytest.approx(2.5)
    assert found(acceleration=2.6).worst.ratio == pytest.approx(2.5 / 2.6)


def test_limits_are_of_the_same_joints():
    with pytest.raises(TrajgapError, match="given for joints 1, the motion has 2; give them in"):
        check_samples(
            Samples(("2",), [0.0, 1.0], [[0.0], [1.0]]), JointLimits.from_values(("1",), 1.0)
        )


def test_rows_without_derivatives_are_left_out():
    v = np.array([[1.0], [np.nan], [3.0]])
    samples = Samples(("1",), [0.0, 1.0, 2.0], np.zeros((3, 1)), v)
    found = check_samples(samples, JointLimits.from_values(("1",), acceleration=0.9))
    assert found.worst.value == pytest.approx(1.0)  # (3 − 1)/2


def test_no_motion_may_pass_both_acceleration_and_deceleration():
    time = np.linspace(0.0, 2.0, 5)
    samples = Samples(("1",), time, 2.5 * time[:, None] ** 2)  # a = 5
    both = JointLimits.from_values(("1",), acceleration=3.0, deceleration=6.0)
    assert check_samples(samples, both).verdict is Verdict.UNDECIDED
    less = JointLimits.from_values(("1",), acceleration=3.0, deceleration=4.0)
    assert check_samples(samples, less).verdict is Verdict.VIOLATED


NOISE = np.array([0.0, 3e-4])
ROUNDING = Fraction(1, 10**10)
"""Of values up to 45 at times with steps of 1e-2: what the error may have beyond the noise."""


def samples(seed: int, count: int = 23) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    times = 7.0 + np.cumsum(rng.uniform(0.01, 0.3, count))
    return times, rng.normal(size=(count, 2)) + np.array([5.0, -40.0])


def exact(times: list[Fraction], values: list[Fraction], order: int, stride: int):
    """Of each window the order-th derivative and the sum of its absolute weights, in rationals."""
    for k in range(len(times) - order * stride):
        t, q = (one[k::stride][: order + 1] for one in (times, values))
        shares = [
            factorial(order) / prod((a - b for b in t if b != a), start=Fraction(1)) for a in t
        ]
        value = sum((w * x for w, x in zip(shares, q, strict=True)), Fraction(0))
        yield value, sum(map(abs, shares), Fraction(0))


def rational(numbers: Array, shift: Array | None = None) -> list[Fraction]:
    """Numbers as they are in binary, each moved by its shift."""
    by = np.zeros(numbers.shape) if shift is None else shift
    return [Fraction(x) + Fraction(d) for x, d in zip(numbers.tolist(), by.tolist(), strict=True)]


@pytest.mark.parametrize("order", range(4))
@pytest.mark.parametrize("stride", [1, 2, 5])
def test_the_window_that_proves_most_and_its_error(order: int, stride: int) -> None:
    times, values = samples(10 * order + stride)
    found, widest = divided_extremes(times, values, order, stride, NOISE)
    for j, noise in enumerate(map(Fraction, NOISE.tolist())):
        truth = list(exact(rational(times), rational(values[:, j]), order, stride))
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
    """A difference of 2e308 is not a number; the window after it is one."""
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
            t, q = (
                rational(one, by * rng.choice([-1.0, 1.0], order + 1))
                for one, by in ((times, clock), (values[:, j], noise[j]))
            )
            ((truth, _),) = exact(t, q, order, 1)
            value, error, _ = found[j, 0]
            assert abs(truth - Fraction(float(value))) <= Fraction(float(error))
            assert error < 30 * np.abs(value) + 1


def test_samples_whose_order_is_not_known_prove_nothing() -> None:
    times, values = np.array([0.0, 1.0, 1.5]), np.array([[0.0], [1.0], [9.0]])
    found, widest = divided_extremes(times, values, 1, 1, np.zeros(1), 0.3)
    np.testing.assert_array_equal(found[0, 1, :1], [1.0])
    assert widest[0] == np.inf


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_what_neighbours_prove_is_reached_within_their_window(order):
    """The mean value theorem, by a dense look at the true motion, whatever columns are there."""
    rng = np.random.default_rng(order)
    value, _ = waves(rng)
    time = np.cumsum(rng.uniform(0.02, 0.04, 40))
    shaken = value(time, 0) + rng.uniform(-1e-6, 1e-6, (40, 2))
    for columns in ({}, {"velocity": value(time, 1)}):
        samples = Samples(("a", "b"), time, shaken, noise=1e-6, **columns)
        middles, found, errors = neighbours(samples, order)
        steps = max(0, order - len(columns))
        np.testing.assert_allclose(middles, 0.5 * (time[: 40 - steps] + time[steps:]))
        if not steps and order:
            assert errors.max() < 1e-12  # velocities are not as noisy as positions
        for k, at in enumerate(middles):
            dense = value(np.linspace(at - 0.07, at + 0.07, 400), order)
            off = errors[k] + 1e-3 * np.ptp(dense, axis=0)
            assert (found[k] >= dense.min(axis=0) - off).all()
            assert (found[k] <= dense.max(axis=0) + off).all()
