"""Linear segments with parabolic blends, against Craig's example and motions integrated in time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from trajgap.compare.audits.parabolic_blends import (
    Between,
    Blended,
    EndBlends,
    by_blend_accelerations,
    by_blend_times,
)
from trajgap.compare.audits.rounding import RoundingBox

Array = NDArray[np.float64]


def exact(*numbers: float) -> RoundingBox:
    return RoundingBox.exact(np.array(numbers, dtype=np.float64))


def column(*angles: float) -> RoundingBox:
    return RoundingBox.exact(np.array(angles, dtype=np.float64)[:, None])


def test_the_example_of_craig() -> None:
    """Introduction to Robotics, example 7.3: 10, 35, 25, 10° in 2, 1, 3 s with 50 °/s².

    The book rounds the first blend to 0.27 s and the speed to 13.50; its straight parts take
    1.50 and 2.849 s.
    """
    found = by_blend_accelerations(
        column(10, 35, 25, 10), exact(2, 1, 3), exact(50), EndBlends.WITHIN
    )
    speeds = found.velocity.low[:, 0]
    assert speeds == pytest.approx([13.40, -10.0, -5.09], abs=0.005)
    assert speeds[0] / 50 == pytest.approx(0.27, abs=0.005)
    assert (speeds[0] - speeds[1]) / 50 == pytest.approx(0.47, abs=0.005)
    assert found.room.low[[0, 2], 0] == pytest.approx([1.50, 2.849], abs=0.005)


def moved(points: Array, durations: Array, blends: Array, ends: EndBlends) -> Array:
    """Where the motion ends that speeds up and down as its description says, from the start."""
    found = by_blend_times(column(*points), exact(*durations), exact(*blends), ends)
    speeds = np.concatenate([[0.0], found.velocity.low[:, 0], [0.0]])
    at = points[0]
    for k, tau in enumerate(blends):
        at += 0.5 * (speeds[k] + speeds[k + 1]) * tau
        if k < len(durations):
            at += speeds[k + 1] * found.room.low[k, 0]
    assert found.acceleration.low[:, 0] * blends == pytest.approx(np.abs(np.diff(speeds)))
    return np.array([at])


@given(
    st.lists(st.floats(-3, 3), min_size=2, max_size=5),
    st.data(),
    st.sampled_from(list(EndBlends)),
)
def test_such_a_motion_ends_at_the_last_way_point(
    points: list[float], data: st.DataObject, ends: EndBlends
) -> None:
    n = len(points) - 1
    h = np.array(data.draw(st.lists(st.floats(1.0, 3.0), min_size=n, max_size=n)))
    tau = np.array(data.draw(st.lists(st.floats(0.05, 0.45), min_size=n + 1, max_size=n + 1)))
    assert moved(np.array(points), h, tau, ends) == pytest.approx([points[-1]], abs=1e-12)


@given(st.data(), st.sampled_from(list(EndBlends)))
def test_bounds_hold_for_everything_in_the_boxes(data: st.DataObject, ends: EndBlends) -> None:
    n = data.draw(st.integers(1, 3))
    value = st.floats(-2, 2)
    q = np.array(data.draw(st.lists(value, min_size=n + 1, max_size=n + 1)))[:, None]
    h = np.array(data.draw(st.lists(st.floats(0.3, 3.0), min_size=n, max_size=n)))
    a = np.array(data.draw(st.lists(st.floats(0.5, 30.0), min_size=1, max_size=1)))
    seed = np.random.default_rng(data.draw(st.integers(0, 2**32)))

    def box(x: Array) -> RoundingBox:
        return RoundingBox(x, x - 0.01, x + 0.01)

    wide = by_blend_accelerations(box(q), box(h), box(a), ends)
    timed = by_blend_times(box(q), box(h), box(np.full(n + 1, 0.1)), ends)
    for _ in range(20):
        inner = [RoundingBox.exact(x + seed.uniform(-0.01, 0.01, x.shape)) for x in (q, h, a)]
        tau = RoundingBox.exact(0.1 + seed.uniform(-0.01, 0.01, n + 1))
        held(by_blend_accelerations(*inner, ends), wide)
        held(by_blend_times(inner[0], inner[1], tau, ends), timed)


def held(one: Blended, wide: Blended) -> None:
    for name in ("velocity", "acceleration", "room"):
        inner: Between = getattr(one, name)
        outer: Between = getattr(wide, name)
        known = inner.low == inner.high  # no bounds are known where a blend leaves no time
        slack = 1e-9 * (1.0 + np.abs(inner.low))
        assert (~known | (outer.low <= inner.low + slack)).all()
        assert (~known | (outer.high >= inner.high - slack)).all()


def test_too_long_a_way_has_no_speed_that_is_high_enough() -> None:
    short = by_blend_accelerations(column(0, 1), exact(1.9), exact(1.0), EndBlends.WITHIN)
    assert short.room.high[0, 0] < 0
    just = by_blend_accelerations(column(0, 1), exact(2.0), exact(1.0), EndBlends.WITHIN)
    assert just.velocity.low[0, 0] == pytest.approx(1.0)
    assert just.room.low[0, 0] == pytest.approx(0.0, abs=1e-12)
