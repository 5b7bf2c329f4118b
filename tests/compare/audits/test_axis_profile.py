"""Shortest profiles between two states, beside ruckig, closed forms and their own reversal."""

import math

import numpy as np
import pytest
from trajgap.compare.audits.axis_profile import (
    AxisProfile,
    AxisState,
    Sizes,
    shortest_s_curve,
    shortest_trapezoid,
)
from trajgap.compare.audits.common_times import FARTHEST, Axis, synchronised
from trajgap.compare.audits.named_profiles import double_s, fourth_order, jerk_impulses, s_curve


def by_ruckig(*axes: Axis) -> float | None:
    """The shortest common time by another library; None if it refuses the states or fails."""
    ruckig = pytest.importorskip("ruckig")
    asked = ruckig.InputParameter(len(axes))
    starts, goals, sizes = zip(*axes, strict=True)
    for name, states in (("current", starts), ("target", goals)):
        for quantity, values in zip(AxisState._fields, zip(*states, strict=True), strict=True):
            setattr(asked, f"{name}_{quantity}", values)
    for quantity in ("velocity", "acceleration", "jerk"):
        setattr(asked, f"max_{quantity}", [getattr(one, quantity) for one in sizes])
    found = ruckig.Trajectory(len(axes))
    try:
        result = ruckig.Ruckig(len(axes)).calculate(asked, found)
    except ruckig.RuckigError:
        return None
    except ValueError:  # it found the time, and no motion that takes it
        return None
    return float(found.duration) if result == ruckig.Result.Working else None


def drawn(rng: np.random.Generator, k: int) -> tuple[AxisState, AxisState, Sizes]:
    """States within the limits and, every few draws, at rest or outside them."""
    v, a, j = map(float, 10 ** rng.uniform(-1, 1, 3))
    first = (1.3 if k % 5 == 0 else 1) * (k % 7 > 0)
    share = rng.uniform(-1, 1, 4) * [first, k % 3 > 0, k % 4 > 0, k % 2]
    places = rng.normal(size=2) * 10 ** rng.uniform(-2, 1, 2)
    states = np.column_stack([places, share.reshape(2, 2) * [v, a]]).tolist()
    start, finish = (AxisState(*state) for state in states)
    return start, finish, Sizes(v, a, j)


def arrives(profile: AxisProfile, finish: AxisState) -> bool:
    end = profile.at(math.inf)
    return bool(np.allclose(end[:2], finish[:2], rtol=1e-6, atol=1e-6))


@pytest.mark.parametrize("count", [400, pytest.param(100_000, marks=pytest.mark.slow)])
def test_s_curves_between_random_states_take_ruckigs_time(count: int) -> None:
    rng = np.random.default_rng(31)
    compared = 0
    for k in range(count):
        start, finish, sizes = drawn(rng, k)
        truth, found = by_ruckig((start, finish, sizes)), shortest_s_curve(start, finish, sizes)
        assert (truth is None) == (found is None), (k, start, finish)
        if found is not None:
            compared += 1
            assert found.total_time == pytest.approx(truth, rel=1e-7, abs=1e-7), (k, start, finish)
            assert arrives(found, finish)
    assert compared > 0.8 * count


def test_reversed_trapezoids_swap_both_limits() -> None:
    """Played backwards, speeding up is slowing down."""
    rng = np.random.default_rng(32)
    for k in range(500):
        start, finish, sizes = drawn(rng, k)
        start, finish = start._replace(acceleration=0.0), finish._replace(acceleration=0.0)
        if abs(start.velocity) > sizes.velocity:
            continue
        braking = sizes._replace(own=float(rng.uniform(0.2, 3)) * sizes.acceleration)
        forth = shortest_trapezoid(start, finish, braking)
        swapped = braking._replace(acceleration=braking.braking, own=braking.acceleration)
        back = [s._replace(velocity=-s.velocity) for s in (finish, start)]
        again = shortest_trapezoid(back[0], back[1], swapped)
        assert arrives(forth, finish)
        assert forth.total_time == pytest.approx(again.total_time, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("profile", ["trapezoidal", "s-curve"])
@pytest.mark.parametrize("count", [60, pytest.param(10_000, marks=pytest.mark.slow)])
def test_axes_arrive_together_when_those_of_ruckig_do(profile: str, count: int) -> None:
    """Each keeps its limits on the way, also where it decides nothing."""
    rng = np.random.default_rng(33)
    compared = later = 0
    for k in range(count):
        axes: list[Axis] = []
        while len(axes) < 2 + k % 3:
            start, finish, sizes = drawn(rng, 1 + 2 * k + len(axes))
            if profile == "trapezoidal":
                start, finish = start._replace(acceleration=0.0), finish._replace(acceleration=0.0)
                sizes = sizes._replace(jerk=math.inf)
            if not axes:  # too near to stop there and go on, so that it cannot wait
                near = start.position + 0.3 * start.velocity * abs(start.velocity / sizes[1])
                finish = finish._replace(position=near, velocity=0.9 * start.velocity)
            if FARTHEST[profile](start, finish, sizes):
                axes.append((start, finish, sizes))
        truth, found = by_ruckig(*axes), synchronised(profile, axes)
        if truth is None:
            continue
        compared += 1
        later += truth > 1.001 * max(by_ruckig(axis) or 0.0 for axis in axes)
        for (start, finish, sizes), one in zip(axes, found, strict=True):
            assert one.total_time == pytest.approx(truth, rel=1e-7, abs=1e-7), (k, axes)
            assert arrives(one, finish)
            ahead = start.velocity + start.acceleration * abs(start.acceleration) / 2 / sizes.jerk
            inside = max(abs(start.velocity), abs(ahead)) <= sizes.velocity
            speeds = [abs(state.velocity) for state in one.corners]
            assert not inside or max(speeds) <= sizes.velocity * (1 + 1e-6)
    assert compared > 0.95 * count
    assert later > 0


def test_slowing_down_less_than_speeding_up() -> None:
    """It stops in 2 s at 5, and goes back 1 with 2 and 1: sqrt(2 (1/2 + 1)) = 3 sqrt(1/3)."""
    sizes = Sizes(4.0, 2.0, math.inf, 1.0)
    found = shortest_trapezoid(AxisState(3.0, 2.0), AxisState(4.0), sizes)
    assert found.total_time == pytest.approx(2 + 3 * math.sqrt(1 / 3))
    assert [round(p.time, 4) for p in found.phases if p.time] == [2.0, 0.5774, 1.1547]
    assert found.phases[0].acceleration == -1.0
    still = shortest_trapezoid(AxisState(5.0), AxisState(5.0), sizes)
    assert still.total_time == 0.0


def test_no_profile_ends_where_a_limit_was_exceeded_before() -> None:
    sizes, start = Sizes(1.0, 2.0, 4.0), AxisState(0.0)
    fast, earlier = AxisState(1.0, 1.5), AxisState(1.0, 0.9, -1.5)
    for finish in (fast, earlier, fast.mirrored(), earlier.mirrored()):
        assert shortest_s_curve(start, finish, sizes) is None
    for finish in (fast, fast.mirrored(), AxisState(1.0, -1.5)):
        assert shortest_trapezoid(start, finish, sizes) is None


def test_the_algorithm_of_the_book_is_not_the_shortest() -> None:
    """Examples 3.11 and 3.12: 8.9 and 52 % longer; from rest to rest it is the shortest."""
    sizes = Sizes(10.0, 10.0, 30.0)
    for speed, book, best in ((7.0, 1.93837, 1.78045), (7.5, 2.66667, 1.75422)):
        start = AxisState(0.0, speed)
        made = double_s(start, AxisState(10.0), sizes)
        shortest = shortest_s_curve(start, AxisState(10.0), sizes)
        assert arrives(made, AxisState(10.0))
        assert (round(made.total_time, 5), round(shortest.total_time, 5)) == (book, best)
        mirror = double_s(start.mirrored(), AxisState(-10.0), sizes)
        assert mirror.total_time == made.total_time
    for way in (0.5, 3.0, 40.0):
        made = double_s(AxisState(0.0), AxisState(way), Sizes(2.0, 4.0, 9.0))
        assert made.total_time == pytest.approx(s_curve(way, 2.0, 4.0, 9.0), rel=0.02)
        assert made.total_time >= s_curve(way, 2.0, 4.0, 9.0) - 1e-12


@pytest.mark.parametrize(("speed", "cruise"), [(0.01, 0.0), (0.2, 0.0), (0.8, 0.0), (0.8, 1.7)])
def test_a_fourth_order_profile_is_the_integral_of_its_speed(speed: float, cruise: float) -> None:
    limits = (0.8, 3.0, 20.0, 400.0)
    rise = shortest_s_curve(AxisState(0.0), AxisState(speed), Sizes(*limits[1:]))
    times = np.linspace(0.0, rise.total_time, 4001)
    passed = float(np.trapezoid([rise.at(float(t)).position for t in times], times))
    way, total = 2.0 * passed + speed * cruise, 2.0 * rise.total_time + cruise
    assert fourth_order(way, *limits) == pytest.approx(total, rel=1e-6)
    assert total > s_curve(way, *limits[:3])
    assert fourth_order(way, *limits[:3], 1e9) == pytest.approx(s_curve(way, *limits[:3]), rel=1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("ends", [((0.4, 7.0), (0.2, -9.0)), ((0.0, 0.0), (3.0, 5.0))])
def test_jerk_leads_from_state_to_state(sign: float, ends: tuple[tuple[float, float], ...]) -> None:
    """The jerk is integrated twice and thrice; a plateau of the other sign is never reached."""
    start = AxisState(0.5, *(sign * x for x in ends[0]))
    finish = AxisState(0.5 + sign * 2.0, *(sign * x for x in ends[1]))
    found = jerk_impulses(start, finish, Sizes(math.inf, 5.0, 90.0, sign * 1.5))
    moments = np.zeros(3)
    since = 0.0
    for phase in found.phases:
        share, weights = np.polynomial.legendre.leggauss(12)
        u, weights = (share + 1) / 2, weights / 2
        jerk = 64 * u**3 * (1 - u) ** 3 * 90.0 * np.sign(phase.jerk)
        left = found.total_time - since - u * phase.time
        moments += phase.time * np.array([(weights * jerk * left**k).sum() for k in range(3)])
        since += phase.time
    a, v, t = start.acceleration, start.velocity, found.total_time
    place = start.position + v * t + a * t**2 / 2 + moments[2] / 2
    reached = (place, v + a * t + moments[1], a + moments[0])
    assert reached == pytest.approx(finish, abs=1e-9)
    assert jerk_impulses(start, finish, Sizes(math.inf, 5.0, 90.0, sign * -1.5)) is None
    if not start.acceleration:
        assert jerk_impulses(start, finish, Sizes(math.inf, math.inf, 90.0, sign * 1.5)) is None
