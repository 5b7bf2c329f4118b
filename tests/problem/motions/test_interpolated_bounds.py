"""Interpolations beside their exact ones, of the samples as they stand and of shaken ones."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from support.exact_motions import Row, derived, hermite, spline, value
from trajgap.problem import Verdict
from trajgap.problem.motions import (
    HalfUnits,
    Interpolation,
    JointLimits,
    Samples,
    check_motion,
    interpolated,
)

DEGREE = {"linear": 1, "cubic": 3, "quintic": 5}
EPS = Fraction(2.0**-52)


def drawn(seed: int, uneven: bool) -> Samples:
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.2, 0.5, 7)
    if uneven:
        steps[int(rng.integers(7))] *= 10.0 ** -int(rng.integers(2, 6))
    time = np.append(0.0, np.cumsum(steps)) + float(rng.choice([0.0, 40.0]))
    return Samples(("a",), time, *(3.0 + rng.normal(size=(3, 8, 1))))


def exact(how: str, samples: Samples, shaken: np.random.Generator | None):
    """The exact curve of the samples; of others within their noise if they are shaken."""

    def moved(numbers, noise):
        shift = np.zeros(numbers.shape) if shaken is None else shaken.choice([-1.0, 1.0], 8) * noise
        return [
            Fraction(float(x)) + Fraction(float(d)) for x, d in zip(numbers, shift, strict=True)
        ]

    times = moved(samples.time, samples.clock)
    columns = [moved(samples.given(r)[:, 0], samples.doubt(r)[0]) for r in range(3)]
    if how == "spline":
        return spline(times, columns[0])
    return hermite(
        [Row(*x) for x in zip(times, zip(*columns, strict=True), strict=True)], DEGREE[how]
    )


def check_bounds(how, samples, curve):
    """At the same share of every piece the exact derivatives are within the bounds."""
    motion = interpolated(samples, Interpolation(how))
    for k, (begin, end) in enumerate(pairwise(curve.breaks)):
        h, own = end - begin, Fraction(float(motion.durations[k]))
        c = [Fraction(float(x)) for x in motion.scaled[k, :, 0]]
        for order in np.flatnonzero(np.isfinite(motion.error[k, :, 0])).tolist():
            for share in map(Fraction, (0.0, 0.125, 0.5, 0.875, 1.0)):
                true = value(derived(curve.pieces[k], order), share * h)
                found = value(derived(c, order), share) / own**order
                # What the durations of float64 change is part of the bound, their use is not.
                bound = Fraction(float(motion.error[k, order, 0])) + 8 * EPS * abs(found)
                assert abs(true - found) <= bound, (how, k, order, share)
    return motion


@pytest.mark.parametrize("how", [*DEGREE, "spline"])
@pytest.mark.parametrize("uneven", [False, True])
def test_exact_samples(how, uneven):
    for seed in range(8):
        samples = drawn(seed, uneven)
        motion = check_bounds(how, samples, exact(how, samples, None))
        if not uneven:
            sizes = np.abs(motion.error / np.array([1, 1e1, 1e3, 1e4])[:, None])
            assert sizes.max() < 1e-11


@pytest.mark.parametrize("how", [*DEGREE, "spline"])
@pytest.mark.parametrize("uneven", [False, True])
def test_shaken_samples(how, uneven):
    """Every sample at one end of its noise or the other: what a bound by signs has to stand."""
    for seed in range(12):
        rng = np.random.default_rng([seed, 7])
        plain = drawn(seed, uneven)
        noise = rng.choice([0.0, 1e-7, 1e-3], 4)
        step = float(np.diff(plain.time).min())
        rounding = HalfUnits(noise[3] * step, np.array(noise[:3])[:, None])
        samples = Samples(
            ("a",), plain.time, plain.position, plain.velocity, plain.acceleration,
            rounding=rounding,
        )  # fmt: skip
        for _ in range(3):
            check_bounds(how, samples, exact(how, samples, rng))


@pytest.mark.parametrize("how", ["linear", "cubic", "quintic", "spline"])
def test_times_that_noise_may_swap_bound_nothing(how):
    samples = drawn(1, False)
    step = float(np.diff(samples.time).min())
    blurred = Samples(
        ("a",), samples.time, samples.position, samples.velocity, samples.acceleration,
        time_noise=step,
    )  # fmt: skip
    motion = interpolated(blurred, Interpolation(how))
    found = check_motion(motion, JointLimits.from_values(("a",), velocity=1e-3))
    assert np.isinf(motion.error).any()
    assert found.limits is not Verdict.PASS
    assert found.feasible_time is None


def test_a_spline_through_two_near_samples_does_not_pass():
    """One cubic through four samples, two of them 1.6e-7 s apart: |a| reaches 0.15481 rad/s²."""
    time = [0.0, 0.04087067573392611, 0.0408708316722213, 0.1550835580000704]
    q = [[0.0], [0.040859298205440854], [0.04085945401351307], [0.1544626550196691]]
    samples = Samples(("a",), time, q)
    curve = spline(*([Fraction(float(x)) for x in np.ravel(one)] for one in (time, q)))
    peak = float(max(abs(x) for x in curve.ranges[2]))
    assert peak == pytest.approx(0.15481, rel=1e-4)
    motion = interpolated(samples, Interpolation.SPLINE)
    for limit, never in ((0.1535, Verdict.PASS), (peak * 1.01, Verdict.VIOLATED)):
        found = check_motion(motion, JointLimits.from_values(("a",), acceleration=limit))
        assert found.verdict is not never
        assert found.peaks[0].least_ratio * limit <= peak <= found.peaks[0].most_ratio * limit


def test_lines_that_may_bend_within_their_noise_do_not_pass():
    """Rows on a line: exactly they pass, with noise their speed may jump."""
    time = np.arange(5.0)
    limits = JointLimits.from_values(("a",), velocity=2.0, acceleration=1.0)

    def verdict(noise):
        line = Samples(("a",), time, time[:, None], noise=noise)
        return check_motion(interpolated(line, Interpolation.LINEAR), limits)

    assert verdict(0.0).verdict is Verdict.PASS
    noisy = verdict(1e-3)
    assert (noisy.verdict, noisy.limits) == (Verdict.UNDECIDED, Verdict.PASS)
    assert "velocity of joint a may jump" in noisy.open[0]
    assert noisy.feasible_time is None
