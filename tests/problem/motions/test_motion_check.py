"""The verdict on foreign motions against closed forms, scipy's roots and dense sampling."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, PPoly
from trajgap.problem import Limits, TrajgapError, Verdict
from trajgap.problem.motions import (
    HalfUnits,
    Interpolation,
    JointLimits,
    Motion,
    Samples,
    as_motion,
    check_motion,
    interpolated,
)
from trajgap.problem.motions.judged import MotionPeak, joined, judged, peak, slow_down

NAMES = ("shoulder", "elbow", "wrist")
WIDE = JointLimits.from_values(NAMES, 1e3, 1e3, 1e3, (-1e3, 1e3))
"""Limits that nothing here reaches: every peak is then reported."""


def test_the_same_way_so_many_times_slower_from_its_start():
    """Derivative r divides by factorʳ, and so does what it may be off by; digits are exact then."""
    rng, factor = np.random.default_rng(8), 2.5
    time, values = 7.0 + np.cumsum(rng.uniform(0.2, 0.5, 6)), rng.normal(size=(3, 6, 2))
    samples = Samples(("a", "b"), time, *values, rounding=HalfUnits(1e-4, np.full((3, 1), 1e-3)))
    slow = samples.slowed(factor)
    np.testing.assert_allclose(slow.time, time[0] + factor * (time - time[0]))
    for order in range(3):
        np.testing.assert_allclose(slow.given(order), values[order] / factor**order)
    assert (samples.clock, slow.clock, *slow.margin) == (1e-4, 0.0, 0.0, 0.0)
    one = interpolated(samples, Interpolation.QUINTIC)
    other = one.slowed(factor)
    at = rng.uniform(time[0], time[-1], 50)
    for order in range(4):
        there = other(time[0] + factor * (at - time[0]), order)
        np.testing.assert_allclose(there, one(at, order) / factor**order, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(other.error[:, order], one.error[:, order] / factor**order)


def test_jumps_are_reported_with_place_and_number():
    zigzag = Samples(("1",), [0.0, 1.0, 2.0, 4.0], [[0.0], [1.0], [0.0], [-6.0]])
    motion = interpolated(zigzag, Interpolation.LINEAR)
    found = check_motion(motion, JointLimits.from_values(("1",), velocity=5.0))
    assert (found.verdict, found.limits) == (Verdict.DISCONTINUOUS, Verdict.PASS)
    (jump,) = [one for one in found.jumps if one.quantity == "velocity"]
    assert (jump.count, jump.time, jump.size) == (2, 1.0, -2.0)
    assert found.feasible_time is None


@pytest.mark.parametrize("sides", [(), (0,), (1,), (0, 1)])
def test_a_jump_of_acceleration_counts_where_jerk_is_limited_on_any_side(sides):
    samples = Samples(("1",), [0.0, 1.0, 2.0], [[0.0], [1.0], [0.0]], [[0.0], [0.0], [1.0]])
    limits = JointLimits.from_values(("1",), acceleration=99.0)
    ends = np.stack([limits.lower, limits.upper])
    for side in sides:
        ends[side, 0, 3] = (-999.0, 999.0)[side]
    motion = interpolated(samples, Interpolation.CUBIC)
    found = check_motion(motion, JointLimits(("1",), *ends, limits.deceleration))
    assert found.verdict is (Verdict.DISCONTINUOUS if sides else Verdict.PASS)


def test_the_nearer_side_is_shown_with_the_bounds_of_both():
    for one, other in np.random.default_rng(2).uniform(0.5, 1.5, (30, 2, 3)):
        ratios = [dict(zip(("least_ratio", "ratio", "most_ratio"), x)) for x in (one, other)]  # noqa: B905
        found = joined([MotionPeak("1", "jerk", 0.0, 1.0, 1.0, source="", **x) for x in ratios])
        largest = np.maximum(one, other).tolist()
        assert [found.least_ratio, found.ratio, found.most_ratio] == largest


@pytest.mark.parametrize(
    ("least", "most", "why"),
    [(1.1, 1.3, "is exceeded"), (0.9, 1.3, "may be exceeded"), (0.8, 0.9, None)],
)
def test_going_slower_does_not_move_the_path(least, most, why):
    position = MotionPeak("1", "position", 0.0, 1.0, 1.0, 0.9 * most, least, most, "")
    factor, said = slow_down([position], 1e-6)
    assert factor == 1.0
    assert said == (why and f"a position limit {why}, and slowing down does not change the path")


@pytest.mark.parametrize("power", [-300, -40, 0, 40, 300])
def test_the_verdict_does_not_depend_on_the_unit_of_positions(power):
    """Powers of 2 change no digit, so they change no verdict, as long as nothing overflows."""
    rng = np.random.default_rng(7)
    c, unit = rng.normal(size=(6, 5, 3)), 2.0**power
    breaks = np.cumsum(rng.uniform(0.1, 1.0, 6))
    plain, scaled = (as_motion(PPoly(one * c, breaks), NAMES) for one in (1.0, unit))
    sizes = [abs(peak.value) for peak in check_motion(plain, WIDE).peaks]
    near = np.array(sizes).reshape(3, 4) * rng.choice([0.9, 1.1], (3, 4))

    def found(motion, by):
        position, *others = (by * near).T
        return check_motion(motion, JointLimits.from_values(NAMES, *others, (-position, position)))

    one, other = found(plain, 1.0), found(scaled, unit)
    assert (one.limits, one.not_judged) == (other.limits, ())
    for a, b in zip(one.peaks, other.peaks, strict=True):
        if a.quantity != "position":
            assert (a.ratio, a.least_ratio, a.most_ratio) == (b.ratio, b.least_ratio, b.most_ratio)


@pytest.mark.parametrize(("value", "error"), [(np.nan, 0.0), (np.inf, 0.0), (0.5, np.nan)])
def test_what_is_no_number_is_neither_kept_nor_broken(value, error):
    limits = JointLimits.from_values(("a",), velocity=1.0)
    reached = (value, value - error, value + error)
    one = peak(limits, 0, "velocity", 0.0, reached, 1.0, 1, None)
    assert (one.least_ratio, one.most_ratio) == (0.0, np.inf)
    assert judged([one], 0.0) is Verdict.UNDECIDED


def test_what_is_not_judged_stands_beside_the_verdict():
    motion = as_motion(PPoly([[[1.0] * 3]], [0.0, 1.0]), NAMES)
    found = check_motion(motion, JointLimits.from_values(NAMES, velocity=[1.0, np.inf, 2.0]))
    assert found.verdict is Verdict.PASS
    said = "; not judged: position, acceleration and jerk, no limit stated"
    assert str(found).splitlines()[0].endswith(said)
    assert "not judged" not in str(check_motion(motion, WIDE))


def test_a_b_spline_is_read_from_its_interval():
    inner = BSpline(np.arange(12.0), np.random.default_rng(3).normal(size=(8, 3)), 3)  # 3 to 8
    motion = as_motion(inner, NAMES)
    assert motion.breaks.tolist() == [3, 4, 5, 6, 7, 8]
    times = np.linspace(3.01, 7.99, 301)
    for order in range(3):
        np.testing.assert_allclose(motion(times, order), inner(times, nu=order), atol=1e-9)
    assert check_motion(motion, WIDE).jumps == ()


def test_limits_of_a_problem_imply_those_of_the_motion_and_keep_each_side():
    limits = JointLimits(
        ("1", "2"),
        np.array([[-1.0, -2.0, -3.0, -np.inf], [-2.0, -1.0, -6.0, -7.0]]),
        np.array([[2.0, 1.5, 4.0, np.inf], [3.0, 4.0, 5.0, 6.0]]),
        np.array([np.inf, 4.5]),
        {("1", "jerk"): "the test"},
    )
    plain, own = limits.symmetric, limits.two_sided
    np.testing.assert_array_equal(plain.derivatives, [[1.5, 3.0, np.inf], [1.0, 4.5, 6.0]])
    np.testing.assert_array_equal(own.ends("velocity"), [[-2.0, -1.0], [1.5, 4.0]])
    # The deceleration of joint 2 counts while it slows down, in either direction.
    np.testing.assert_array_equal(own.ends("acceleration"), [[-3.0, -4.5], [4.0, 4.5]])
    np.testing.assert_array_equal(own.ends("jerk"), [[-np.inf, -7.0], [np.inf, 6.0]])
    np.testing.assert_array_equal(own.position_upper, [2.0, 3.0])
    for one in (plain, own):
        assert isinstance(one, Limits)
        back = JointLimits.of(one, ("1", "2"))
        assert (back.lower >= limits.lower).all()
        assert (back.upper <= limits.upper).all()
    np.testing.assert_array_equal(
        [back.lower[0], back.upper[0]], [limits.lower[0], limits.upper[0]]
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Motion.of_polynomial(PPoly([[1.0]], [0.0, 1.0]), ("a", "b")), "2 names for 1"),
        (lambda: Motion.of_polynomial(PPoly(np.ones((11, 1)), [0.0, 1.0])), "at most 9"),
        (lambda: Motion.of_polynomial(PPoly([[np.inf]], [0.0, 1.0])), "not finite"),
        (lambda: Motion.of_polynomial(PPoly([[1j]], [0.0, 1.0])), "complex"),
        (
            lambda: Motion.of_polynomial(PPoly([[1.0]], [1e9, 1e9 + 1e-6])),
            "too small for the digits",
        ),
        (lambda: Samples(("a",), [0.0, 1.0, 1.0], [[1.0], [2.0], [3.0]]), "times must increase"),
        (lambda: Samples(("a",), [0.0], [[1.0]]), "needs 2"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], [np.nan]]), "joint a in sample 2"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], ["x"]]), "not numbers"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], [2.0]], [[1.0]]), "shape"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], [2.0]], noise=-1.0), "noise"),
        (lambda: Samples(("a", "a"), [0.0, 1.0], np.ones((2, 2))), "twice"),
        (lambda: Samples(("a",), [0.0, np.inf], [[1.0], [2.0]]), "not finite"),
        (lambda: check_motion(as_motion(PPoly([[1.0]], [0.0, 1.0])), WIDE), "in that order"),
        (lambda: as_motion(object()), "not a motion known"),
        (lambda: JointLimits.from_values(("a",), np.nan), "NaN"),
        (lambda: JointLimits.from_values(("a",), 1e101), "beyond 1e.100; write inf"),
        (lambda: JointLimits.from_values(("a",), 1, 1, deceleration=1e101), "beyond 1e.100"),
        (lambda: JointLimits.from_values(("a",), 1e-101), "below 1e-100; write 0"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], [2.0]], noise=1e101), "noise"),
        (lambda: Motion.of_polynomial(PPoly([[1e101]], [0.0, 1.0])), "by more than 1e.100"),
        (lambda: Samples(("a",), [0.0, 1.0], [[1.0], [1e101]]), "beyond 1e.100"),
        (lambda: JointLimits.from_values(("a",), position=(2.0, 1.0)), "lies above"),
        (lambda: JointLimits.from_values(("a",), deceleration=-1.0), "0 or more"),
    ],
)
def test_what_is_no_motion_is_refused(make, message):
    with pytest.raises(TrajgapError, match=message):
        make()


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ("none", "not a motion"),
        ("cubic", "sample 1 has no velocity"),
        ("quintic", "sample 1 has no velocity"),
        ("spline", "needs 4"),
    ],
)
def test_an_interpolation_needs_its_data(how, message):
    with pytest.raises(TrajgapError, match=message):
        interpolated(Samples(("a",), [0.0, 1.0], [[1.0], [2.0]]), Interpolation(how))
