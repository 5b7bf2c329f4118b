"""Interpolations beside their exact ones, of the samples as they stand and of shaken ones."""

import dataclasses
import json
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from attacks.motion_files import DEGREES, through
from support.exact_motions import Row, derived, value
from trajgap.problem import Verdict
from trajgap.problem.motions import (
    HalfUnits,
    Interpolation,
    JointLimits,
    Samples,
    check_motion,
    check_samples,
    interpolated,
    read_motion,
)

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

    def moved(values, noise):
        shift = np.zeros(values.shape) if shaken is None else shaken.choice([-1.0, 1.0], 8) * noise
        return [Fraction(float(x)) + Fraction(float(d)) for x, d in zip(values, shift, strict=True)]

    times = moved(samples.time, samples.clock)
    columns = [moved(samples.given(r)[:, 0], samples.doubt(r)[0]) for r in range(3)]
    return through([Row(*x) for x in zip(times, zip(*columns, strict=True), strict=True)], how)


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


@pytest.mark.parametrize("how", [*DEGREES, "spline"])
@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("shaken", [False, True])
def test_bounds_hold_for_exact_and_for_shaken_samples(how, uneven, shaken):
    """Shaken: every sample at one end of its noise or the other, for a bound by signs to stand."""
    for seed in range(6):
        rng, plain = np.random.default_rng([seed, 7]), drawn(seed, uneven)
        noise = rng.choice([0.0, 1e-7, 1e-3], 4) * shaken
        halves = HalfUnits(
            noise[3] * float(np.diff(plain.time).min()), np.array(noise[:3])[:, None]
        )
        samples = dataclasses.replace(plain, rounding=halves) if shaken else plain
        for _ in range(3 if shaken else 1):
            motion = check_bounds(how, samples, exact(how, samples, rng if shaken else None))
        if not (uneven or shaken):
            assert np.abs(motion.error / np.array([1, 1e1, 1e3, 1e4])[:, None]).max() < 1e-11


@pytest.mark.parametrize("how", [*DEGREES, "spline"])
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


def test_lines_that_may_bend_within_their_noise_do_not_pass():
    """Rows on a line: exactly they pass, with noise their speed may jump, shaken or not."""
    time = np.arange(5.0)
    limits = JointLimits.from_values(("a",), velocity=2.0, acceleration=1.0)
    for shaken in (0.0, 5e-4):
        place = time[:, None] + shaken * np.array([0, 1, -1, 1, 0])[:, None]
        for noise in (0.0, 1e-3):
            line = Samples(("a",), time, place, noise=noise)
            found = check_motion(interpolated(line, Interpolation.LINEAR), limits)
            assert found.limits is Verdict.PASS
            if noise:
                assert found.verdict is Verdict.UNDECIDED
                assert "velocity of joint a may jump" in found.open[0]
                assert found.feasible_time is None
            else:
                assert found.verdict is (Verdict.DISCONTINUOUS if shaken else Verdict.PASS)


ROWS = "time,a,b,a velocity,b velocity\n"


@pytest.mark.parametrize(
    ("text", "time", "positions"),
    [
        # Fixed places: those of the column, though single numbers show fewer.
        ("time,a\n0.0,1\n0.25,1.125\n0.5,2.5\n", 5e-3, [5e-4]),
        # Significant digits: 123.456 is known to 5e-4, though 0.000123456 has nine places.
        ("time,a\n0.000001,123.456\n0.10001,0.000123456\n", 5e-6, [5e-4]),
        ("time,a\n0,1.5e-3\n1e-2,-2.25e1\n", 5e-3, [5e-2]),
        # Every digit of float64: no rounding but its own.
        ("time,a\n0.0,0.1\n0.30000000000000004,0.5\n", 0.0, [5e-2]),
        ("time,a\n0.0000000000000000e+00,1.0000000000000000e+00\n1,2\n", 0.0, [0.0]),
        # A column that never changes has the digits of its neighbours.
        ("time,a,b\n0.000,0,1.12345\n0.001,0,2.5\n", 5e-4, [5e-6, 5e-6]),
        ("time,a\n0.00,3\n0.01,3\n", 5e-3, [0.5]),
        ("0 1.5\n1 2.25\n# 3 4.123456\n", 0.5, [5e-3]),
        (ROWS + "0.000,1.0,2.00,0,0\n0.125,1.5,2.25,0,0\n", 5e-4, [5e-2, 5e-3]),
    ],
)
def test_half_a_unit_of_the_last_place(tmp_path, text, time, positions):
    (tmp_path / "m.csv").write_text(text)
    samples = read_motion(tmp_path / "m.csv").content
    assert samples.clock == pytest.approx(time, rel=1e-9)
    np.testing.assert_allclose(samples.margin, positions, rtol=1e-9)
    assert samples.clock >= time
    assert (samples.margin >= positions).all()


@pytest.mark.parametrize("form", [".4f", ".9f", ".7g", ".5e", ".17g", ".16e", ""])
def test_what_was_rounded_away_is_within_what_the_digits_say(tmp_path, form):
    rng = np.random.default_rng(len(form))
    time = np.cumsum(rng.uniform(0.1, 0.2, 3000))
    values = 10.0 ** rng.integers(-3, 3) * rng.normal(size=(3000, 2))
    rows = zip(time.tolist(), *values.T.tolist(), strict=True)
    text = "\n".join(",".join(format(x, form) if form else repr(x) for x in row) for row in rows)
    (tmp_path / "m.csv").write_text(text)
    samples = read_motion(tmp_path / "m.csv").content
    eps = 2.0**-52
    assert (np.abs(samples.time - time) <= samples.clock + eps * time).all()
    off = np.abs(samples.position - values)
    assert (off <= samples.margin + eps * np.abs(values)).all()
    assert samples.clock < 1e-3
    if form in (".17g", ".16e", ""):
        assert (samples.clock, *samples.margin) == (0.0, 0.0, 0.0)


def test_options_replace_what_the_digits_say(tmp_path):
    (tmp_path / "m.csv").write_text(ROWS + "0.000,1.0,2.00,0.5,0.5\n0.125,1.5,2.25,0.25,1.5\n")

    def read(*noise, **clock):
        return read_motion(tmp_path / "m.csv", ("deg",), *noise, **clock).content

    one = np.pi / 180
    digits, stated = read(), read((0.0, 0.1), time_noise=0.02)
    np.testing.assert_allclose(digits.rounding.of(1, 2), [5e-3 * one, 5e-2 * one])
    assert (stated.clock, digits.clock) == (0.02, pytest.approx(5e-4))
    np.testing.assert_allclose(stated.margin, [0.0, 0.1 * one])
    # 0 says that derivatives are exact too.
    np.testing.assert_allclose(stated.rounding.of(1, 2), [0.0, 5e-2 * one])
    assert read((0.0,), time_noise=0.0).assumed == ""
    assert "times to 0.02 s, positions to 0 to 0.00175 rad" in stated.assumed


def test_a_message_is_exact_for_its_controller_alone(tmp_path):
    points = [
        {"positions": [round(0.3 * k**2, 3)], "time_from_start": {"sec": k, "nanosec": 0}}
        for k in range(6)
    ]
    (tmp_path / "m.json").write_text(json.dumps({"joint_names": ["a"], "points": points}))
    samples = read_motion(tmp_path / "m.json").content
    assert (samples.clock, samples.margin[0]) == (pytest.approx(5e-10), pytest.approx(0.05))
    limits = JointLimits.from_values(("a",), velocity=2.71)
    given = check_motion(interpolated(samples, Interpolation.CONTROLLER), limits)
    assert given.limits is Verdict.PASS
    assert given.concluded[1:] == ()
    rounded = check_motion(interpolated(samples, Interpolation.LINEAR), limits)
    assert rounded.limits is Verdict.UNDECIDED


def smooth(rows):
    """A motion whose jerk is 16 rad/s³ at most, with six decimals of position and of time."""
    time = np.cumsum(np.random.default_rng(3).uniform(1.1e-3, 1.3e-3, rows)) - 1.1e-3
    place = np.column_stack([0.25 * np.sin(4 * time), 0.4 - 2 * np.cos(2 * time)])
    return "time,a,b\n" + "".join(
        f"{t:.6f},{x:.6f},{y:.6f}\n" for t, (x, y) in zip(time, place, strict=True)
    )


def test_a_motion_whose_samples_were_rounded_is_not_accused(tmp_path):
    """In the file the jerk of the spline is above 10⁴ rad/s³; that of the motion is 16."""
    (tmp_path / "m.csv").write_text(smooth(500))
    samples = read_motion(tmp_path / "m.csv").content
    limits = JointLimits.from_values(("a", "b"), jerk=17.0)
    for found in (
        check_samples(samples, limits),
        check_motion(interpolated(samples, Interpolation.SPLINE), limits),
    ):
        assert found.verdict is Verdict.UNDECIDED
        assert (found.stretch, found.feasible_time) == (1.0, None)
        assert "times to 5e-07 s, positions to 5e-07 rad" in found.concluded[1]
    assert found.worst.ratio > 100
    assert "Write more digits" in found.open[-1]
    # What every such motion breaks is still told, with a slow-down that noise has no part in.
    slow = check_samples(samples, JointLimits.from_values(("a", "b"), velocity=[2.0, 3.0]))
    assert slow.verdict is Verdict.VIOLATED
    speed = 4 * np.sin(2 * samples.time[-1])
    assert 0.995 * speed / 3 < slow.stretch < speed / 3
