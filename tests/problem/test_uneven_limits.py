"""Limits whose two sides differ: what they hold, and how motions are judged by each side."""

import pickle

import numpy as np
import pytest
from support.uneven import LIMITS, WAYPOINTS, uneven_problem
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    keeps_limits,
    piecewise,
    reachable_total,
    rest_to_rest,
)

DURATIONS = np.array([0.7, 1.3, 0.9])


def test_pairs_are_kept_by_side() -> None:
    limits = Limits(2.0, [[-15, 10], [-3, 3]], joints=2)
    assert limits.uneven
    assert limits.is_uneven("acceleration")
    assert not limits.is_uneven("velocity")
    np.testing.assert_array_equal(limits.sides[:, :, 1], [[15, 3], [10, 3]])
    np.testing.assert_array_equal(limits.ends("acceleration"), [[-15, -3], [10, 3]])
    np.testing.assert_array_equal(limits.widest, [[2, 15, np.inf], [2, 3, np.inf]])
    np.testing.assert_array_equal(limits.hull.derivatives, limits.widest)
    np.testing.assert_array_equal(limits.velocity, [2, 2])
    np.testing.assert_array_equal(limits.joint(0).sides, limits.sides[:, :1])
    assert not limits.joint(1).uneven
    again = pickle.loads(pickle.dumps(limits))
    np.testing.assert_array_equal(again.sides, limits.sides)
    assert "-15" in repr(limits)


def test_equal_pairs_are_sizes() -> None:
    pairs = Limits(acceleration=[[-4, 4], [-3, 3]])
    assert not pairs.uneven
    np.testing.assert_array_equal(pairs.acceleration, [4, 3])
    assert pairs.hull is pairs


def test_one_pair_serves_every_joint() -> None:
    problem = Problem(WAYPOINTS, Limits(acceleration=[[-15, 10]]), cubic_spline(3))
    np.testing.assert_array_equal(problem.limits.ends("acceleration"), [[-15, -15], [10, 10]])
    assert not problem.hull.limits.uneven


def test_what_knows_sizes_alone_meets_an_error() -> None:
    for name in ("velocity", "acceleration", "jerk", "derivatives"):
        with pytest.raises(TrajgapError, match="differ in size"):
            getattr(LIMITS, name)


@pytest.mark.parametrize(
    ("pair", "message"),
    [([[1, 2]], "1 to 2 leaves out 0"), ([[-2, -1]], "leaves out 0"), ([[np.nan, 1]], "is NaN")],
)
def test_pairs_refuse(pair: list[list[float]], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        Limits(velocity=pair)


def test_a_side_of_zero_forbids_that_side_alone() -> None:
    rising, curve = np.array([[0.0], [1.0]]), rest_to_rest(1, 3)
    forward = Limits(velocity=[[0, 2]])
    assert check(Problem(rising, forward, curve), [1.0]).verdict is Verdict.PASS
    back = check(Problem(-rising, forward, curve), [1.0])
    assert back.verdict is Verdict.VIOLATED
    assert back.feasible_time is None
    assert not keeps_limits(Problem(-rising, forward, curve), np.array([[1.0]]), 1e-9)[0]
    free = Limits(velocity=[[-np.inf, 2]])
    unlimited = check(Problem(-rising, free, curve), [1e-3])
    assert unlimited.verdict is Verdict.PASS
    assert unlimited.peaks[0].ratio == 0.0
    # At -1 rad/s all the way, nothing lies on the limited side.
    steady = check(Problem(-rising, free, piecewise((1,), 0, ())), [1.0])
    assert (steady.verdict, steady.peaks[0].ratio) == (Verdict.PASS, 0.0)


def test_a_box_of_waypoints_is_reached_within_both_sides() -> None:
    problem = uneven_problem("cubic")
    total = reachable_total(problem, DURATIONS, WAYPOINTS - 1e-3, WAYPOINTS + 1e-3)
    assert total is not None
    for seed in range(5):
        q = WAYPOINTS + np.random.default_rng(seed).uniform(-1e-3, 1e-3, WAYPOINTS.shape)
        moved = Problem(q, LIMITS, problem.curve)
        assert check(moved, DURATIONS * total / DURATIONS.sum()).verdict is Verdict.PASS
