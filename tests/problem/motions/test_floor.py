"""The floor between standstills, against closed forms; ruckig: `test_motion_written`."""

import math

import numpy as np
import pytest
from scipy.interpolate import PPoly
from trajgap.problem.motions import (
    Interpolation,
    JointLimits,
    Samples,
    as_motion,
    check_motion,
    interpolated,
    shortest,
)

INF = math.inf


@pytest.mark.parametrize(
    ("distance", "limits", "time"),
    [
        (3.0, (2.0, INF, INF), 1.5),
        (2.0, (INF, 8.0, INF), 1.0),  # 2√(d/A)
        (3.0, (2.0, 4.0, INF), 2.0),  # d/V + V/A
        (0.5, (INF, INF, 2.0), 4 * (0.5 / 4) ** (1 / 3)),  # (32 d/J)^⅓
        (10.0, (2.0, 4.0, 8.0), 10 / 2 + 2 / 4 + 4 / 8),
        (-10.0, (2.0, 4.0, 8.0), 6.0),
        (0.0, (1.0, 1.0, 1.0), 0.0),
        (1.0, (0.0, 1.0, 1.0), INF),
        (1.0, (INF, INF, INF), 0.0),
    ],
)
def test_known_times(distance, limits, time):
    assert shortest(distance, *limits) == pytest.approx(time, rel=1e-12)


def trip(stops, hold=0.0):
    """Rest-to-rest quintics of one second each between stops, with a pause at each."""
    time, q = [0.0], [stops[0]]
    for one in stops[1:]:
        time.append(time[-1] + 1.0)
        q.append(one)
        if hold:
            time.append(time[-1] + hold)
            q.append(one)
    zero = np.zeros((len(time), 2))
    samples = Samples(("1", "2"), time, np.array(q), zero, zero)
    return interpolated(samples, Interpolation.QUINTIC)


def test_the_floor_sums_over_standstills_and_waits_nowhere():
    limits = JointLimits.from_values(("1", "2"), 2.0, 8.0)
    stops = np.array([[0.0, 1.0], [1.0, 0.5], [0.5, 2.0]])
    floor = check_motion(trip(stops), limits).floor
    by_hand = max(shortest(1.0, 2, 8, INF), shortest(0.5, 2, 8, INF)) + shortest(1.5, 2, 8, INF)
    assert floor.time == pytest.approx(by_hand)
    assert (floor.stops, floor.waiting) == (3, 0.0)
    paused = check_motion(trip(stops, hold=0.3), limits).floor
    assert paused.time == pytest.approx(by_hand)
    assert paused.waiting == pytest.approx(0.6)
    assert paused.above == pytest.approx(2.6 / by_hand - 1)


def test_a_break_that_is_reached_at_speed_is_no_standstill():
    """1 rad to a wall at 2 rad/s, and on from rest: nobody says that a motion must stop there."""
    pieces = PPoly([[[0.0], [-2.0]], [[1.0], [3.0]], [[0.0], [0.0]], [[0.0], [1.0]]], [0, 1, 2])
    found = check_motion(as_motion(pieces, ("1",)), JointLimits.from_values(("1",), 9.0, 99.0))
    assert found.floor.time == pytest.approx(shortest(2.0, 9.0, 99.0, INF))


@pytest.mark.parametrize("side", ["lower", "upper", "braking"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_larger_side_counts(order, side):
    """A motion may be planned to the larger side: nothing shorter than the floor exists."""
    sizes = [2.0, 8.0, 60.0]
    even = JointLimits.from_values(("1", "2"), *sizes)
    given = {"lower": even.lower.copy(), "upper": even.upper.copy()}
    braking = even.deceleration
    if side == "braking":
        order, braking = 2, np.full(2, 1.7 * sizes[1])
    else:
        given[side][:, order] *= 1.7
    sizes[order - 1] *= 1.7
    stops = np.array([[0.0, 1.0], [1.0, 0.5]])
    found = check_motion(trip(stops), JointLimits(("1", "2"), **given, deceleration=braking))
    assert found.floor.time == pytest.approx(shortest(1.0, *sizes))


@pytest.mark.parametrize(
    ("speeds", "limited", "why"),
    [
        ((0.5, 0.0), {"velocity": 2.0}, "it is not shown that the motion starts at rest"),
        ((0.0, 0.5), {"velocity": 2.0}, "it is not shown that the motion ends at rest"),
        ((0.0, 0.0), {"position": (-5.0, 5.0)}, "only positions are limited"),
    ],
)
def test_why_there_is_no_floor(speeds, limited, why):
    samples = Samples(("1",), [0.0, 1.0], [[0.0], [1.0]], np.array(speeds)[:, None])
    motion = interpolated(samples, Interpolation.CUBIC)
    found = check_motion(motion, JointLimits.from_values(("1",), **limited))
    assert found.floor is None
    assert why in found.floor_why


def test_acceleration_at_a_standstill_leaves_jerk_out():
    # A cubic rest to rest has acceleration at its ends: with a limit of jerk alone its time says
    # nothing, and the floor must not claim the profile that begins without acceleration.
    samples = Samples(("1",), [0.0, 1.0], [[0.0], [1.0]], [[0.0], [0.0]])
    limits = JointLimits.from_values(("1",), acceleration=6.0, jerk=12.0)
    found = check_motion(interpolated(samples, Interpolation.CUBIC), limits)
    assert found.limits == "pass"
    assert found.floor.time == pytest.approx(shortest(1.0, INF, 6.0, INF))
    assert found.floor.time < 1.0 < shortest(1.0, INF, 6.0, 12.0)
