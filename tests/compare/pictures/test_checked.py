"""Pictures of a motion from elsewhere: red is what breaks a limit, orange what may."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from support.drawn import sound
from trajgap.compare.pictures.drawing import INK, ORANGE, RED, Picture, picture_bytes
from trajgap.compare.pictures.motion import checked_picture
from trajgap.compare.pictures.panels import POINTS, beyond, joined_stretches, thinned, without
from trajgap.problem import Array, Trajectory
from trajgap.problem.motions import (
    JointLimits,
    Motion,
    MotionCheck,
    Samples,
    check_motion,
    check_samples,
)

START = 2.5
"""s; a log seldom begins at 0."""


def swing(pieces: int = 5, seed: int = 3) -> Motion:
    """Cubics of two joints that go where chance leads them, one as far again as the other."""
    rng = np.random.default_rng(seed)
    breaks = START + np.concatenate([[0.0], np.cumsum(rng.uniform(0.5, 1.0, pieces))])
    scaled = rng.normal(0.0, 1.0, (pieces, 4, 2)) * [1.0, 2.0]
    none = np.zeros((pieces, 4, 2))
    return Motion(("one", "two"), breaks, scaled, none, "polynomials")


def held(motion: Motion, **values: object) -> JointLimits:
    return JointLimits.from_values(motion.joints, **values)  # type: ignore[arg-type]


def drawn(
    content: Motion | Samples, limits: JointLimits, tolerance: float = 1e-6
) -> tuple[Picture, MotionCheck, list[list[Axes]]]:
    if isinstance(content, Samples):
        found = check_samples(content, limits, tolerance)
    else:
        found = check_motion(content, limits, tolerance)
    picture = checked_picture(content, limits, found, title="Motion")
    grid = np.array(picture.axes).reshape(-1, 4)
    return picture, found, grid.tolist()


def spans(axes: Axes, colour: str) -> list[tuple[float, float]]:
    """Stretches that are shaded in a colour."""
    rgb = tuple(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    shaded = [p for p in axes.patches if p.get_facecolor()[:3] == pytest.approx(rgb)]
    return [(p.get_x(), p.get_x() + p.get_width()) for p in shaded]  # type: ignore[attr-defined]


def inside(stretches: list[tuple[float, float]], times: Array) -> Array:
    marked = np.zeros(times.size, dtype=bool)
    for start, end in stretches:
        marked |= (times >= start) & (times <= end)
    return marked


def far(stretches: list[tuple[float, float]], times: Array, off: float = 1e-3) -> Array:
    """Times that are not near the end of a stretch, where rounding decides."""
    ends = np.array([end for one in stretches for end in one] or [np.inf])
    return np.asarray((np.abs(times[:, None] - ends) > off).all(axis=1))


def test_what_breaks_a_limit_is_red_at_the_times_of_the_file() -> None:
    motion = swing()
    limits = held(motion, velocity=2.0, acceleration=[8.0, 9.0], jerk=20.0, position=(-1.0, 2.0))
    _, found, grid = drawn(motion, limits)
    assert found.verdict == "violated"
    times = np.linspace(motion.breaks[0], motion.breaks[-1], 4001)
    some = 0
    for j in range(2):
        for r in range(4):
            red = spans(grid[j][r], RED)
            values = motion(times, r)[:, j]
            low, high = limits.lower[j, r], limits.upper[j, r]
            over = (values < low) | (values > high)
            settled = far([*red, *((b, b) for b in motion.breaks)], times)
            assert (over == inside(red, times))[settled].all()
            some += int(over.any())
    assert some == 8
    assert not any(spans(axes, ORANGE) for row in grid for axes in row)


def test_the_marked_values_are_those_of_the_verdict() -> None:
    motion = swing()
    limits = held(motion, velocity=4.0, acceleration=[8.0, 90.0])
    _, found, grid = drawn(motion, limits)
    for peak in found.peaks:
        order = ("position", "velocity", "acceleration", "jerk").index(peak.quantity)
        axes = grid[motion.joints.index(peak.joint)][order]
        (mark,) = [a for a in axes.lines if a.get_marker() == "o"]
        assert mark.get_xydata().tolist() == [[peak.time, peak.value]]  # type: ignore[union-attr]
        assert mark.get_color() == (RED if peak.ratio > 1 else INK)
        assert f"of ±{abs(peak.limit):g}" in axes.get_title(loc="right")
        assert f", {100 * peak.ratio:.2f} %" in axes.get_title(loc="right")
    # Where nothing is limited, the largest value.
    jerks = np.abs(motion(0.5 * (motion.breaks[1:] + motion.breaks[:-1]), 3)[:, 1])
    assert grid[1][3].get_title(loc="right").lstrip("−") == f"{jerks.max():.4f}"


def test_a_deceleration_holds_while_the_speed_falls() -> None:
    motion = swing(seed=8)
    limits = held(motion, acceleration=3.0, deceleration=5.0)
    _, found, grid = drawn(motion, limits)
    times = np.linspace(motion.breaks[0], motion.breaks[-1], 4001)
    both = set()
    for j in range(2):
        speed, value = motion(times, 1)[:, j], motion(times, 2)[:, j]
        slowing = speed * value < 0
        over = np.abs(value) > np.where(slowing, 5.0, 3.0)
        red = spans(grid[j][2], RED)
        turns = times[:-1][speed[:-1] * speed[1:] < 0]
        settled = far([*red, *((t, t) for t in (*motion.breaks, *turns))], times, 3e-3)
        assert (over == inside(red, times))[settled].all()
        both |= set(slowing[over].tolist())
        worst = max(p.ratio for p in found.peaks if p.joint == motion.joints[j])
        assert f", {100 * worst:.{2 if worst < 10 else 0}f} %" in grid[j][2].get_title(loc="right")
        heights = {line.get_ydata()[0] for line in grid[j][2].lines if line.is_dashed()}  # type: ignore[index]
        assert heights == {-5.0, -3.0, 3.0, 5.0}
    assert both == {True, False}


def test_what_noise_leaves_open_is_orange() -> None:
    motion = swing()
    error = np.zeros_like(motion.error)
    error[:, 1] = 0.5
    motion = replace(motion, error=error, assumed="to 0.5 rad/s")
    _, _, grid = drawn(motion, held(motion, velocity=2.0))
    times = np.linspace(motion.breaks[0], motion.breaks[-1], 4001)
    for j in range(2):
        size = np.abs(motion(times, 1)[:, j])
        red, orange = (spans(grid[j][1], colour) for colour in (RED, ORANGE))
        settled = far([*red, *orange, *((b, b) for b in motion.breaks)], times, 0.02)
        assert (inside(red, times) == (size > 2.5))[settled].all()
        assert (inside(orange, times) == ((size > 1.5) & (size <= 2.5)))[settled].all()
        assert red
        assert orange


def test_a_tolerance_counts_as_kept() -> None:
    motion = swing()
    limits = held(motion, velocity=2.0)
    strict, loose = (drawn(motion, limits, one)[2][0][1] for one in (1e-6, 0.5))
    assert sum(b - a for a, b in spans(loose, RED)) < sum(b - a for a, b in spans(strict, RED))


def test_of_many_pieces_none_that_breaks_a_limit_is_missed() -> None:
    pieces = 3000
    time = START + np.linspace(0.0, 6.0, pieces + 1)
    scaled = np.zeros((pieces, 3, 1))
    scaled[:, 0, 0], scaled[:, 1, 0] = np.sin(time[:-1]), np.cos(time[:-1]) * np.diff(time)
    scaled[700, 2] = 2.4 * np.diff(time)[0]  # one piece is too fast, for 2 ms
    motion = Motion(("one",), time, scaled, np.zeros((pieces, 4, 1)), "polynomials")
    picture, found, grid = drawn(motion, held(motion, velocity=1.5, acceleration=1e4))
    piece, jump = spans(grid[0][1], RED)
    assert piece == pytest.approx((time[700], time[701]), abs=6.0 / POINTS)
    assert jump == (time[701], time[701])
    top = next(p for p in found.peaks if p.quantity == "velocity")
    curve = next(line for line in grid[0][1].lines if len(line.get_xdata()) > 100)
    assert np.nanmax(np.abs(curve.get_ydata())) == abs(top.value)
    assert len(curve.get_xdata()) < 2000
    assert len(sound(lambda: picture)) < 200_000


def test_leading_coefficients_that_are_rounding_do_no_harm() -> None:
    scaled = np.array([[[0.0], [1.0], [1e-320]], [[1.0], [-3.0], [0.0]]])
    trajectory = Trajectory(np.array([1.0, 2.0]), scaled, (2, 2))
    assert beyond(trajectory, 0, 0, -9.0, 0.25) == [(pytest.approx(0.25), pytest.approx(1.5))]
    open_all = beyond(trajectory, 0, 0, -9.0, 0.25, np.full(2, -np.inf))
    assert open_all == [pytest.approx((0.0, 3.0))]
    assert beyond(trajectory, 0, 0, -9.0, 0.25, np.full(2, np.inf)) == []


def test_a_deceleration_of_many_pieces() -> None:
    """Of many pieces the limit changes with the sign of their own speed."""
    pieces, h = 1000, 0.002
    speed = np.linspace(2.0, -2.0, pieces + 1)
    scaled = np.zeros((pieces, 3, 1))
    scaled[:, 1, 0], scaled[:, 2, 0] = h * speed[:-1], 0.5 * h * np.diff(speed)
    trajectory = Trajectory(np.full(pieces, h), scaled, (2,) * pieces)
    near = 2.0 / POINTS
    assert beyond(trajectory, 0, 2, -1.0, 1.0, 0.0, 3.0) == [pytest.approx((1.0, 2.0), abs=near)]
    assert beyond(trajectory, 0, 2, -3.0, 3.0, 0.0, 1.0) == [pytest.approx((0.0, 1.0), abs=near)]
    assert beyond(trajectory, 0, 2, -3.0, 3.0, 0.0, 3.0) == []


def test_jumps_are_faults_where_a_limit_makes_them_one() -> None:
    motion = swing()

    def red(limits: JointLimits, order: int) -> bool:
        return any(
            line.get_color() == RED and np.isnan(np.asarray(line.get_ydata(), dtype=float)).any()
            for line in drawn(motion, limits)[2][0][order].lines
        )

    assert red(held(motion, velocity=1e4), 1)
    assert not red(held(motion, velocity=1e4), 2)
    assert red(held(motion, velocity=1e4, jerk=1e6), 2)


def test_units_are_those_of_the_file() -> None:
    motion = swing()
    limits = held(motion, velocity=2.0)
    found = check_motion(motion, limits)
    picture = checked_picture(motion, limits, found, title="Motion", units=("deg", "mm"))
    grid = np.array(picture.axes).reshape(2, 4)
    assert [axes.get_ylabel() for axes in grid[:, 1]] == ["deg/s", "mm/s"]
    assert "joint two, position" in grid[1, 0].get_title(loc="left")
    heights = [{a.get_ydata()[0] for a in axes.lines if a.is_dashed()} for axes in grid[:, 1]]
    assert max(heights[0]) == pytest.approx(np.degrees(2.0))
    assert max(heights[1]) == pytest.approx(2000.0)


def test_samples_are_dots_with_what_neighbours_prove() -> None:
    time = START + np.linspace(0.0, 2.0, 41)
    position = np.column_stack([np.sin(time), 2 * np.sin(time)])
    samples = Samples(("one", "two"), time, position)
    limits = JointLimits.from_values(samples.joints, velocity=[1.5, 1.5], jerk=50.0)
    picture, found, grid = drawn(samples, limits)
    assert found.verdict == "violated"
    assert "every motion through the samples: violated" in str(picture._supxlabel.get_text())  # type: ignore[attr-defined]
    for j in range(2):
        dots = next(a for a in grid[j][1].lines if a.get_marker() == ".")
        middles = 0.5 * (time[1:] + time[:-1])
        np.testing.assert_allclose(dots.get_xdata(), middles)
        slopes = np.diff(position[:, j]) / np.diff(time)
        np.testing.assert_allclose(dots.get_ydata(), slopes, rtol=1e-12)
        assert dots.get_linestyle() == "None"
    assert not spans(grid[0][1], RED)
    over = np.abs(np.diff(position[:, 1]) / np.diff(time)) > 1.5
    assert (inside(spans(grid[1][1], RED), middles) == over).all()


def test_dots_that_say_nothing_of_a_limit_are_left_out() -> None:
    time = np.linspace(0.0, 1.0, 501)
    samples = Samples(("one",), time, np.sin(time)[:, None], noise=1e-3)
    _, _, grid = drawn(samples, JointLimits.from_values(("one",), velocity=2.0, jerk=10.0))
    speed, _, jerk = (next(a for a in grid[0][r].lines if a.get_marker() == ".") for r in (1, 2, 3))
    assert len(speed.get_xdata()) == 500  # known to within 1 rad/s
    assert len(jerk.get_xdata()) == 0
    assert spans(grid[0][1], ORANGE) == []


def test_samples_may_pass_the_smaller_of_acceleration_and_deceleration() -> None:
    time = np.linspace(0.0, 6.0, 61)
    samples = Samples(("one",), time, np.sin(time)[:, None])
    for sizes in ((0.5, 2.0), (2.0, 0.5)):
        limits = JointLimits.from_values(("one",), acceleration=sizes[0], deceleration=sizes[1])
        assert not spans(drawn(samples, limits)[2][0][2], RED)
    both = JointLimits.from_values(("one",), acceleration=0.5, deceleration=0.6)
    assert spans(drawn(samples, both)[2][0][2], RED)


def test_a_clock_that_tells_no_order_proves_nothing() -> None:
    time = np.linspace(0.0, 1.0, 11)
    samples = Samples(("one",), time, np.sin(9 * time)[:, None], time_noise=1.0)
    _, found, grid = drawn(samples, JointLimits.from_values(("one",), velocity=1.0))
    assert found.verdict == "undecided"
    assert not any(spans(axes, RED) for axes in grid[0])
    (dots,) = [a for a in grid[0][2].lines if a.get_marker() == "."]
    assert len(dots.get_xdata()) == 9  # nothing is limited there


def test_two_samples_have_no_jerk() -> None:
    samples = Samples(("one",), np.array([0.0, 1.0]), np.array([[0.0], [3.0]]))
    _, _, grid = drawn(samples, JointLimits.from_values(("one",), velocity=2.0, jerk=1.0))
    assert spans(grid[0][1], RED) == [(0.5, 0.5)]
    assert grid[0][3].get_title(loc="right") == ""


def test_stretches_are_joined_and_taken_away() -> None:
    assert joined_stretches([(0, 1), (1.05, 2), (3, 4)], 0.1) == [(0, 2), (3, 4)]
    assert without([(0, 10), (20, 20), (30, 31)], [(2, 3), (5, 9.95)], 0.1) == [
        (0, 2), (3, 5), (20, 20), (30, 31),
    ]  # fmt: skip
    assert without([(1, 2)], [(1, 2)], 0.0) == []


def test_thinning_keeps_every_extreme() -> None:
    rng = np.random.default_rng(1)
    values = rng.normal(size=20_000)
    values[1234] = 99.0
    times, kept = thinned(np.arange(20_000.0), values)
    assert times.size < 1000
    assert (times[kept.argmax()], kept.max()) == (1234.0, 99.0)
    assert (values[times.astype(int)] == kept).all()
    assert (times[0], times[-1]) == (0.0, 19_999.0)


def test_files_of_each_kind_are_the_same_each_time() -> None:
    motion = swing()
    picture = drawn(motion, held(motion, velocity=2.0))[0]
    for kind, head in (("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")):
        once = picture_bytes(picture, kind)
        assert once.startswith(head)
        assert picture_bytes(picture, kind) == once
